#include <array>
#include <cstring>
#include <optional>
#include <type_traits>

#include "solver/constraints/single_lanes.hpp"
#include "solver/lane_widths.hpp"
#include "solver/stages/stages.hpp"
#include "solver/trig.hpp"

namespace cycloid::solver {

/// The form of a joint as a pin; nothing of what stays a row by itself: other kinds, springs and
/// position motors.
template <int D>
static std::optional<PinForm> form_of(const Joint<D>& joint, const JointRow<D>& row) {
  PinForm form;
  switch (joint.kind) {
    case JointKind::kRevolute:
      if (Dim<D>::kSpin > 1) return form;  // A ball joint has no coordinate.
      break;
    case JointKind::kHinge:
      form.is_hinge = true;
      break;
    case JointKind::kConeTwist:
      if (joint.angular_hertz > 0.0f) return {};
      form.rubs = joint.torque_max > 0.0f;
      form.has_cone = row.limit_enabled && joint.cone < kPi;
      break;
    default:
      return {};
  }
  if (row.spring_enabled || row.motor_holds_position) return {};
  form.has_limits = row.limit_enabled;
  form.has_motor = row.motor_enabled;
  return form;
}

/// Whether only velocity sweeps act on joints, which are all that pins in lanes know.
static bool sweeps_alone(const Tuning& tuning) {
  const bool sweeps = tuning.stabilisation == Stabilisation::kSoft ||
                      tuning.stabilisation == Stabilisation::kBaumgarte;
  return sweeps && tuning.joint_solver != JointSolver::kDirect;
}

template <int W>
static void set_space(const Joint<2>&, const JointRow<2>&, int, PinTurns<2, W>&) {}
template <int W>
static void set_space(const Joint<3>& joint, const JointRow<3>& row, int lane,
                      PinTurns<3, W>& turns) {
  Vec<3> across[2];
  tangents(joint.axis, across);
  set_lane(turns.axis_a, lane, joint.axis);
  set_lane(turns.axis_b, lane, rotate_back(joint.reference, joint.axis));
  for (int i = 0; i < 2; ++i) set_lane(turns.across[i], lane, across[i]);
  set_lane(turns.cone, lane, row.cone);
  set_lane(turns.cone_impulse, lane, row.cone_impulse);
  set_lane(turns.rub_impulse_max, lane, row.impulse_max[1]);
  for (int i = 0; i < 3; ++i) set_lane(turns.rub_impulse[i], lane, row.impulse[3 + i]);
}

template <int D, int W>
static void set_turns(const Joint<D>& joint, const JointRow<D>& row, int lane,
                      PinTurns<D, W>& turns) {
  set_space(joint, row, lane, turns);
  set_lane(turns.reference, lane, joint.reference);
  set_lane(turns.motor_speed, lane, row.motor_speed);
  set_lane(turns.motor_impulse_max, lane, row.motor_impulse_max);
  set_lane(turns.motor_impulse, lane, row.motor_impulse);
  set_lane(turns.lower, lane, row.lower);
  set_lane(turns.upper, lane, row.upper);
  set_lane(turns.lower_impulse, lane, row.lower_impulse);
  set_lane(turns.upper_impulse, lane, row.upper_impulse);
}

template <int D, int W>
static void set_pin(const WorldState<D>& state, const JointRow<D>& row, std::uint32_t place,
                    int lane, PinBlock<D, W>& block) {
  const Joint<D>& joint = state.joints[row.joint];
  block.body_a[lane] = row.body_a;
  block.body_b[lane] = row.body_b;
  block.place[lane] = place;
  const LaneBits bit = LaneBits{1} << lane;
  block.used |= bit;
  if (row.solved_directly) block.settled |= bit;
  if (row.mass_a.inverse_mass > 0.0f) block.moves_a |= bit;
  if (row.mass_b.inverse_mass > 0.0f) block.moves_b |= bit;
  set_mass(block.mass_a, lane, row.mass_a);
  set_mass(block.mass_b, lane, row.mass_b);
  set_lane(block.anchor_a, lane, joint.anchor_a);
  set_lane(block.anchor_b, lane, joint.anchor_b);
  set_lane(block.rotation_a, lane, state.bodies[row.body_a].rotation);
  set_lane(block.rotation_b, lane, state.bodies[row.body_b].rotation);
  set_lane(block.centre_offset, lane, row.centre_offset);
  for (int i = 0; i < equalities_of<D>(block.form); ++i)
    set_lane(block.impulse[i], lane, row.impulse[i]);
  if (block.turns != nullptr) set_turns(joint, row, lane, *block.turns);
}

template <int D, int W>
static void clear(const PinForm& form, std::uint32_t resting_body, PinTurns<D, W>& turns,
                  PinBlock<D, W>& block) {
  static_assert(std::is_trivially_copyable_v<PinBlock<D, W>>);
  static_assert(std::is_trivially_copyable_v<PinTurns<D, W>>);
  std::memset(static_cast<void*>(&block), 0, sizeof block);
  for (std::uint32_t& body : block.body_a) body = resting_body;
  for (std::uint32_t& body : block.body_b) body = resting_body;
  for (std::uint32_t& place : block.place) place = kNone;
  block.form = form;
  if (!form.has_turns()) return;
  std::memset(static_cast<void*>(&turns), 0, sizeof turns);
  block.turns = &turns;
}

/// By form, the first lane of its first block in a colour, all lanes of all blocks being counted in
/// a row.
static std::array<int, PinForm::kForms> first_lanes(const PinCounts& counts, int block, int width) {
  std::array<int, PinForm::kForms> first{};
  for (int form = 0; form < PinForm::kForms; ++form) {
    first[static_cast<std::size_t>(form)] = block * width;
    block += (counts.of[form] + width - 1) / width;
  }
  return first;
}

/// Gives every pin a lane: those of one form stand in a row, colour by colour.
template <int D, int W>
static void assign_lanes(const StepScratch<D>& scratch, Pins<D>& pins, PinBlocks<D, W>& out) {
  out.colors.clear();
  int end = 0;
  for (const PinCounts& counts : pins.counts) {
    out.colors.push_back({end, end + counts.blocks(kLaneCount<W>)});
    end = out.colors.back().end;
  }
  pins.place_of.assign(static_cast<std::size_t>(end * kLaneCount<W>), kNone);
  for (std::size_t c = 0; c < pins.counts.size(); ++c) {
    std::array<int, PinForm::kForms> next =
        first_lanes(pins.counts[c], out.colors[c].begin, kLaneCount<W>);
    const Range color = scratch.joint_coloring.colors[c];
    for (int i = color.begin; i < color.end; ++i) {
      const auto place = static_cast<std::size_t>(i);
      if (pins.form_of[place] == Pins<D>::kNone) continue;
      const int lane = next[static_cast<std::size_t>(pins.form_of[place])]++;
      pins.lane_of[place] = lane;
      pins.place_of[static_cast<std::size_t>(lane)] = static_cast<std::uint32_t>(i);
    }
  }
}

/// Blocks of W pins of one form, each by itself. @pre assign_lanes.
template <int D, int W>
static void fill_blocks(const WorldState<D>& state, Workers& workers, StepScratch<D>& scratch,
                        PinBlocks<D, W>& out) {
  Pins<D>& pins = scratch.pins;
  assign_lanes(scratch, pins, out);
  const auto resting_body = static_cast<std::uint32_t>(state.bodies.size());
  const std::size_t count = pins.place_of.size() / kLaneCount<W>;
  out.blocks.resize(count);
  out.turns.resize(count);
  for_each_part_of_colors(out.colors, {}, workers, [&](Range range) {
    for (int b = range.begin; b < range.end; ++b) {
      const auto at = static_cast<std::size_t>(b);
      const std::uint32_t* places = pins.place_of.data() + at * kLaneCount<W>;
      PinBlock<D, W>& block = out.blocks[at];
      clear(PinForm::of_number(pins.form_of[places[0]]), resting_body, out.turns[at], block);
      for (int lane = 0; lane < kLaneCount<W> && places[lane] != kNone; ++lane)
        set_pin(state, scratch.joint_rows[places[lane]], places[lane], lane, block);
    }
  });
}

static void name_cone(const PinForm&, JointRow<2>&) {}
static void name_cone(const PinForm& form, JointRow<3>& row) {
  row.rows.has_cone_axis = form.has_cone;
}

/// How many rows a pin has, which others count, though it does not fill them.
template <int D>
static void name_rows(const PinForm& form, JointRow<D>& row) {
  row.rows.split = equalities_of<D>(form);
  row.rows.count = row.rows.split + (form.rubs ? Dim<D>::kSpin : 0);
  name_cone(form, row);
}

/// Which rows are pins, and of which form. Each row by itself; those of the overflow are none.
template <int D>
static void find_forms(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                       StepScratch<D>& scratch) {
  Pins<D>& pins = scratch.pins;
  pins.form_of.assign(scratch.joint_rows.size(), Pins<D>::kNone);
  if (!sweeps_alone(context.tuning)) return;
  const int count = scratch.joint_coloring.overflow.begin;
  workers.parallel_for(count, kJointGrain, [&](Range range) {
    for (int i = range.begin; i < range.end; ++i) {
      const auto place = static_cast<std::size_t>(i);
      JointRow<D>& row = scratch.joint_rows[place];
      const std::optional<PinForm> form = form_of(state.joints[row.joint], row);
      if (!form) continue;
      name_rows(*form, row);
      pins.form_of[place] = static_cast<std::int8_t>(form->number());
    }
  });
}

/// Counts the pins of each colour by form, and lists the rows that are none. @pre find_forms.
template <int D>
static void sort_rows(StepScratch<D>& scratch) {
  const Coloring& joints = scratch.joint_coloring;
  Coloring& single = scratch.single_rows;
  Pins<D>& pins = scratch.pins;
  single.order.clear();
  single.colors.clear();
  pins.counts.clear();
  pins.lane_of.assign(scratch.joint_rows.size(), Pins<D>::kNone);
  for (const Range& color : joints.colors) {
    PinCounts& counts = pins.counts.emplace_back();
    const auto begin = static_cast<int>(single.order.size());
    for (int i = color.begin; i < color.end; ++i) {
      const std::int8_t form = pins.form_of[static_cast<std::size_t>(i)];
      if (form == Pins<D>::kNone)
        single.order.push_back(i);
      else
        ++counts.of[form];
    }
    single.colors.push_back({begin, static_cast<int>(single.order.size())});
  }
  single.overflow.begin = static_cast<int>(single.order.size());
  for (int i = joints.overflow.begin; i < joints.overflow.end; ++i) single.order.push_back(i);
  single.overflow.end = static_cast<int>(single.order.size());
}

/// The width for the pins that were counted; 0 where there are none.
template <int D>
static int width_of_pins(int lanes, const Pins<D>& pins) {
  const auto blocks_of = [&](int width) {
    int sum = 0;
    for (const PinCounts& counts : pins.counts) sum += counts.blocks(width);
    return sum;
  };
  if (blocks_of(1) == 0) return 0;
  return lanes == 0 ? width_that_saves(blocks_of) : in_best_set(lanes);
}

/// Takes the pins among the joint rows into lanes, colour by colour; the other rows are solved one
/// by one, and so is the overflow.
///
/// Reads joints, their rows, bodies and the colouring; writes the blocks of pins and the list of
/// the other rows. Each row and each block by itself; which pins share a block does not show.
template <int D>
void prepare_pins(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                  StepScratch<D>& scratch) {
  find_forms(context, state, workers, scratch);
  sort_rows(scratch);
  scratch.pins.lanes = width_of_pins(context.lanes, scratch.pins);
  with_blocks(scratch.pins, [&](auto& blocks) { fill_blocks(state, workers, scratch, blocks); });
}

template <int W>
static void store_space(const PinBlock<2, W>&, int, JointRow<2>&) {}
template <int W>
static void store_space(const PinBlock<3, W>& block, int lane, JointRow<3>& row) {
  if (block.form.has_cone) row.cone_impulse = lane_of(block.turns->cone_impulse, lane);
  for (int i = 0; i < 3 && block.form.rubs; ++i)
    row.impulse[3 + i] = lane_of(block.turns->rub_impulse[i], lane);
}

template <int D, int W>
static void store_pin(const PinBlock<D, W>& block, int lane, JointRow<D>& row) {
  for (int i = 0; i < equalities_of<D>(block.form); ++i)
    row.impulse[i] = lane_of(block.impulse[i], lane);
  if (block.form.has_motor) row.motor_impulse = lane_of(block.turns->motor_impulse, lane);
  if (block.form.has_limits) {
    row.lower_impulse = lane_of(block.turns->lower_impulse, lane);
    row.upper_impulse = lane_of(block.turns->upper_impulse, lane);
  }
  store_space(block, lane, row);
}

/// Reads the blocks of pins; writes the impulses of their joint rows, for the next tick's warm
/// start.
template <int D>
void store_pins(Workers& workers, StepScratch<D>& scratch) {
  with_blocks(scratch.pins, [&]<int W>(const PinBlocks<D, W>& pins) {
    for_each_part_of_colors(pins.colors, {}, workers, [&](Range range) {
      for (int i = range.begin; i < range.end; ++i) {
        const PinBlock<D, W>& block = pins.blocks[static_cast<std::size_t>(i)];
        for (int lane = 0; lane < kLaneCount<W>; ++lane)
          if (block.place[lane] != kNone)
            store_pin(block, lane, scratch.joint_rows[block.place[lane]]);
      }
    });
  });
}

template void prepare_pins(const StepContext<2>&, const WorldState<2>&, Workers&, StepScratch<2>&);
template void prepare_pins(const StepContext<3>&, const WorldState<3>&, Workers&, StepScratch<3>&);
template void store_pins(Workers&, StepScratch<2>&);
template void store_pins(Workers&, StepScratch<3>&);

}  // namespace cycloid::solver
