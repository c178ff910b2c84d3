#pragma once

#include <cstdint>

#include "solver/collision/manifold.hpp"

namespace cycloid::solver {

/// Two shapes at their bodies' poses, about to be collided.
template <int D>
struct PlacedPair {
  Pose<D> pose_a;
  Pose<D> pose_b;
  std::uint32_t shape_a;
  std::uint32_t shape_b;
  float margin;  ///< Points that are farther apart are none, m.
};

}  // namespace cycloid::solver
