#pragma once

#include <cstdint>
#include <tuple>
#include <vector>

#include "solver/constraints/block.hpp"
#include "solver/constraints/motion_lanes.hpp"
#include "solver/lane_widths.hpp"
#include "solver/workers.hpp"

namespace cycloid::solver {

/// Joints that hold two anchors at one point, W of one form at a time: pins in the plane; balls,
/// hinges and cones in space. Rows, impulses and formulas are those of JointRow; here they have one
/// place for each number of W joints, a fifth of the memory, and no branch asks what kind a joint
/// is.

/// What a pin has beside the rows of its point. All lanes of a block are of one form.
struct PinForm {
  static constexpr int kForms = 32;

  bool has_motor = false;  ///< Of speed, held to a torque.
  bool has_limits = false;
  bool has_cone = false;  ///< A limit of the swing.
  bool rubs = false;      ///< Friction about every axis, held to a torque.
  bool is_hinge = false;  ///< Two more equalities keep an axis.

  bool has_turns() const { return has_motor || has_limits || rubs || is_hinge; }
  int number() const {
    return (has_motor ? 1 : 0) | (has_limits ? 2 : 0) | (has_cone ? 4 : 0) | (rubs ? 8 : 0) |
           (is_hinge ? 16 : 0);
  }
  static PinForm of_number(int number) {
    return {(number & 1) != 0, (number & 2) != 0, (number & 4) != 0, (number & 8) != 0,
            (number & 16) != 0};
  }
};

template <int D>
[[gnu::always_inline]] inline int equalities_of(const PinForm& form) {
  return form.is_hinge ? Dim<D>::kPinEqualities : D;
}

/// How many pins of each form a colour has.
struct PinCounts {
  int of[PinForm::kForms] = {};

  /// How many blocks of `width` they fill.
  int blocks(int width) const {
    int sum = 0;
    for (const int count : of) sum += (count + width - 1) / width;
    return sum;
  }
};

/// One row that turns both bodies against each other: J = (0, -direction, 0, direction); and what
/// an impulse along it does with the equalities held (HeldRow).
template <int D, int W>
struct Couple {
  Spin<D, Lanes<W>> direction;
  Lanes<W> angle;  ///< rad, at the present poses.
  Lanes<W> mass;
  Lanes<W> reaction[Dim<D>::kPinEqualities];
};

/// What only pins of space have.
template <int D, int W>
struct SpacePin {};
template <int W>
struct SpacePin<3, W> {
  Vec<3, Lanes<W>> axis_a;     ///< The hinge's, or what a cone is about; frame of a, unit.
  Vec<3, Lanes<W>> axis_b;     ///< The same of b at creation, frame of b.
  Vec<3, Lanes<W>> across[2];  ///< Of a hinge: across the axis, frame of a.
  Couple<3, W> swing;
  Lanes<W> cone;  ///< rad
  Lanes<W> cone_impulse;
  BlockFactor<3, Lanes<W>> rub_factor;
  Lanes<W> rub_impulse[3];   ///< N m s
  Lanes<W> rub_impulse_max;  ///< Of their length.
};

/// What a pin does about how its bodies turn.
template <int D, int W>
struct PinTurns : SpacePin<D, W> {
  using L = Lanes<W>;

  Rotation<D, L> reference;  ///< Of b relative to a at creation.
  Couple<D, W> axis;         ///< Of the motor and of the limits.
  L motor_speed;             ///< rad/s
  L motor_impulse_max;       ///< N m s
  L motor_impulse;
  L lower;  ///< rad
  L upper;
  L lower_impulse;
  L upper_impulse;
  L near;  ///< Above 0 where limits are near enough to be solved (limit_is_near).
};

/// Lanes in which an equality misses more than the bounds of that name (PinKernels::look_for_rest).
struct PinRest {
  LaneBits misses;
  LaneBits stirs;
  LaneBits is_wild;
};

template <int D, int W>
struct PinBlock {
  using L = Lanes<W>;

  LaneIndices<W> body_a;  ///< Of unused lanes: one at rest without mass.
  LaneIndices<W> body_b;
  LaneIndices<W> place;  ///< Of its JointRow; kNone in unused lanes.
  LaneBits moves_a;      ///< Lanes whose body has mass.
  LaneBits moves_b;
  LaneBits used;

  // Of islands. What one has solved, biased sweeps pass by; the others do what they are told.
  LaneBits settled;  ///< Lanes whose equalities are solved at once.
  LaneBits relaxes;  ///< All the same relax sweeps act on them.
  PinRest rest;
  PinForm form;
  PinTurns<D, W>* turns;  ///< Null where the form has none.

  LaneMass<D, W> mass_a;
  LaneMass<D, W> mass_b;
  Vec<D, L> anchor_a;  ///< Frame of the body, m.
  Vec<D, L> anchor_b;
  Rotation<D, L> rotation_a;  ///< At the start of the tick.
  Rotation<D, L> rotation_b;
  Vec<D, L> centre_offset;  ///< Centre of b from centre of a, at the start of the tick, m.

  // J of equality i = (-direction, angular_a, direction, angular_b); those after the first D are
  // couples and have no direction.
  Vec<D, L> direction[D];
  Spin<D, L> angular_a[Dim<D>::kPinEqualities];
  Spin<D, L> angular_b[Dim<D>::kPinEqualities];
  L error[Dim<D>::kPinEqualities];  ///< m, or as in append_axis_rows.
  BlockFactor<Dim<D>::kPinEqualities, L> factor;
  L impulse[Dim<D>::kPinEqualities];  ///< N s, N m s
};

/// The pins of one lane width. Those of a colour are independent of one another.
template <int D, int W>
struct PinBlocks {
  static constexpr int kWidth = kLaneCount<W>;

  std::vector<PinBlock<D, W>> blocks;
  std::vector<PinTurns<D, W>> turns;  ///< By block; of use only where its form has them.
  std::vector<Range> colors;          ///< As many as the joints have.
};

/// Those of a tick.
template <int D>
struct Pins {
  static constexpr int kDimension = D;
  static constexpr std::int8_t kNone = -1;

  int lanes = 0;                        ///< The width that is used; 0 where there are no pins.
  std::vector<std::int8_t> form_of;     ///< By place of the joint rows: PinForm::number, or kNone.
  std::vector<PinCounts> counts;        ///< By colour.
  std::vector<int> lane_of;             ///< By place: the lane of all blocks in a row, or kNone.
  std::vector<std::uint32_t> place_of;  ///< By that lane; the solver's kNone where it is empty.
  ByWidth<PinBlocks, D> blocks;         ///< Only that of the width is filled.
};

/// Calls `act` with the blocks of the width that is used, if there are any.
template <class AnyPins, class Act>
void with_blocks(AnyPins& pins, Act&& act) {
  if (pins.lanes == 0) return;
  at_width(pins.lanes,
           [&]<int W>() { act(std::get<PinBlocks<AnyPins::kDimension, W>>(pins.blocks)); });
}

/// The same, with blocks of some width, of which there are none, where there are no pins.
template <class AnyPins, class Act>
void with_any_blocks(AnyPins& pins, Act&& act) {
  if (pins.lanes == 0) return act(std::get<0>(pins.blocks));
  with_blocks(pins, act);
}

}  // namespace cycloid::solver
