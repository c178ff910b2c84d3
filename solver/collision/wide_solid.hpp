#pragma once

#include "solver/collision/solid.hpp"
#include "solver/lanes.hpp"

namespace cycloid::solver {

/// What a solid is made of by coordinate, for kernels that look at many of it at once.

/// Most lanes of a kernel: so many vectors are at hand from each multiple of it on.
inline constexpr std::uint32_t kMostLanes = 16;

/// The next multiple of kMostLanes.
constexpr std::uint32_t in_whole_lanes(std::uint32_t count) {
  return (count + kMostLanes - 1) / kMostLanes * kMostLanes;
}

/// Vectors, kMost at the most; behind the last one there is room for whole lanes.
template <std::uint32_t kMost>
struct WideVectors {
  float part[3][in_whole_lanes(kMost)];

  void set(std::uint32_t i, const Vec<3>& v) {
    for (int k = 0; k < 3; ++k) part[k][i] = v[k];
  }
};

/// The faces as planes. No point is outside of those behind the last one.
struct WidePlanes {
  explicit WidePlanes(const Solid& solid);

  std::uint32_t count;
  WideVectors<kHullFacesMax> normals;
  float offsets[in_whole_lanes(kHullFacesMax)];
};

}  // namespace cycloid::solver
