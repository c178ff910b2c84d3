#include "solver/queries/candidates.hpp"
#include "solver/queries/casting.hpp"

namespace cycloid::solver {

static void fill_normals(Shape<2>& shape) {
  if (shape.vertex_count < 2) return;
  for (std::uint32_t i = 0; i < shape.vertex_count; ++i) {
    const std::uint32_t next = i + 1 < shape.vertex_count ? i + 1 : 0;
    const Vec<2> edge = shape.vertices[next] - shape.vertices[i];
    shape.normals[i] = normalized_or(Vec<2>{{edge[1], -edge[0]}}, Vec<2>{{0.0f, 1.0f}});
  }
}
/// The roundings of points and lines in space have no normals to keep.
static void fill_normals(Shape<3>&) {}

template <int D>
Shape<D> shape_of(const Probe<D>& probe) {
  Shape<D> shape{};
  shape.kind = ShapeKind::kPolygon;
  if (probe.count == 1) shape.kind = ShapeKind::kBall;
  if (probe.count == 2) shape.kind = ShapeKind::kCapsule;
  shape.vertex_count = probe.count;
  shape.radius = probe.radius;
  for (std::size_t i = 0; i < shape.vertices.size() && i < probe.count; ++i)
    shape.vertices[i] = probe.points[i];
  fill_normals(shape);
  return shape;
}

template <int D>
std::vector<QueryHit<D>> overlap(const WorldState<D>& state, const Probe<D>& probe,
                                 const Pose<D>& pose, float margin, const QueryFilter& filter) {
  std::vector<QueryHit<D>> hits;
  const Core<D> core = core_of(probe, pose.rotation);
  Core<D> reach = core;
  reach.radius += max(margin, 0.0f);
  const auto test = [&](const Shape<D>& shape, const Pose<D>& relative) {
    const Core<D> other = core_of(shape, relative.rotation, relative.position, state.polyhedra);
    const Separation<D> between = separation_of(other, core);
    if (!(between.distance < margin)) return;
    // The free side, whatever neighbours a segment has.
    if (other.one_sided() && dot(between.normal, other.normals[0]) < 0.0f) return;
    const Vec<D> point = surface_point(other, core, between);
    hits.push_back(hit_of(state, shape, pose.position, point, between.normal));
    hits.back().separation = between.distance;
  };
  for_each_candidate(state, pose.position, swept_bounds(reach, Vec<D>::zero()), filter, test);
  return hits;
}

template Shape<2> shape_of(const Probe<2>&);
template Shape<3> shape_of(const Probe<3>&);
template std::vector<QueryHit<2>> overlap(const WorldState<2>&, const Probe<2>&, const Pose<2>&,
                                          float, const QueryFilter&);
template std::vector<QueryHit<3>> overlap(const WorldState<3>&, const Probe<3>&, const Pose<3>&,
                                          float, const QueryFilter&);

}  // namespace cycloid::solver
