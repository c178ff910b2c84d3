#include "solver/queries/candidates.hpp"
#include "solver/queries/casting.hpp"
#include "solver/queries/solid_queries.hpp"

namespace cycloid::solver {

/// Where a ray starts. In space a solid needs no nearest point, only whether the point is inside.
static Separation<2> start_of(const Core<2>& core, const Core<2>& point) {
  return separation_of(core, point);
}
static Separation<3> start_of(const Core<3>& core, const Core<3>& point) {
  if (core.face_count == 0 || core.radius > 0.0f) return separation_of(core, point);
  return encloses(core, point.vertices[0]) ? separation_across(core, point) : Separation<3>{};
}

/// A ray is the cast of a point; only what it starts in is treated otherwise.
template <int D>
std::vector<QueryHit<D>> ray_cast(const WorldState<D>& state, const Vec<D>& from, const Vec<D>& to,
                                  const QueryFilter& filter) {
  std::vector<QueryHit<D>> hits;
  Core<D> point{};
  point.kind = ShapeKind::kBall;
  point.count = 1;
  point.vertices[0] = Vec<D>::zero();
  const Vec<D> translation = to - from;
  const auto cast = [&](const Shape<D>& shape, const Pose<D>& relative) {
    const Core<D> core = core_of(shape, relative.rotation, relative.position, state.polyhedra);
    const Separation<D> start = start_of(core, point);
    if (start.distance < 0.0f && allows(core, start.normal)) {
      const Vec<D> normal = normalized_or(-translation, start.normal);
      hits.push_back(hit_of(state, shape, from, Vec<D>::zero(), normal));
      return;
    }
    const Entry<D> entry = enter(core, point, translation);
    if (!entry.hit) return;
    hits.push_back(hit_of(state, shape, from, entry.point, entry.normal));
    hits.back().fraction = entry.fraction;
  };
  for_each_candidate(state, from, swept_bounds(point, translation), filter, cast);
  return hits;
}

template <int D>
std::optional<QueryHit<D>> ray_cast_first(const WorldState<D>& state, const Vec<D>& from,
                                          const Vec<D>& to, const QueryFilter& filter) {
  return earliest(ray_cast(state, from, to, filter));
}

template std::vector<QueryHit<2>> ray_cast(const WorldState<2>&, const Vec<2>&, const Vec<2>&,
                                           const QueryFilter&);
template std::vector<QueryHit<3>> ray_cast(const WorldState<3>&, const Vec<3>&, const Vec<3>&,
                                           const QueryFilter&);
template std::optional<QueryHit<2>> ray_cast_first(const WorldState<2>&, const Vec<2>&,
                                                   const Vec<2>&, const QueryFilter&);
template std::optional<QueryHit<3>> ray_cast_first(const WorldState<3>&, const Vec<3>&,
                                                   const Vec<3>&, const QueryFilter&);

}  // namespace cycloid::solver
