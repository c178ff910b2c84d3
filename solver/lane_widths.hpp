#pragma once

#include <tuple>
#include <utility>

#include "solver/instruction_sets.hpp"
#include "solver/lanes.hpp"

namespace cycloid::solver {

/// Which width a kernel runs in. None changes a bit; they differ in how long they take.

template <int... W>
struct Widths {};

/// Those that kernels are compiled for. Wider ones than 4 for the instruction sets alone that have
/// vectors of that width.
#ifdef CYCLOID_AVX_KERNELS  // Set by solver/CMakeLists.txt, which compiles the units of both sets.
inline constexpr bool kHasAvxKernels = true;
using LaneWidths = Widths<1, 4, kAvx2Lanes, kAvx512Lanes>;
#else
inline constexpr bool kHasAvxKernels = false;
using LaneWidths = Widths<1, 4>;
#endif

template <template <int, int> class Of, int D, class>
struct TupleOfWidths;
template <template <int, int> class Of, int D, int... W>
struct TupleOfWidths<Of, D, Widths<W...>> {
  using Tuple = std::tuple<Of<D, W>...>;
};
/// One of every width.
template <template <int, int> class Of, int D>
using ByWidth = typename TupleOfWidths<Of, D, LaneWidths>::Tuple;

/// Explicitly instantiated, it makes what members of `Of<D, W>` point at, of every width, in the
/// plane and in space.
template <template <int, int> class Of>
struct AtEveryWidth {
  static constexpr std::pair<ByWidth<Of, 2>, ByWidth<Of, 3>> kAll{};
};

/// The widest that this processor has of at most so many lanes.
inline int in_best_set(int lanes) {
  if (lanes >= 16 && has_avx512_kernels()) return kAvx512Lanes;
  if (lanes >= 8 && has_avx2_kernels()) return kAvx2Lanes;
  return lanes < 4 ? 1 : 4;
}

/// The width for what fills as many lanes as it likes; 0 stands for the widest of one instruction.
inline int widest_lanes(int lanes) {
  return in_best_set(lanes == 0 ? kLaneCount<kAvx512Lanes> : lanes);
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

/// The next narrower width, down to 4; of 4 and 1 themselves.
template <int W>
inline constexpr int kFewerLanes = W == kAvx512Lanes ? kAvx2Lanes
                                   : W == kAvx2Lanes ? 4
                                                     : W;

/// Calls act.template operator()<V>(from, to) for ranges that make up [begin, end), W at a time.
/// The last ones, where they would leave half of the lanes empty, take less time in fewer.
template <int W, class Act>
void in_lanes(int begin, int end, Act&& act) {
  const int last = (end - begin) % kLaneCount<W>;
  const bool fewer = W != kFewerLanes<W> && 2 * last <= kLaneCount<W>;
  const int wide = fewer ? end - last : end;
  if (wide > begin) act.template operator()<W>(begin, wide);
  if constexpr (W != kFewerLanes<W>)
    if (wide < end) in_lanes<kFewerLanes<W>>(wide, end, act);
}

/// Calls act.template operator()<V>() for the narrowest width, of W and those below it, of which
/// one instruction holds so many.
template <int W, class Act>
decltype(auto) in_lanes_that_hold(int count, Act&& act) {
  if constexpr (W != kFewerLanes<W>)
    if (count <= kLaneCount<kFewerLanes<W>>) return in_lanes_that_hold<kFewerLanes<W>>(count, act);
  return act.template operator()<W>();
}

/// Calls act.template operator()<W>() for the width W, one of LaneWidths.
template <class Act>
decltype(auto) at_width(int width, Act&& act) {
  if constexpr (kHasAvxKernels) {
    if (width == kAvx512Lanes) return act.template operator()<kAvx512Lanes>();
    if (width == kAvx2Lanes) return act.template operator()<kAvx2Lanes>();
  }
  if (width == 1) return act.template operator()<1>();
  return act.template operator()<4>();
}

/// The same for the widest that this processor has, of 4 or more.
template <class Act>
decltype(auto) at_widest(Act&& act) {
  if constexpr (kHasAvxKernels) {
    if (has_avx512_kernels()) return act.template operator()<kAvx512Lanes>();
    if (has_avx2_kernels()) return act.template operator()<kAvx2Lanes>();
  }
  return act.template operator()<4>();
}

}  // namespace cycloid::solver
