#pragma once

#include "tests/oracle/convex.hpp"

namespace cycloid::oracle {

/// How far apart the hulls of two bodies' corners are, without their radii.
struct Distance {
  double value = 0.0;        ///< m.
  double lower_bound = 0.0;  ///< By a plane between the two: equal to `value` proves both right.
  Vector direction;          ///< Unit, from a to b; 0 where they meet.
  Vector on_a;
  Vector on_b;
};

/// The point nearest to the origin of all differences b - a of the two hulls.
/// Source: P. Wolfe, "Finding the nearest point in a polytope", Mathematical Programming 11 (1976).
Distance distance(const Convex& a, const Convex& b);

/// A signed gap and where it is.
struct Gap {
  double value = 0.0;  ///< m, negative where the bodies overlap.
  Vector direction;    ///< Unit, from a to b.
};

/// The gap between the projections of two bodies onto `direction` [unit], radii and all.
double gap_along(const Convex& a, const Convex& b, const Vector& direction);

/// The widest gap along the normals of faces and the cross products of edges. For bodies without
/// radius that overlap it is the least way to move b out of a, negated, since every face of the set
/// of differences has one of these directions; for others, less than or equal to their gap.
/// Segments and points that lie in each other leave a direction free: any that has no depth.
/// @param every_pair  also tries cross products of edges that cannot touch; slow, for tests.
Gap widest_gap(const Convex& a, const Convex& b, bool every_pair = false);

/// The gap of two bodies: their distance, or the least way to move b out of a, negated.
Gap separation(const Convex& a, const Convex& b);

}  // namespace cycloid::oracle
