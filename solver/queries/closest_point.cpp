#include "solver/queries/candidates.hpp"
#include "solver/queries/casting.hpp"

namespace cycloid::solver {

template <int D>
std::optional<QueryHit<D>> closest_point(const WorldState<D>& state, const Vec<D>& point,
                                         float distance_max, const QueryFilter& filter) {
  std::optional<QueryHit<D>> nearest;
  Core<D> core{};
  core.kind = ShapeKind::kBall;
  core.count = 1;
  core.vertices[0] = Vec<D>::zero();
  Core<D> reach = core;
  reach.radius = max(distance_max, 0.0f);
  const auto test = [&](const Shape<D>& shape, const Pose<D>& relative) {
    const Core<D> other = core_of(shape, relative.rotation, relative.position, state.polyhedra);
    const Separation<D> between = separation_of(other, core);
    const float distance = abs(between.distance);
    if (!(distance <= distance_max)) return;
    if (nearest && distance >= abs(nearest->separation)) return;
    if (other.one_sided() && dot(between.normal, other.normals[0]) < 0.0f) return;
    nearest = hit_of(state, shape, point, between.point_a, between.normal);
    nearest->separation = between.distance;
  };
  for_each_candidate(state, point, swept_bounds(reach, Vec<D>::zero()), filter, test);
  return nearest;
}

template std::optional<QueryHit<2>> closest_point(const WorldState<2>&, const Vec<2>&, float,
                                                  const QueryFilter&);
template std::optional<QueryHit<3>> closest_point(const WorldState<3>&, const Vec<3>&, float,
                                                  const QueryFilter&);

}  // namespace cycloid::solver
