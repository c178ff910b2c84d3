#pragma once

#include "solver/collision/bounds.hpp"
#include "solver/queries/query.hpp"

namespace cycloid::solver {

/// Calls found(shape, relative pose) for every shape, in slot order, that `filter` lets through and
/// whose box overlaps `bounds`; half-spaces always. Box and pose are relative to `origin` [world,
/// m]. @pre `bounds` has room for the rounding of positions.
template <int D, class Found>
void for_each_candidate(const WorldState<D>& state, const Vec<D>& origin, const Bounds<D>& bounds,
                        const QueryFilter& filter, Found&& found) {
  for (const Shape<D>& shape : state.shapes) {
    if (shape.kind == ShapeKind::kFree || !filters_meet(shape.filter, filter.filter)) continue;
    const Body<D>& body = state.bodies[shape.body];
    if (filter.ignore == BodyId{shape.body, body.generation}) continue;
    const Pose<D> pose{body.position - origin, body.rotation};
    const bool near =
        shape.kind == ShapeKind::kHalfSpace || overlaps(bounds_of(shape, pose, 0.0f), bounds);
    if (near) found(shape, pose);
  }
}

/// A hit without its place on the way: `point` is relative to `origin`.
template <int D>
QueryHit<D> hit_of(const WorldState<D>& state, const Shape<D>& shape, const Vec<D>& origin,
                   const Vec<D>& point, const Vec<D>& normal) {
  QueryHit<D> hit;
  hit.body = {shape.body, state.bodies[shape.body].generation};
  hit.shape = shape.ordinal;
  hit.point = origin + point;
  hit.normal = normal;
  return hit;
}

/// What is added to the box of a query that reaches `extent` [m] from its origin: float positions
/// round in steps of extent / 2^23.
inline float bounds_slack(float extent) {
  return 1.0e-3f + 1.0e-6f * extent;
}

}  // namespace cycloid::solver
