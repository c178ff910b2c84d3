#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// In the plane a free body keeps its spin.
static void turn_freely(float h, const Body<2>&, Motion<2>& motion) {
  turn_by(h * motion.spin, motion);
}

static bool is_round(const Inertia<3>& inertia) {
  const float* m = inertia.m;
  const float off = abs(m[1]) + abs(m[2]) + abs(m[5]);
  return abs(m[0] - m[4]) + abs(m[4] - m[8]) + off <= 1.0e-6f * m[0];
}

/// Most of them; each gains a factor of about h |w| on the spin in the middle of a substep.
static constexpr int kMidpointIterations = 8;

/// In space it keeps its angular momentum L = I w, so the spin changes as the inertia turns with
/// the body. In the body's frame L' = exp(-h m) L, where m, the spin of the step's middle, answers
/// to exp(-h m / 2) L: the implicit midpoint rule, symmetric in time, so that L is kept to rounding
/// and the energy without drift. The explicit term h w x I w gains energy, Catto's implicit one
/// (GDC 2015) loses it.
///
/// Only changes of the spin pass through I^-1 and the frame of the body: whole spins would take
/// their rounding along in every substep.
static void turn_freely(float h, const Body<3>& body, Motion<3>& motion) {
  const bool turns = body.inverse_inertia.m[0] > 0.0f;
  if (!turns || is_round(body.inertia)) return turn_by(h * motion.spin, motion);
  const Rotation<3> before = compose(motion.delta_rotation, body.rotation);
  const Spin<3> spin = rotate_back(before, motion.spin);
  const Spin<3> momentum = body.inertia * spin;
  const auto change_after = [&](const Spin<3>& turn) {
    return body.inverse_inertia * (rotate_back(rotation_by(turn), momentum) - momentum);
  };
  Spin<3> middle = Spin<3>::zero();  // Its difference from `spin`.
  for (int i = 0; i < kMidpointIterations; ++i) {
    const Spin<3> last = middle;
    middle = change_after((0.5f * h) * (spin + last));
    const Spin<3> moved = middle - last;
    if (dot(moved, moved) <= 1.0e-14f * dot(spin, spin)) break;
  }
  const Spin<3> turn = h * (spin + middle);
  const Spin<3> turn_in_world = rotate(before, turn);
  turn_by(turn_in_world, motion);
  const Rotation<3> after = compose(motion.delta_rotation, body.rotation);
  motion.spin = rotate(rotation_by(turn_in_world), motion.spin) + rotate(after, change_after(turn));
}

static bool turn_inertia(float, const Body<2>&, const Motion<2>&, BodyMass<2>&) {
  return false;
}
/// The inverse inertia in the world at the present rotation, where that has changed by more than a
/// thousandth of a radian in this substep. Kept for a whole tick it would turn a top's joint force
/// into spin about its own axis: at 60 rad/s a tick is one radian.
static bool turn_inertia(float h, const Body<3>& body, const Motion<3>& motion, BodyMass<3>& mass) {
  constexpr float kTurnMin = 1.0e-3f;
  if (body.inverse_inertia.m[0] == 0.0f || is_round(body.inertia)) return false;
  if (h * h * dot(motion.spin, motion.spin) <= kTurnMin * kTurnMin) return false;
  mass.inverse_inertia =
      world_inertia(body.inverse_inertia, compose(motion.delta_rotation, body.rotation));
  return true;
}

/// x' = x + h v,  q' = exp(h w) q, at unit length; in space I(q') w' = I(q) w.
///
/// Reads each motion's velocity and spin, and its pseudo-velocity where there are any; writes its
/// deltas, and its inverse inertia in the world. Any split into ranges gives the same bits.
template <int D>
void integrate_positions(const StepContext<D>& context, const WorldState<D>& state,
                         Workers& workers, StepScratch<D>& scratch) {
  const bool pseudo = context.tuning.stabilisation == Stabilisation::kSplitImpulse;
  workers.parallel_for(static_cast<int>(state.bodies.size()), kBodyGrain, [&](Range range) {
    for (auto i = static_cast<std::size_t>(range.begin); i < static_cast<std::size_t>(range.end);
         ++i) {
      if (scratch.awake[i] == 0) continue;
      Motion<D>& motion = scratch.motions[i];
      motion.delta_position += context.h * motion.velocity;
      turn_freely(context.h, state.bodies[i], motion);
      const bool turned = turn_inertia(context.h, state.bodies[i], motion, scratch.masses[i]);
      scratch.inertia_turned[i] = turned ? 1 : 0;
      if (!pseudo) continue;
      motion.delta_position += context.h * scratch.saved_motions[i].velocity;
      turn_by(context.h * scratch.saved_motions[i].spin, motion);
    }
  });
}

template void integrate_positions(const StepContext<2>&, const WorldState<2>&, Workers&,
                                  StepScratch<2>&);
template void integrate_positions(const StepContext<3>&, const WorldState<3>&, Workers&,
                                  StepScratch<3>&);

}  // namespace cycloid::solver
