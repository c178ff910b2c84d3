#pragma once

#include "tests/oracle/separation.hpp"
#include "tests/oracle/specimens.hpp"

namespace cycloid::oracle {

/// Two specimens and where they are.
struct Pair {
  const Specimen* a = nullptr;
  const Specimen* b = nullptr;
  solver::Pose<3> pose_a;
  solver::Pose<3> pose_b;
  float margin = 0.02f;

  /// The larger of the two, at least 1 m: what tolerances grow with.
  double scale() const;
};

/// Both bodies relative to the position of body a.
struct PlacedPair {
  Convex a;
  Convex b;
  Vector normal;  ///< Of a half-space or triangle among them, as it is turned; else 0.
};

PlacedPair place(const Pair& pair);

/// A pose of the pair, relative to the position of body a.
Placement placement_in(const Pair& pair, const solver::Pose<3>& pose);

/// What the oracle says about a pair.
struct Truth {
  Gap gap;
  double lower = 0.0;  ///< Widest gap along an axis of separation; the gap itself with half-spaces.
  bool proved = true;  ///< A distance beyond 1e-5 m equals its lower bound within 1e-9 m.
};

Truth truth_of(const Pair& pair, const PlacedPair& bodies);

/// The gap along any direction [unit, from a to b]; for half-spaces -infinity but along the normal.
double gap_of(const Pair& pair, const PlacedPair& bodies, const Vector& direction);

/// A pose of two specimens in general position: three of five within 0.05 m of touching, the others
/// apart, deep in each other, or with one centre. Positions are multiples of 2^-13 m.
Pair random_pair(Random& random, const Specimen& a, const Specimen& b);

/// A pose on a grid, turned by right angles; one of four is off by a little turn.
Pair regular_pair(Random& random, const Specimen& a, const Specimen& b);

}  // namespace cycloid::oracle
