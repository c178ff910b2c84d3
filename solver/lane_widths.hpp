#pragma once

#include "solver/instruction_sets.hpp"
#include "solver/lanes.hpp"

namespace cycloid::solver {

/// Which width a kernel runs in. None changes a bit; they differ in how long they take.

/// A width in the instruction set that this processor has for it.
inline int in_best_set(int lanes) {
  if (lanes == 8 && has_avx2_kernels()) return kAvx2Lanes;
  if (lanes == 16 && has_avx512_kernels()) return kAvx512Lanes;
  return lanes;
}

/// The width for what fills as many lanes as it likes; 0 stands for the widest of one instruction.
inline int widest_lanes(int lanes) {
  if (lanes != 0) return in_best_set(lanes);
  return has_avx512_kernels() ? kAvx512Lanes : has_avx2_kernels() ? kAvx2Lanes : 4;
}

/// The width that solves constraints soonest: the wider one where it is there and saves blocks, of
/// 16 lanes a third of them, for such a block takes longer. One lane never does: even a single
/// constraint costs less in a block of four, whose gathering is made of whole loads.
/// @param blocks_of  How many blocks of so many lanes their colours fill.
template <class BlocksOf>
int width_that_saves(BlocksOf&& blocks_of) {
  if (!has_avx2_kernels()) return 4;
  const int of_eight = blocks_of(8);
  if (has_avx512_kernels() && 3 * blocks_of(16) < 2 * of_eight) return kAvx512Lanes;
  return of_eight < blocks_of(4) ? kAvx2Lanes : 4;
}

/// How many of a range go W at a time. The last ones, where they would leave half of the lanes
/// empty, take less time in lanes of `kFewLanes`.
template <int W>
constexpr int count_for_lanes(int count) {
  const int last = count % kLaneCount<W>;
  return 2 * last > kLaneCount<W> ? count : count - last;
}
template <int W>
inline constexpr int kFewLanes = kLaneCount<W> < 4 ? W : 4;

/// Calls act.template operator()<W>() for the width W.
template <class Act>
decltype(auto) at_width(int width, Act&& act) {
  switch (width) {
    case 1:
      return act.template operator()<1>();
    case 8:
      return act.template operator()<8>();
    case 16:
      return act.template operator()<16>();
    case kAvx2Lanes:
      return act.template operator()<kAvx2Lanes>();
    case kAvx512Lanes:
      return act.template operator()<kAvx512Lanes>();
    default:
      return act.template operator()<4>();
  }
}

/// The same for the widest that this processor has, where the width shows in no result.
template <class Act>
decltype(auto) at_widest(Act&& act) {
  if (has_avx512_kernels()) return act.template operator()<kAvx512Lanes>();
  if (has_avx2_kernels()) return act.template operator()<kAvx2Lanes>();
  return act.template operator()<4>();
}

}  // namespace cycloid::solver
