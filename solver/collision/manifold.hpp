#pragma once

#include <array>
#include <cstdint>

#include "solver/dim.hpp"

namespace cycloid::solver {

template <int D>
struct ManifoldPoint {
  Vec<D> anchor_a;   ///< From the centre of mass of body a, world axes, m.
  float separation;  ///< m; negative where the shapes overlap.
  std::uint32_t feature;
};

/// From the centre of mass of body b, whose centre lies `between` away from that of a, m.
template <int D>
Vec<D> anchor_b_of(const ManifoldPoint<D>& point, const Vec<D>& between) {
  return point.anchor_a - between;
}

/// Where two shapes meet; the normal points from a to b. No point: they are apart.
template <int D>
struct Manifold {
  Vec<D> normal;
  std::uint32_t point_count = 0;
  std::array<ManifoldPoint<D>, Dim<D>::kManifoldPoints> points;
};

/// Where a body's centre of mass is, and how it is turned.
template <int D>
struct Pose {
  Vec<D> position;
  Rotation<D> rotation;
};

/// One contact point of a manifold whose shapes are given relative to body a's centre: `at` lies
/// midway between the surfaces.
template <int D>
void add_point(const Vec<D>& at, float separation, std::uint32_t feature, Manifold<D>& manifold) {
  ManifoldPoint<D>& point = manifold.points[manifold.point_count++];
  point.anchor_a = at;
  point.separation = separation;
  point.feature = feature;
}

}  // namespace cycloid::solver
