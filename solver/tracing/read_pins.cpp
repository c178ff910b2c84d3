#include "solver/constraints/single_lanes.hpp"
#include "solver/tracing/tracer.hpp"

namespace cycloid::solver {

template <int W>
static void add_space(const PinBlock<2, W>&, int, JointWork<2>&) {}
template <int W>
static void add_space(const PinBlock<3, W>& block, int lane, JointWork<3>& work) {
  if (block.form.has_cone) work.cone_impulse = lane_of(block.turns->cone_impulse, lane);
  for (int i = 0; i < 3 && block.form.rubs; ++i) {
    const auto at = static_cast<std::size_t>(3 + i);
    work.rows[at].angular_a[i] = -1.0f;
    work.rows[at].angular_b[i] = 1.0f;
    work.inverse_pivot[at] = lane_of(block.turns->rub_factor.inverse_pivot[i], lane);
    work.impulse[at] = lane_of(block.turns->rub_impulse[i], lane);
  }
}

/// The row of the axis. Of limits that are not near the mass may be of another substep: whether it
/// is depends on what else is in the block, so it is left out.
template <int D, int W>
static void add_axis(const PinBlock<D, W>& block, int lane, JointWork<D>& work) {
  const PinTurns<D, W>& turns = *block.turns;
  RowWork<D>& row = work.axis[0];
  row.angular_b = lane_of(turns.axis.direction, lane);
  row.angular_a = -row.angular_b;
  row.error = lane_of(turns.axis.angle, lane);
  if (block.form.has_motor || lane_of(turns.near, lane) > 0.0f)
    work.axis_mass = work.motor_mass = lane_of(turns.axis.mass, lane);
  work.motor_impulse = lane_of(turns.motor_impulse, lane);
  work.lower_impulse = lane_of(turns.lower_impulse, lane);
  work.upper_impulse = lane_of(turns.upper_impulse, lane);
}

template <int D, int W>
static JointWork<D> joint_of(const PinBlock<D, W>& block, int lane) {
  JointWork<D> work;
  work.body_a = block.body_a[lane];
  work.body_b = block.body_b[lane];
  for (int i = 0; i < equalities_of<D>(block.form); ++i) {
    const auto at = static_cast<std::size_t>(i);
    RowWork<D>& row = work.rows[at];
    if (i < D) row.linear_b = lane_of(block.direction[i], lane);
    row.linear_a = -row.linear_b;
    row.angular_a = lane_of(block.angular_a[i], lane);
    row.angular_b = lane_of(block.angular_b[i], lane);
    row.error = lane_of(block.error[i], lane);
    work.inverse_pivot[at] = lane_of(block.factor.inverse_pivot[i], lane);
    work.impulse[at] = lane_of(block.impulse[i], lane);
  }
  if (block.form.has_motor || block.form.has_limits) add_axis(block, lane, work);
  add_space(block, lane, work);
  return work;
}

template <int D>
void read_pins(const StepScratch<D>& scratch, std::vector<JointWork<D>>& joints) {
  with_blocks(scratch.pins, [&]<int W>(const PinBlocks<D, W>& pins) {
    for (const PinBlock<D, W>& block : pins.blocks)
      for (int lane = 0; lane < kLaneCount<W>; ++lane)
        if (block.place[lane] != kNone)
          joints[scratch.joint_rows[block.place[lane]].joint] = joint_of(block, lane);
  });
}

template void read_pins(const StepScratch<2>&, std::vector<JointWork<2>>&);
template void read_pins(const StepScratch<3>&, std::vector<JointWork<3>>&);

}  // namespace cycloid::solver
