#pragma once

#include <cstring>

#include "solver/transpose.hpp"

namespace cycloid::solver {

/// The first `left` slots of a list, one in each lane, as many as there are. @returns which lanes
/// are used: where that are not all, the others stand for the last slot again.
template <int W>
[[gnu::always_inline]] inline LaneBits take_slots(const std::uint32_t* list, int left,
                                                  LaneIndices<W>& slots) {
  if (left >= kLaneCount<W>) {
    std::memcpy(slots, list, sizeof slots);
    return kAllLanes<W>;
  }
  for (int lane = 0; lane < kLaneCount<W>; ++lane)
    slots[lane] = list[lane < left ? lane : left - 1];
  return (LaneBits{1} << left) - 1;
}

}  // namespace cycloid::solver
