#pragma once

#include <string>
#include <vector>

#include "solver/collision/manifold.hpp"
#include "solver/world.hpp"
#include "tests/oracle/convex.hpp"
#include "tests/oracle/random.hpp"

namespace cycloid::oracle {

inline Vector to_double(const solver::Vec<3>& v) {
  return {v[0], v[1], v[2]};
}
inline solver::Vec<3> to_float(const Vector& v) {
  return {{static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)}};
}

/// The kinds of shapes that the fuzz draws pairs from.
enum class Kind { kBall, kCapsule, kBox, kHull, kHalfSpace, kTriangle };
inline constexpr int kKinds = 6;
const char* name_of(Kind kind);
/// Half-spaces and triangles stand still, so two of them never meet.
inline bool is_fixed(Kind kind) {
  return kind == Kind::kHalfSpace || kind == Kind::kTriangle;
}
/// Without faces: balls and capsules.
inline bool is_round(Kind kind) {
  return kind == Kind::kBall || kind == Kind::kCapsule;
}

/// One shape twice: as the world holds it, and for the oracle; both from the centre of mass.
struct Specimen {
  Kind kind = Kind::kBall;
  Convex body;        ///< Of a half-space: one corner, on its surface.
  Vector normal;      ///< Half-space and triangle: of the free side.
  double size = 0.0;  ///< Farthest point from the centre of mass, m; of a half-space 0.
  solver::Shape<3> shape;
  solver::ShapeDef<3> def;  ///< As it was created, to be printed.
};

/// A world with `count` shapes of every kind, each on a body of its own.
struct Collection {
  solver::World<3> world;
  std::vector<Specimen> specimens[kKinds];
  std::vector<std::string> refused;  ///< "hull: points" where the world would not have a shape.
};

/// Sizes are log-uniform from 0.05 to 5 m, with aspect ratios up to 20. `regular` ones have
/// corners on a grid, symmetric about the centre, and faces along the axes, so that axis-aligned
/// poses make features coincide.
Collection make_collection(Random& random, int count, bool regular);

/// Lines of C++-like text with all digits.
std::string describe(const Specimen& specimen);
std::string describe(const solver::Pose<3>& pose);

}  // namespace cycloid::oracle
