#include "solver/queries/time_of_impact.hpp"
#include "solver/queries/visit_shapes.hpp"

namespace cycloid::solver {

/// A cast ends this close to what it met, m; positions carry a hundredth of it at 10 m.
static constexpr float kTolerance = 1.0e-4f;

/// Outward normals of a probe's edges; in space a probe is a ball.
static void set_normals(Shape<2>& shape) {
  for (std::uint32_t i = 0; i < shape.vertex_count; ++i) {
    const Vec<2> edge = shape.vertices[(i + 1) % shape.vertex_count] - shape.vertices[i];
    shape.normals[i] = normalized_or(Vec<2>{{edge[1], -edge[0]}}, Vec<2>{{0.0f, 1.0f}});
  }
}
static void set_normals(Shape<3>&) {}

template <int D>
Shape<D> shape_of(const Probe<D>& probe) {
  Shape<D> shape{};
  shape.kind = probe.count == 1   ? ShapeKind::kBall
               : probe.count == 2 ? ShapeKind::kCapsule
                                  : ShapeKind::kPolygon;
  shape.vertex_count = probe.count;
  shape.radius = probe.radius;
  shape.vertices = probe.points;
  if (probe.count > 1) set_normals(shape);
  return shape;
}

template <int D>
std::vector<QueryHit<D>> shape_cast(const WorldState<D>& state, const Probe<D>& probe,
                                    const Pose<D>& pose, const Vec<D>& translation,
                                    const QueryFilter& filter) {
  std::vector<QueryHit<D>> hits;
  const Shape<D> moving = shape_of(probe);
  const BodySweep<D> way = {pose, translation, Spin<D>::zero()};
  visit_shapes(state, way_bounds(bounds_of(moving, pose, kTolerance), translation), filter,
               [&](std::uint32_t, const Shape<D>& shape, const Body<D>& body) {
                 const BodySweep<D> still = {pose_of(body), Vec<D>::zero(), Spin<D>::zero()};
                 const Impact<D> impact =
                     time_of_impact(shape, still, moving, way, 0.0f, kTolerance);
                 if (!impact.hit) return;
                 QueryHit<D> hit = hit_of(shape, body);
                 hit.fraction = impact.fraction;
                 hit.point = impact.point;
                 hit.normal = impact.normal;
                 hit.separation = impact.separation;
                 hits.push_back(hit);
               });
  return hits;
}

template <int D>
std::optional<QueryHit<D>> shape_cast_first(const WorldState<D>& state, const Probe<D>& probe,
                                            const Pose<D>& pose, const Vec<D>& translation,
                                            const QueryFilter& filter) {
  return first_of(shape_cast(state, probe, pose, translation, filter));
}

template Shape<2> shape_of(const Probe<2>&);
template Shape<3> shape_of(const Probe<3>&);
template std::vector<QueryHit<2>> shape_cast(const WorldState<2>&, const Probe<2>&, const Pose<2>&,
                                             const Vec<2>&, const QueryFilter&);
template std::vector<QueryHit<3>> shape_cast(const WorldState<3>&, const Probe<3>&, const Pose<3>&,
                                             const Vec<3>&, const QueryFilter&);
template std::optional<QueryHit<2>> shape_cast_first(const WorldState<2>&, const Probe<2>&,
                                                     const Pose<2>&, const Vec<2>&,
                                                     const QueryFilter&);
template std::optional<QueryHit<3>> shape_cast_first(const WorldState<3>&, const Probe<3>&,
                                                     const Pose<3>&, const Vec<3>&,
                                                     const QueryFilter&);

}  // namespace cycloid::solver
