#pragma once

#include "solver/step_context.hpp"
#include "solver/step_scratch.hpp"
#include "solver/trig.hpp"

namespace cycloid::solver {

/// Whether a body's final rotation does not say any more how far it turned in the tick.
template <int D>
bool winds(const StepContext<D>& context, const Motion<D>& motion) {
  const Spin<D> spun = context.tick_s * motion.spin;
  return dot(spun, spun) > kPi * kPi;
}

/// How far a body turns in the tick, and about what.
template <int D>
Spin<D> turn_in(const StepContext<D>& context, const Motion<D>& motion) {
  return winds(context, motion) ? context.tick_s * motion.spin : turn_of(motion.delta_rotation);
}

/// A body's way in this tick.
template <int D>
BodySweep<D> sweep_of(const StepContext<D>& context, const WorldState<D>& state,
                      const StepScratch<D>& scratch, std::uint32_t body) {
  const Motion<D>& motion = scratch.motions[body];
  return {{state.bodies[body].position, state.bodies[body].rotation},
          motion.delta_position,
          turn_in(context, motion)};
}

/// The most that a rotation may turn, rad, or more: without a function of trigonometry.
inline float turn_bound(const Rotation<2>& q) {
  return q[0] >= 0.0f ? 1.6f * abs(q[1]) + 1.0e-5f : 2.0f * kPi;
}
inline float turn_bound(const Rotation<3>& q) {
  return q[3] >= 0.0f ? 3.2f * length(Vec<3>{{q[0], q[1], q[2]}}) + 1.0e-5f : 2.0f * kPi;
}

/// How far from what it meets a body stops, m: near enough that the next tick finds the contact,
/// far enough that this one did not touch, and little beside its thickness. A card that stops as
/// far from the next one as it is thick is held up by nothing, and its house falls.
inline float stop_distance(const Tuning& tuning, float thickness) {
  const float far = min(0.5f * tuning.slop, 0.5f * thickness);
  return min(max(far, 1.0e-4f), max(tuning.speculative_distance, 1.0e-4f));
}

}  // namespace cycloid::solver
