#pragma once

#include <string>
#include <vector>

#include "tests/oracle/pairs.hpp"

namespace cycloid::oracle {

/// What is wrong with a manifold: a short name that failures are counted by, and the numbers.
struct Complaint {
  std::string what;
  std::string numbers;
};

/// How far a manifold may be from the truth.
struct Tolerance {
  double rounding = 1e-5;   ///< m per m of the pair's scale.
  double reduction = 1e-4;  ///< m that `reduce` takes for no difference of depth.
  /// By which an axis of a face is taken rather than a better one of two edges, and an axis of the
  /// first shape rather than of the second: m, and per m of depth.
  double preference = 2.5e-3;
  double preference_of_depth = 0.025;
  double parallel = 0.03;  ///< rad between the best normal and that of a face that is preferred.
  double lying = 3e-3;     ///< m per m of scale: points of a lying capsule but the deepest.

  /// Of the least separation, and of the depth along the normal, of a pair with this true gap, m.
  double of(const Pair& pair, double gap) const;
};

/// What the oracle says about one manifold.
struct Verdict {
  double gap = 0.0;  ///< True, m.
  std::vector<Complaint> complaints;
};

/// All that `solver::collide` promises about the pair, in both orders and 1024 m away:
/// - Numbers are finite, the normal is of unit length, at most four points have features of their
///   own, none is beyond the margin, and both anchors of a point are one place.
/// - The two points of the surfaces that a contact point stands for lie in the bodies.
/// - There are no points where the widest gap over the axes of separation is beyond the margin, and
///   there is at least one where the distance is below it.
/// - The least separation is the depth of bodies that overlap. That of separated bodies lies
///   between the widest gap over the axes of separation and the distance, which only differ where
///   corners are nearest.
/// - Along the normal the bodies overlap no deeper than they must, or it is within
///   `Tolerance::parallel` of the best one.
/// - A triangle pushes only to its free side. For what has its centre behind it, or gets out of it
///   sooner to the back, one-sided contact is not defined by geometry alone: it must only not
///   overlap what is apart.
Verdict verdict_on(const Pair& pair, const solver::Polyhedra& polyhedra,
                   const Tolerance& tolerance);

}  // namespace cycloid::oracle
