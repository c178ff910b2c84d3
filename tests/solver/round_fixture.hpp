#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "solver/collision/rod.hpp"

namespace cycloid::solver {

inline Solid make_box(const Vec<3>& half, const Vec<3>& position,
                      const Rotation<3>& rotation = identity_rotation<3>()) {
  Shape<3> shape;
  shape.kind = ShapeKind::kBox;
  shape.vertices[0] = Vec<3>::zero();
  shape.half = half;
  shape.rotation = identity_rotation<3>();
  Solid solid;
  place(shape, {}, rotation, position, solid);
  return solid;
}

struct Draw {
  std::mt19937 generator{7};
  float within(float lower, float upper) {
    const double unit = static_cast<double>(generator()) / 4294967296.0;
    return static_cast<float>(lower + (upper - lower) * unit);
  }
  Vec<3> vector(float size) {
    return {{within(-size, size), within(-size, size), within(-size, size)}};
  }
  Rotation<3> rotation() {
    Rotation<3> q = {{within(-1, 1), within(-1, 1), within(-1, 1), within(-1, 1)}};
    return normalized_or(q, identity_rotation<3>());
  }
};

inline float deepest(const Manifold<3>& manifold) {
  float separation = 1.0e30f;
  for (std::uint32_t i = 0; i < manifold.point_count; ++i)
    separation = std::min(separation, manifold.points[i].separation);
  return separation;
}

inline bool is_finite(const Manifold<3>& manifold) {
  bool finite = true;
  for (std::uint32_t i = 0; i < manifold.point_count; ++i)
    for (int k = 0; k < 3; ++k)
      finite = finite && std::isfinite(manifold.points[i].anchor_a[k]) &&
               std::isfinite(manifold.points[i].separation);
  return finite && (manifold.point_count == 0 || std::abs(length(manifold.normal) - 1.0f) < 1e-5f);
}

inline void expect_normal(const Manifold<3>& manifold, float x, float y, float z,
                          float within = 1e-6f) {
  EXPECT_NEAR(manifold.normal[0], x, within);
  EXPECT_NEAR(manifold.normal[1], y, within);
  EXPECT_NEAR(manifold.normal[2], z, within);
}

inline const Vec<3> kZero = Vec<3>::zero();

}  // namespace cycloid::solver
