#include "solver/stages/stages.hpp"
#include "solver/trig.hpp"

namespace cycloid::solver {

/// A driven target: x(t) = target + A sin(2 pi f t), and its speed, so that a position motor
/// follows C(x, t) without lag.
template <int D>
static void drive_target(const Joint<D>& joint, float time_s, JointRow<D>& row) {
  if (!row.motor_holds_position || joint.drive_amplitude == 0.0f) return;
  float sine = 0.0f;
  float cosine = 0.0f;
  // Only the phase within a period, so that late ticks keep their digits.
  const float turns = joint.drive_hertz * time_s;
  const float phase = turns - static_cast<float>(static_cast<long long>(turns));
  sin_cos(2.0f * kPi * phase, sine, cosine);
  row.spring_rest = joint.target + joint.drive_amplitude * sine;
  row.target_rate = joint.drive_amplitude * 2.0f * kPi * joint.drive_hertz * cosine;
}

/// C, J and K^-1 of every joint at the present poses: wherever positions have moved since.
///
/// Reads joints, poses, deltas and masses; writes joint_rows, each its own, so any split into
/// ranges gives the same bits.
template <int D>
void evaluate_joints(const WorldState<D>& state, float time_s, Workers& workers,
                     StepScratch<D>& scratch) {
  workers.parallel_for(static_cast<int>(scratch.joint_rows.size()), kJointGrain, [&](Range range) {
    for (auto i = static_cast<std::size_t>(range.begin); i < static_cast<std::size_t>(range.end);
         ++i) {
      JointRow<D>& row = scratch.joint_rows[i];
      drive_target(state.joints[row.joint], time_s, row);
      row.mass_a = scratch.masses[row.body_a];
      row.mass_b = scratch.masses[row.body_b];
      evaluate_rows(state, time_s, scratch.motions[row.body_a], scratch.motions[row.body_b], row);
    }
  });
}

template void evaluate_joints(const WorldState<2>&, float, Workers&, StepScratch<2>&);
template void evaluate_joints(const WorldState<3>&, float, Workers&, StepScratch<3>&);

}  // namespace cycloid::solver
