#include "scenes/needs.hpp"

#include <algorithm>

#include "scenes/weave.hpp"

namespace cycloid::scenes {

/// Shapes that the solver makes of one: an edge or a triangle each where it has many.
static std::uint64_t shape_count(const SceneShape& shape) {
  switch (shape.kind) {
    case solver::ShapeKind::kChain:
      return shape.points.size() - (shape.loop || shape.points.empty() ? 0 : 1);
    case solver::ShapeKind::kMesh:
      return shape.triangles.size();
    case solver::ShapeKind::kHeightField: {
      const std::uint64_t columns = std::max(shape.columns, 1u);
      const std::uint64_t rows = shape.heights.size() / columns;
      return rows == 0 ? 0 : 2 * (columns - 1) * (rows - 1);
    }
    default:
      return 1;
  }
}

/// Nothing of a cloth that is refused for its size.
static void count_cloth(const Cloth& cloth, Need& particles, Need& links) {
  const std::uint64_t columns = cloth.columns;
  const std::uint64_t rows = cloth.rows;
  const std::uint64_t room = kClothParticlesMax - particles.count;
  if (columns < 1 || rows < 1 || columns > room || rows > room / columns) return;
  particles.count += columns * rows;
  const std::uint64_t cells = (columns - 1) * (rows - 1);
  links.count += (columns - 1) * rows + columns * (rows - 1);
  if (!(cloth.shear_compliance < 0.0f)) links.count += 2 * cells;
}

std::vector<Need> needs_of(const Scene& scene) {
  using solver::Limits;
  Need bodies{"bodies", &Limits::bodies, scene.bodies.size()};
  Need shapes{"shapes", &Limits::shapes};
  Need materials{"materials", &Limits::materials, std::max<std::size_t>(scene.materials.size(), 1)};
  Need particles{"particles", &Limits::particles};
  Need links{"links", &Limits::links};
  Need pins{"pins", &Limits::pins};
  for (const SceneBody& body : scene.bodies)
    for (const SceneShape& shape : body.shapes) shapes.count += shape_count(shape);
  bool anchored = false;
  for (const Cloth& cloth : scene.cloths) {
    count_cloth(cloth, particles, links);
    pins.count += cloth.pins.size();
    for (const ClothPin& pin : cloth.pins) anchored = anchored || pin.body.empty();
  }
  if (anchored) ++bodies.count;  // What pins to the world hold on to is a body too.
  return {bodies, shapes, {"joints", &Limits::joints, scene.joints.size()}, materials, particles,
          links,  pins};
}

std::string too_small(std::uint32_t limit, std::uint64_t need) {
  return "is " + std::to_string(limit) + ", and the scene needs " + std::to_string(need) +
         " from the start";
}

solver::Limits checked_limits(const Scene& scene, std::vector<Mistake>& mistakes) {
  constexpr std::uint64_t kLimitMax = 1u << 24;
  solver::Limits limits = scene.limits;
  for (const Need& need : needs_of(scene)) {
    std::uint32_t& limit = limits.*need.limit;
    if (need.count <= limit) continue;
    mistakes.push_back({std::string("/limits/") + need.name, too_small(limit, need.count)});
    limit = static_cast<std::uint32_t>(std::min(need.count, kLimitMax));
  }
  return limits;
}

}  // namespace cycloid::scenes
