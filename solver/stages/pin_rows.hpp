#pragma once

#include <type_traits>
#include <vector>

#include "solver/constraints/joint_row.hpp"
#include "solver/constraints/pin_block.hpp"
#include "solver/constraints/single_lanes.hpp"

namespace cycloid::solver {

/// Single pins in their blocks, by place of the joint rows: for the few that more than sweeps look
/// at. What is no pin they leave alone.

/// Calls `act(block, lane)` with where a pin is.
template <class AnyPins, class Act>
void with_pin(AnyPins& pins, std::size_t place, Act&& act) {
  if (pins.lane_of[place] < 0) return;
  with_blocks(pins, [&](auto& blocks) {
    constexpr int kWidth = std::remove_cvref_t<decltype(blocks)>::kWidth;
    act(blocks.blocks[static_cast<std::size_t>(pins.lane_of[place] / kWidth)],
        pins.lane_of[place] % kWidth);
  });
}

/// Its equalities and their impulses as a joint row has them.
template <int D>
void unpack_pin(const Pins<D>& pins, std::size_t place, std::vector<JointRow<D>>& rows) {
  with_pin(pins, place, [&](const auto& block, int lane) {
    JointRow<D>& joint = rows[place];
    for (int i = 0; i < equalities_of<D>(block.form); ++i) {
      Row<D>& row = joint.rows.rows[static_cast<std::size_t>(i)];
      row = Row<D>{};
      if (i < D) {
        row.linear_b = lane_of(block.direction[i], lane);
        row.linear_a = -row.linear_b;
      }
      row.angular_a = lane_of(block.angular_a[i], lane);
      row.angular_b = lane_of(block.angular_b[i], lane);
      row.error = lane_of(block.error[i], lane);
      joint.impulse[i] = lane_of(block.impulse[i], lane);
    }
  });
}

/// Writes the impulses of its row back.
template <int D>
void take_impulses(const std::vector<JointRow<D>>& rows, std::size_t place, Pins<D>& pins) {
  with_pin(pins, place, [&](auto& block, int lane) {
    for (int i = 0; i < equalities_of<D>(block.form); ++i)
      set_lane(block.impulse[i], lane, rows[place].impulse[i]);
  });
}

/// Tells the sweeps whether an island has solved it, and whether relax sweeps act all the same.
template <int D>
void settle_pin(std::size_t place, bool settled, bool relaxes, Pins<D>& pins) {
  with_pin(pins, place, [&](auto& block, int lane) {
    const LaneBits bit = LaneBits{1} << lane;
    block.settled = settled ? block.settled | bit : block.settled & ~bit;
    block.relaxes = relaxes ? block.relaxes | bit : block.relaxes & ~bit;
  });
}

}  // namespace cycloid::solver
