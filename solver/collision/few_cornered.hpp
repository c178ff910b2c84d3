#pragma once

#include "solver/collision/placed_pair.hpp"
#include "solver/state.hpp"
#include "solver/transpose.hpp"

namespace cycloid::solver {

/// What became of a pair of outlines.
enum class FewCorneredOutcome { kApart, kTouching };

/// The points of a pair before they are a manifold. Floats alone, so that lanes are written by
/// quads.
struct alignas(16) FewCorneredPoints {
  float normal[2];  ///< From shape a to shape b.
  float outcome;    ///< A FewCorneredOutcome.
  float unused;
  struct Point {
    float at[2];       ///< From the centre of body a, m.
    float separation;  ///< m; no point where it is beyond the pair's margin.
    float feature;
  };
  Point points[2];
};

/// Outlines of two to four corners, boxes and capsules above all, against one another, a pair in
/// each lane: the formulas of hull_against_hull, with selects for its branches, so the same bits.
/// Compiled for each width: few_cornered.cpp, few_cornered_avx2.cpp and few_cornered_avx512.cpp.
template <int W>
struct FewCornered {
  /// @pre every shape is a capsule, or a polygon with a `vertex_count` of 4 at most.
  static void collide(const Shape<2>* shapes, const PlacedPair<2>* pairs,
                      const LaneIndices<W>& pair_in_lane,
                      FewCorneredPoints (&points)[kLaneCount<W>]);
};

}  // namespace cycloid::solver
