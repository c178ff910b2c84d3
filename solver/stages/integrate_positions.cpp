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

/// Each gains a factor h |w| on the spin in the middle of a substep.
static constexpr int kMidpointIterations = 3;

/// In space it keeps its angular momentum L = I w, so the spin changes as the inertia turns with
/// the body: w = I(q)^-1 L, and the step is taken with the w of its own middle (the implicit
/// midpoint rule, which is symmetric in time). L is kept to rounding and energy without drift; the
/// explicit term h w x I w gains energy, Catto's implicit one (GDC 2015) loses it.
static void turn_freely(float h, const Body<3>& body, Motion<3>& motion) {
  const bool turns = body.inverse_inertia.m[0] > 0.0f;
  if (!turns || is_round(body.inertia)) return turn_by(h * motion.spin, motion);
  const auto momentum_of = [&](const Motion<3>& at, const Spin<3>& spin) {
    const Rotation<3> q = compose(at.delta_rotation, body.rotation);
    return rotate(q, body.inertia * rotate_back(q, spin));
  };
  // By what is missing: I^-1 (I w) is w only to rounding, and would grow or shrink it in every
  // step.
  const auto spin_of = [&](const Motion<3>& at, const Spin<3>& guess, const Spin<3>& momentum) {
    const Rotation<3> q = compose(at.delta_rotation, body.rotation);
    const Spin<3> missing = momentum - momentum_of(at, guess);
    return guess + rotate(q, body.inverse_inertia * rotate_back(q, missing));
  };
  const Spin<3> momentum = momentum_of(motion, motion.spin);
  Spin<3> spin = motion.spin;
  for (int i = 0; i < kMidpointIterations; ++i) {
    Motion<3> middle = motion;
    turn_by((0.5f * h) * spin, middle);
    spin = spin_of(middle, spin, momentum);
  }
  turn_by(h * spin, motion);
  motion.spin = spin_of(motion, spin, momentum);
}

/// x' = x + h v,  q' = exp(h w) q, at unit length; in space w' = I(q')^-1 L.
///
/// Reads each motion's velocity and spin, and its pseudo-velocity where there are any; writes its
/// deltas. Any split into ranges gives the same bits.
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
