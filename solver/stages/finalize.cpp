#include <algorithm>

#include "solver/constraints/joints/unwrap.hpp"
#include "solver/stages/stages.hpp"
#include "solver/validate.hpp"

namespace cycloid::solver {

/// Reads the motions of who is awake, which alone can move; writes nothing. Serial and in slot
/// order, so every machine names the same body.
template <int D>
Fault find_fault(const WorldState<D>& state, const StepScratch<D>& scratch) {
  for (const std::uint32_t i : scratch.awake_bodies) {
    const Motion<D>& motion = scratch.motions[i];
    FaultField field = kFaultNone;
    if (!within(motion.spin, kSpinMax)) field = kFaultSpin;
    if (!within(motion.velocity, kSpeedMax)) field = kFaultVelocity;
    if (!within(motion.delta_rotation, 2.0f)) field = kFaultRotation;
    if (!within(state.bodies[i].position + motion.delta_position, kPositionMax))
      field = kFaultPosition;
    if (field != kFaultNone) return {state.header.tick + 1, {i, state.bodies[i].generation}, field};
  }
  return {};
}

/// A copy, because the scratch is not the world's own. Grows as a list that is appended to, so that
/// contacts which come and go do not allocate in each tick.
template <int D>
static void take_contacts(const std::vector<Contact<D>>& from, std::vector<Contact<D>>& to) {
  if (from.size() > to.capacity()) to.reserve(std::max(from.size(), 2 * to.capacity()));
  to.assign(from.begin(), from.end());
}

/// x' = x + dx, q' = dq q at unit length; the contacts and impulses of this tick become the
/// state's; forces are spent.
///
/// Reads motions, contacts and joint rows; writes bodies, contacts, joints and the tick. Everything
/// before this stage left the state as it was, so a fault costs nothing to undo.
template <int D>
void finalize(StepScratch<D>& scratch, WorldState<D>& state) {
  for (const std::uint32_t i : scratch.awake_bodies) {
    Body<D>& body = state.bodies[i];
    body.force = Vec<D>::zero();
    body.torque = Spin<D>::zero();
    const Motion<D>& motion = scratch.motions[i];
    body.velocity = motion.velocity;
    body.spin = motion.spin;
    body.position += motion.delta_position;
    body.rotation = normalized_or(compose(motion.delta_rotation, body.rotation), body.rotation);
  }
  for (const JointRow<D>& row : scratch.joint_rows) {
    Joint<D>& joint = state.joints[row.joint];
    for (int i = 0; i < Dim<D>::kFreedoms; ++i)
      joint.impulse[static_cast<std::size_t>(i)] = row.impulse[i];
    joint.spring_impulse = row.spring_impulse;
    joint.motor_impulse = row.motor_impulse;
    joint.lower_impulse = row.lower_impulse;
    joint.upper_impulse = row.upper_impulse;
    store_cone_impulse(row, joint);
    if (joint.kind != JointKind::kGear) continue;
    joint.unwrapped = {unwrapped_angle(state.bodies[joint.body_a].rotation, joint.unwrapped[0]),
                       unwrapped_angle(state.bodies[joint.body_b].rotation, joint.unwrapped[1])};
  }
  take_contacts(scratch.contacts, state.contacts);
  ++state.header.tick;
}

template Fault find_fault(const WorldState<2>&, const StepScratch<2>&);
template Fault find_fault(const WorldState<3>&, const StepScratch<3>&);
template void finalize(StepScratch<2>&, WorldState<2>&);
template void finalize(StepScratch<3>&, WorldState<3>&);

}  // namespace cycloid::solver
