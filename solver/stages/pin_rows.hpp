#pragma once

#include <type_traits>

#include "solver/constraints/pin_block.hpp"
#include "solver/direct/island_solver.hpp"

namespace cycloid::solver {

/// Calls act(block, lane, group) for each of these groups, which are of joints, that is a pin, and
/// act(null, place of its row, group) for each other one. `AnyPins` may be const.
template <class AnyPins, int D, class Act>
void for_each_joint(AnyPins& pins, const IslandSolver<D>& solver, Range joints, Act&& act) {
  with_any_blocks(pins, [&](auto& blocks) {
    constexpr int kWidth = std::remove_cvref_t<decltype(blocks)>::kWidth;
    for (int g = joints.begin; g < joints.end; ++g) {
      const int place = solver.sources[static_cast<std::size_t>(g)].place;
      const int at = pins.lane_of[static_cast<std::size_t>(place)];
      if (at < 0)
        act(static_cast<decltype(blocks.blocks.data())>(nullptr), place, g);
      else
        act(&blocks.blocks[static_cast<std::size_t>(at / kWidth)], at % kWidth, g);
    }
  });
}

}  // namespace cycloid::solver
