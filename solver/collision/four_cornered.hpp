#pragma once

#include "solver/collision/placed_pair.hpp"
#include "solver/state.hpp"
#include "solver/transpose.hpp"

namespace cycloid::solver {

/// What became of a pair of polygons with four corners.
enum class FourCorneredOutcome { kApart, kClipped, kCornersMayBeClosest };

/// A clipped edge before it is a manifold. Floats alone, so that lanes are written by quads.
struct alignas(16) ClippedEdges {
  float normal[2];  ///< From shape a to shape b.
  float outcome;    ///< A FourCorneredOutcome.
  float unused;
  struct Point {
    float at[2];       ///< From the centre of body a, m.
    float separation;  ///< m; no point where it is beyond the pair's margin.
    float feature;
  };
  Point points[2];
};

/// Polygons of four corners, boxes above all, against one another, a pair in each lane: the
/// formulas of hull_against_hull, with selects for its branches, so the same bits. Compiled for
/// each width: four_cornered.cpp and four_cornered_avx2.cpp.
template <int W>
struct FourCornered {
  /// @param clipped  of kCornersMayBeClosest only the outcome is written: hull_against_hull knows
  /// what to do. @pre every shape is a polygon with `vertex_count` 4.
  static void collide(const Shape<2>* shapes, const PlacedPair<2>* pairs,
                      const LaneIndices<W>& pair_in_lane, ClippedEdges (&clipped)[kLaneCount<W>]);
};

}  // namespace cycloid::solver
