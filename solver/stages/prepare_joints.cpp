#include "solver/stages/stages.hpp"

namespace cycloid::solver {

static Rotation<2> conjugate(const Rotation<2>& q) {
  return {{q[0], -q[1]}};
}
static Rotation<3> conjugate(const Rotation<3>& q) {
  return {{-q[0], -q[1], -q[2], q[3]}};
}

template <int D>
static JointRow<D> make_row(const StepContext<D>& context, const WorldState<D>& state,
                            const StepScratch<D>& scratch, std::uint32_t slot) {
  const Joint<D>& joint = state.joints[slot];
  const Body<D>& a = state.bodies[joint.body_a];
  const Body<D>& b = state.bodies[joint.body_b];
  JointRow<D> row;
  row.joint = slot;
  row.kind = joint.kind;
  row.body_a = joint.body_a;
  row.body_b = joint.body_b;
  row.mass_a = scratch.masses[joint.body_a];
  row.mass_b = scratch.masses[joint.body_b];
  row.r_a = rotate(a.rotation, joint.anchor_a);
  row.r_b = rotate(b.rotation, joint.anchor_b);
  row.centre_offset = b.position - a.position;
  row.angle = compose(conjugate(joint.reference), compose(conjugate(a.rotation), b.rotation));
  row.length = joint.length;
  row.is_spring = joint.hertz > 0.0f;
  row.spring = spring_softness(joint.hertz, joint.damping_ratio, context.h);
  row.limit_enabled = joint.limit_enabled != 0;
  row.motor_enabled = joint.motor_enabled != 0;
  row.lower_angle = joint.lower_angle;
  row.upper_angle = joint.upper_angle;
  row.motor_speed = joint.motor_speed;
  row.motor_torque_max = joint.motor_torque_max;
  row.impulse = joint.impulse;
  row.motor_impulse = row.motor_enabled ? joint.motor_impulse : 0.0f;
  row.lower_impulse = row.limit_enabled ? joint.lower_impulse : 0.0f;
  row.upper_impulse = row.limit_enabled ? joint.upper_impulse : 0.0f;
  return row;
}

/// One row per live joint, in the order of the colouring.
///
/// Reads joints, poses and masses; writes joint_rows, each from its own joint.
template <int D>
void prepare_joints(const StepContext<D>& context, const WorldState<D>& state,
                    StepScratch<D>& scratch) {
  scratch.joint_rows.clear();
  for (const int slot : scratch.joint_coloring.order)
    scratch.joint_rows.push_back(
        make_row(context, state, scratch, static_cast<std::uint32_t>(slot)));
}

template void prepare_joints(const StepContext<2>&, const WorldState<2>&, StepScratch<2>&);
template void prepare_joints(const StepContext<3>&, const WorldState<3>&, StepScratch<3>&);

}  // namespace cycloid::solver
