#include <cstddef>
#include <limits>

#include "solver/constraints/joints/unwrap.hpp"
#include "solver/stages/active_contacts.hpp"
#include "solver/stages/stages.hpp"
#include "solver/transpose.hpp"
#include "solver/validate.hpp"

namespace cycloid::solver {

/// Of the change of a rotation in a tick, which is of unit length.
static constexpr float kRotationMax = 2.0f;

/// What of a body would leave the bounds, or kFaultNone.
template <int D>
static FaultField fault_of(const Body<D>& body, const Motion<D>& motion) {
  if (!within(body.position + motion.delta_position, kPositionMax)) return kFaultPosition;
  if (!within(motion.delta_rotation, kRotationMax)) return kFaultRotation;
  if (!within(motion.velocity, kSpeedMax)) return kFaultVelocity;
  if (!within(motion.spin, kSpinMax)) return kFaultSpin;
  return kFaultNone;
}

/// What the floats of a motion may be at the most, and those of where it leads.
template <int D>
class MotionBounds {
 public:
  MotionBounds() {
    for (int i = 0; i < 4; ++i) position_[i] = i < D ? kPositionMax : kAny;
    constexpr int kPositionAt = D + Dim<D>::kSpin;
    for (int i = 0; i < 4 * kPoseQuads<D>; ++i) motion_[i] = kAny;
    for (int i = 0; i < kPositionAt; ++i) motion_[i] = i < D ? kSpeedMax : kSpinMax;
    for (int i = kPositionAt + D; i < kMotionComponents<D>; ++i) motion_[i] = kRotationMax;
  }

  /// Four floats at a time, for nearly all bodies are asked for nothing more. False wherever
  /// fault_of finds one.
  bool hold(const Body<D>& body, const Motion<D>& motion) const {
    constexpr int kAt = (kMotionAt<D> + offsetof(BodyMotion<D>, position)) / sizeof(float);
    constexpr int kDeltaAt = D + Dim<D>::kSpin;
    auto held = lies(load_floats(body, kAt) + load_floats(motion, kDeltaAt), position_);
    for (int quad = 0; quad < kPoseQuads<D>; ++quad)
      held = held & lies(load_quad(motion, quad), motion_ + 4 * quad);
    return bits_of<4>(held) == kAllLanes<4>;
  }

 private:
  using L = Lanes<4>;
  static constexpr float kAny = std::numeric_limits<float>::infinity();

  static L::Mask lies(const Quad& value, const float* most) {
    const L bound = L::load(most);
    return (value <= bound.raw) & (value >= (-bound).raw);
  }

  alignas(16) float position_[4];
  alignas(16) float motion_[4 * kPoseQuads<D>];
};

/// Reads the motions of who is awake, which alone can move; writes nothing. Whether there is a
/// fault is asked in ranges; if so, which one, in slot order, so that every machine names the same
/// body.
template <int D>
Fault find_fault(const WorldState<D>& state, Workers& workers, const StepScratch<D>& scratch) {
  const std::vector<std::uint32_t>& awake = scratch.awake_bodies;
  const MotionBounds<D> bounds;
  Tally doubts;
  workers.parallel_for(static_cast<int>(awake.size()), kBodyGrain, [&](Range range) {
    bool all = true;
    for (int i = range.begin; i < range.end; ++i) {
      const std::uint32_t slot = awake[static_cast<std::size_t>(i)];
      all = all && bounds.hold(state.bodies[slot], scratch.motions[slot]);
    }
    if (!all) doubts.add(1);
  });
  if (doubts.sum() == 0) return {};
  for (const std::uint32_t i : awake) {
    const FaultField field = fault_of(state.bodies[i], scratch.motions[i]);
    if (field != kFaultNone) return {state.header.tick + 1, {i, state.bodies[i].generation}, field};
  }
  return {};
}

template <int D>
static void take_motion(const Motion<D>& motion, BodyMotion<D>& body) {
  body.force = Vec<D>::zero();
  body.torque = Spin<D>::zero();
  body.velocity = motion.velocity;
  body.spin = motion.spin;
  body.position += motion.delta_position;
  body.rotation = normalized_or(compose(motion.delta_rotation, body.rotation), body.rotation);
}

template <int D>
static void keep_impulses(const JointRow<D>& row, WorldState<D>& state) {
  JointImpulses<D>& joint = state.joints.moved(row.joint);
  for (int i = 0; i < Dim<D>::kFreedoms; ++i)
    joint.impulse[static_cast<std::size_t>(i)] = row.impulse[i];
  joint.spring_impulse = row.spring_impulse;
  joint.motor_impulse = row.motor_impulse;
  joint.lower_impulse = row.lower_impulse;
  joint.upper_impulse = row.upper_impulse;
  store_cone_impulse(row, joint);
  const JointProperties<D>& kept = state.joints[row.joint];
  if (kept.kind != JointKind::kGear) return;
  joint.unwrapped = {unwrapped_angle(state.bodies[kept.body_a].rotation, joint.unwrapped[0]),
                     unwrapped_angle(state.bodies[kept.body_b].rotation, joint.unwrapped[1])};
}

/// x' = x + dx, q' = dq q at unit length; the contacts and impulses of this tick become the
/// state's; forces are spent.
///
/// Reads motions, contacts and joint rows; writes bodies, contacts, joints and the tick. Everything
/// before this stage left the state as it was, so a fault costs nothing to undo. Each body, joint
/// and contact by itself.
template <int D>
void finalize(Workers& workers, StepScratch<D>& scratch, WorldState<D>& state) {
  const std::vector<std::uint32_t>& awake = scratch.awake_bodies;
  workers.parallel_for(static_cast<int>(awake.size()), kBodyGrain, [&](Range range) {
    for (int i = range.begin; i < range.end; ++i) {
      const std::uint32_t slot = awake[static_cast<std::size_t>(i)];
      take_motion(scratch.motions[slot], state.bodies.moved(slot));
    }
  });
  workers.parallel_for(static_cast<int>(scratch.joint_rows.size()), kJointGrain, [&](Range range) {
    for (int i = range.begin; i < range.end; ++i)
      keep_impulses(scratch.joint_rows[static_cast<std::size_t>(i)], state);
  });
  take_contacts(workers, scratch, state);
  ++state.header.tick;
}

template Fault find_fault(const WorldState<2>&, Workers&, const StepScratch<2>&);
template Fault find_fault(const WorldState<3>&, Workers&, const StepScratch<3>&);
template void finalize(Workers&, StepScratch<2>&, WorldState<2>&);
template void finalize(Workers&, StepScratch<3>&, WorldState<3>&);

}  // namespace cycloid::solver
