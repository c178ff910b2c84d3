#pragma once

#include "solver/collision/bounds.hpp"
#include "solver/queries/query.hpp"
#include "solver/queries/separation.hpp"

namespace cycloid::solver {

/// Starts that rounding puts this far inside of a surface they only touch still enter it, m.
inline constexpr float kTouch = 1.0e-5f;

/// Where a moving core first touches one that stands still.
template <int D>
struct Entry {
  bool hit = false;
  float fraction = 0.0f;
  Vec<D> normal;  ///< Unit, outwards from the core that stands still.
  Vec<D> point;   ///< On its surface, in the frame of the cast.
};

/// `probe` moves along `translation` [m] towards `core`; touching without a way inwards is no hit.
/// @pre they do not overlap at the start: what they already share is not found.
template <int D>
Entry<D> enter(const Core<D>& core, const Core<D>& probe, const Vec<D>& translation);

/// The box of all that `probe` passes, with room for rounding.
template <int D>
Bounds<D> swept_bounds(const Core<D>& probe, const Vec<D>& translation);

/// Of hits in slot order the one with the smallest fraction, the first of equal ones.
template <int D>
std::optional<QueryHit<D>> earliest(const std::vector<QueryHit<D>>& hits) {
  std::optional<QueryHit<D>> first;
  for (const QueryHit<D>& hit : hits)
    if (!first || hit.fraction < first->fraction) first = hit;
  return first;
}

}  // namespace cycloid::solver
