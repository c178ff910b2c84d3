#pragma once

#include "solver/collision/placed_pair.hpp"
#include "solver/state.hpp"
#include "solver/transpose.hpp"

namespace cycloid::solver {

/// Outlines of two to four corners, boxes and capsules above all, and balls against one another, a
/// pair in each lane: the formulas of hull_against_hull, hull_against_ball and ball_against_ball,
/// with selects for their branches, so the same bits.
/// Compiled for each width: few_cornered.cpp, few_cornered_avx2.cpp and few_cornered_avx512.cpp.
template <int W>
struct FewCornered {
  /// Writes manifolds[i] of the pairs that the lanes name; a pair may stand in several.
  /// @pre every shape is a capsule, or a polygon with a `vertex_count` of 4 at most.
  static void collide(const Shape<2>* shapes, const PlacedPair<2>* pairs,
                      const LaneIndices<W>& pair_in_lane, Manifold<2>* manifolds);
  /// The same of such an outline and a ball, in either order.
  static void collide_ball(const Shape<2>* shapes, const PlacedPair<2>* pairs,
                           const LaneIndices<W>& pair_in_lane, Manifold<2>* manifolds);
  /// The same of two balls.
  static void collide_balls(const Shape<2>* shapes, const PlacedPair<2>* pairs,
                            const LaneIndices<W>& pair_in_lane, Manifold<2>* manifolds);
};

}  // namespace cycloid::solver
