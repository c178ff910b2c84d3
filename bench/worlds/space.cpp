#include "bench/worlds/bench_worlds.hpp"
#include "bench/worlds/parts.hpp"

namespace cycloid::worlds {

/// The hull of points on a ball of `radius`, uneven.
static SceneShape stone(int corners, float radius, scenes::Random& random) {
  SceneShape shape;
  shape.kind = solver::ShapeKind::kHull;
  while (static_cast<int>(shape.points.size()) < corners) {
    const float x = random.between(-1.0f, 1.0f);
    const float y = random.between(-1.0f, 1.0f);
    const float z = random.between(-1.0f, 1.0f);
    const float square = x * x + y * y + z * z;
    if (square < 0.25f || square > 1.0f) continue;
    const float scale = radius / solver::sqrt(square);
    shape.points.push_back({scale * x, scale * y, scale * z});
  }
  return shape;
}

Scene convex_pile(int hulls) {
  Scene scene = scenes::spatial_scene("", "Stones dropped into a walled box.");
  scene.bodies.push_back(scenes::ground());
  constexpr int kSide = 8;
  for (const float side : {-1.0f, 1.0f}) {
    for (const bool along_x : {true, false}) {
      const float middle = side * (0.55f * kSide + 0.5f);
      SceneBody wall = scenes::body_at(
          "", along_x ? Triple{middle, 10.0f, 0.0f} : Triple{0.0f, 10.0f, middle},
          scenes::solid_box(along_x ? Triple{0.5f, 10.0f, 6.0f} : Triple{6.0f, 10.0f, 0.5f}));
      wall.kind = solver::BodyKind::kStatic;
      scene.bodies.push_back(wall);
    }
  }
  scenes::Random random{23};
  std::vector<SceneShape> kinds;
  for (const int corners : {12, 14, 16, 20}) kinds.push_back(stone(corners, 0.5f, random));
  for (int i = 0; i < hulls; ++i) {
    const int layer = i / (kSide * kSide);
    const float shift = layer % 2 == 0 ? -0.03f : 0.03f;
    add_body(scene,
             {1.05f * (static_cast<float>(i % kSide) - 0.5f * (kSide - 1)) + shift,
              0.6f + 1.05f * static_cast<float>(layer),
              1.05f * (static_cast<float>(i / kSide % kSide) - 0.5f * (kSide - 1)) + shift},
             kinds[static_cast<std::size_t>(i) % kinds.size()]);
  }
  return scene;
}

}  // namespace cycloid::worlds
