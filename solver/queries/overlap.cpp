#include "solver/collision/collide.hpp"
#include "solver/queries/visit_shapes.hpp"

namespace cycloid::solver {

/// The deepest point of a manifold as a hit on shape a, whose pose is `pose`.
template <int D>
static QueryHit<D> deepest(const Shape<D>& shape, const Body<D>& body,
                           const Manifold<D>& manifold) {
  const ManifoldPoint<D>* point = &manifold.points[0];
  for (std::uint32_t i = 1; i < manifold.point_count; ++i)
    if (manifold.points[i].separation < point->separation) point = &manifold.points[i];
  QueryHit<D> hit = hit_of(shape, body);
  hit.normal = manifold.normal;
  hit.separation = point->separation;
  hit.point = body.position + point->anchor_a - (0.5f * point->separation) * manifold.normal;
  return hit;
}

template <int D>
std::vector<QueryHit<D>> overlap(const WorldState<D>& state, const Probe<D>& probe,
                                 const Pose<D>& pose, float margin, const QueryFilter& filter) {
  std::vector<QueryHit<D>> hits;
  const Shape<D> placed = shape_of(probe);
  visit_shapes(state, bounds_of(placed, pose, margin), filter,
               [&](std::uint32_t, const Shape<D>& shape, const Body<D>& body) {
                 const Manifold<D> manifold = collide(shape, pose_of(body), placed, pose, margin);
                 if (manifold.point_count > 0) hits.push_back(deepest(shape, body, manifold));
               });
  return hits;
}

template <int D>
std::optional<QueryHit<D>> closest_point(const WorldState<D>& state, const Vec<D>& point,
                                         float distance_max, const QueryFilter& filter) {
  Probe<D> probe;
  probe.points[0] = Vec<D>::zero();
  const Pose<D> pose{point, identity_rotation<D>()};
  std::optional<QueryHit<D>> nearest;
  for (const QueryHit<D>& hit : overlap(state, probe, pose, distance_max, filter))
    if (!nearest || hit.separation < nearest->separation) nearest = hit;
  return nearest;
}

template std::vector<QueryHit<2>> overlap(const WorldState<2>&, const Probe<2>&, const Pose<2>&,
                                          float, const QueryFilter&);
template std::vector<QueryHit<3>> overlap(const WorldState<3>&, const Probe<3>&, const Pose<3>&,
                                          float, const QueryFilter&);
template std::optional<QueryHit<2>> closest_point(const WorldState<2>&, const Vec<2>&, float,
                                                  const QueryFilter&);
template std::optional<QueryHit<3>> closest_point(const WorldState<3>&, const Vec<3>&, float,
                                                  const QueryFilter&);

}  // namespace cycloid::solver
