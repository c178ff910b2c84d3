#pragma once

#include "solver/collision/bounds.hpp"
#include "solver/queries/query.hpp"

namespace cycloid::solver {

template <int D>
Pose<D> pose_of(const Body<D>& body) {
  return {body.position, body.rotation};
}

/// Calls found(slot, shape, body) for every shape that the filter meets and whose box touches
/// `bounds`, in slot order. Half-spaces have no box and are always called.
template <int D, class Found>
void visit_shapes(const WorldState<D>& state, const Bounds<D>& bounds, const QueryFilter& filter,
                  Found&& found) {
  for (std::uint32_t s = 0; s < state.shapes.size(); ++s) {
    const Shape<D>& shape = state.shapes[s];
    if (shape.kind == ShapeKind::kFree || !filters_meet(shape.filter, filter.filter)) continue;
    const Body<D>& body = state.bodies[shape.body];
    const bool ignored =
        shape.body == filter.ignore.index && body.generation == filter.ignore.generation;
    if (ignored) continue;
    const bool bounded = shape.kind != ShapeKind::kHalfSpace;
    if (bounded && !overlaps(bounds, bounds_of(shape, pose_of(body), 0.0f))) continue;
    found(s, shape, body);
  }
}

template <int D>
QueryHit<D> hit_of(const Shape<D>& shape, const Body<D>& body) {
  QueryHit<D> hit;
  hit.body = {shape.body, body.generation};
  hit.shape = shape.ordinal;
  hit.point = Vec<D>::zero();
  hit.normal = Vec<D>::zero();
  return hit;
}

/// The hit with the least fraction; of equals the first.
template <int D>
std::optional<QueryHit<D>> first_of(const std::vector<QueryHit<D>>& hits) {
  const QueryHit<D>* first = nullptr;
  for (const QueryHit<D>& hit : hits)
    if (first == nullptr || hit.fraction < first->fraction) first = &hit;
  if (first == nullptr) return std::nullopt;
  return *first;
}

/// The box of a way.
template <int D>
Bounds<D> way_bounds(const Bounds<D>& start, const Vec<D>& way) {
  return merged(start, {start.lower + way, start.upper + way});
}

}  // namespace cycloid::solver
