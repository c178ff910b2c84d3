#pragma once

#include <vector>

#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

/// Shapes of space that many tests need.

inline ShapeDef<3> box_def(const Vec<3>& half) {
  ShapeDef<3> shape;
  shape.kind = ShapeKind::kBox;
  shape.half = half;
  return shape;
}

inline ShapeDef<3> capsule_def(const Vec<3>& from, const Vec<3>& to, float radius) {
  ShapeDef<3> shape;
  shape.kind = ShapeKind::kCapsule;
  shape.points = {from, to};
  shape.radius = radius;
  return shape;
}

/// About the unit axis by `angle` rad.
inline Rotation<3> turned_about(const Vec<3>& axis, float angle) {
  const float sine = std::sin(0.5f * angle);
  return {{sine * axis[0], sine * axis[1], sine * axis[2], std::cos(0.5f * angle)}};
}

}  // namespace cycloid::solver
