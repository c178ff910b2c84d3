#pragma once

#include "solver/transpose.hpp"

namespace cycloid::solver {

/// Sets of lanes as bits, and as masks.

/// The mask of the lanes in `bits`.
template <int W>
[[gnu::always_inline]] inline typename Lanes<W>::Mask mask_of(LaneBits bits) {
  typename Lanes<W>::Mask mask{};
  for (int lane = 0; lane < kLaneCount<W>; ++lane) mask[lane] = static_cast<int>(1u << lane);
  return (mask & static_cast<int>(bits)) != 0;
}

/// Lanes in which a number is above 0.
template <int W>
[[gnu::always_inline]] inline LaneBits lanes_above_zero(const Lanes<W>& a) {
  return bits_of<W>(a > Lanes<W>(0.0f));
}

}  // namespace cycloid::solver
