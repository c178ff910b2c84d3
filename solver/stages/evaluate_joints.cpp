#include "solver/constraints/joints/unwrap.hpp"
#include "solver/constraints/single_lanes.hpp"
#include "solver/stages/stages.hpp"
#include "solver/trig.hpp"

namespace cycloid::solver {

/// A driven target: x(t) = target + A sin(2 pi f t), and its speed, so that a position motor
/// follows C(x, t) without lag.
template <int D>
static void drive_target(const Joint<D>& joint, Wide time_s, JointRow<D>& row) {
  if (!row.motor_holds_position || joint.drive_amplitude == 0.0f) return;
  float sine = 0.0f;
  float cosine = 0.0f;
  // Only the phase within a period, so that late ticks keep their digits.
  const Wide turns = static_cast<Wide>(joint.drive_hertz) * time_s;
  const auto phase = static_cast<float>(turns - static_cast<Wide>(static_cast<long long>(turns)));
  sin_cos(2.0f * kPi * phase, sine, cosine);
  row.spring_rest = joint.target + joint.drive_amplitude * sine;
  row.target_rate = joint.drive_amplitude * 2.0f * kPi * joint.drive_hertz * cosine;
}

/// A drive about an angle goes the shorter way round: the coordinate leaps from pi to -pi, and what
/// has swung past there would be driven on, turn after turn. Limits that are less than a turn apart
/// leave one way, which may be the longer.
template <int D>
static void take_shorter_way(JointKind kind, JointRow<D>& row) {
  if (kind != JointKind::kRevolute && kind != JointKind::kHinge) return;
  const bool is_limited = row.limit_enabled && row.upper - row.lower < 2.0f * kPi;
  if (!row.rows.has_axis || is_limited) return;
  row.spring_rest = nearest_turn(row.spring_rest, row.rows.axis.error);
}

/// The masses of bodies whose inertia has turned.
template <int D, int W>
static void follow_inertia(const StepScratch<D>& scratch, Range range, PinBlocks<D, W>& pins) {
  if (Dim<D>::kSpin == 1) return;
  for (int i = range.begin; i < range.end; ++i) {
    PinBlock<D, W>& block = pins.blocks[static_cast<std::size_t>(i)];
    for (int lane = 0; lane < kLaneCount<W>; ++lane) {
      const std::uint32_t a = block.body_a[lane];
      const std::uint32_t b = block.body_b[lane];
      if (scratch.inertia_turned[a] == 0 && scratch.inertia_turned[b] == 0) continue;
      set_mass(block.mass_a, lane, scratch.masses[a]);
      set_mass(block.mass_b, lane, scratch.masses[b]);
    }
  }
}

/// C, J and K^-1 of every joint at the present poses: wherever positions have moved since.
///
/// Reads joints, poses, deltas and masses; writes pins and joint rows, each its own, so any split
/// into ranges gives the same bits.
template <int D>
void evaluate_joints(const StepContext<D>& context, const WorldState<D>& state, Wide time_s,
                     Workers& workers, StepScratch<D>& scratch) {
  if (scratch.joint_rows.empty()) return;
  with_blocks(scratch.pins, [&]<int W>(PinBlocks<D, W>& pins) {
    for_each_part_of_colors(pins.colors, {}, workers, [&](Range range) {
      follow_inertia(scratch, range, pins);
      PinKernels<D, W>::evaluate(kLimitReach_substeps * context.h, pin_range<D, W>(scratch, range));
    });
  });
  const std::vector<int>& single = scratch.single_rows.order;
  workers.parallel_for(static_cast<int>(single.size()), kJointGrain, [&](Range range) {
    for (int i = range.begin; i < range.end; ++i) {
      const int place = single[static_cast<std::size_t>(i)];
      JointRow<D>& row = scratch.joint_rows[static_cast<std::size_t>(place)];
      const Joint<D>& joint = state.joints[row.joint];
      drive_target(joint, time_s, row);
      row.mass_a = scratch.masses[row.body_a];
      row.mass_b = scratch.masses[row.body_b];
      evaluate_rows(state, time_s, scratch.motions[row.body_a], scratch.motions[row.body_b], row);
      take_shorter_way(joint.kind, row);
    }
  });
}

template void evaluate_joints(const StepContext<2>&, const WorldState<2>&, Wide, Workers&,
                              StepScratch<2>&);
template void evaluate_joints(const StepContext<3>&, const WorldState<3>&, Wide, Workers&,
                              StepScratch<3>&);

}  // namespace cycloid::solver
