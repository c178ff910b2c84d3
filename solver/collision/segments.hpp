#pragma once

#include "solver/dim.hpp"

namespace cycloid::solver {

/// 1 / square, or 0 for what has no length.
float inverse_or_zero(float square);

/// Where the segment from `from` along `along` is nearest to a point: 0 to 1.
/// @param inverse_square  1 / |along|^2, or 0 where `along` has no length: then 0.
float nearest_fraction(const Vec<3>& from, const Vec<3>& along, float inverse_square,
                       const Vec<3>& point);

/// The nearest points of two segments.
struct SegmentPair {
  Vec<3> on_a;
  Vec<3> on_b;
  float fraction_a;  ///< Along a, 0 at its first end and 1 at its second: exactly at the ends.
  float fraction_b;
  float distance;  ///< m.
  bool crossing;   ///< Both points lie inside, and the segments are not parallel.
};

/// The nearest points of two segments, of which either may be a point. Of parallel segments it is
/// a pair with at least one end; of equally near pairs the first in the order b.from, b.to,
/// a.from, a.to.
/// Source: Ericson, "Real-Time Collision Detection" (2005), 5.1.9; the denominator is taken from
/// the cross product, which loses nothing where the segments are nearly parallel.
SegmentPair nearest_points(const Vec<3>& a_from, const Vec<3>& a_to, const Vec<3>& b_from,
                           const Vec<3>& b_to);

}  // namespace cycloid::solver
