#pragma once

#include "solver/bodies/passing.hpp"
#include "solver/stages/may_touch.hpp"
#include "solver/step_context.hpp"
#include "solver/step_scratch.hpp"
#include "solver/trig.hpp"

namespace cycloid::solver {

/// Whether a body winds, as bodies/passing.hpp has it.
template <int D>
bool winds(const StepContext<D>& context, const Motion<D>& motion) {
  return winds(context.tick_s, motion.spin);
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

/// The place in fast_bodies, + 1, of the body of a shape that may be stopped at the other; 0 where
/// it is not fast, and where something pushes it on and the other yields.
template <int D>
std::uint32_t place_if_stopped_at(const WorldState<D>& state, const StepScratch<D>& scratch,
                                  std::uint32_t shape, std::uint32_t other) {
  const std::uint32_t place = scratch.fast_of_shape[shape];
  if (place == 0 || !scratch.fast_bodies[place - 1].is_pushed) return place;
  return responds(state.bodies[state.shapes[other].body].kind) ? 0 : place;
}

/// How far from what it meets a body stops, m: near enough that the next tick finds the contact,
/// far enough that this one did not touch, and little beside its thickness. A card that stops as
/// far from the next one as it is thick is held up by nothing, and its house falls.
inline float stop_distance(const Tuning& tuning, float thickness) {
  const float far = min(0.5f * tuning.slop, 0.5f * thickness);
  return min(max(far, 1.0e-4f), max(tuning.speculative_distance, 1.0e-4f));
}

}  // namespace cycloid::solver
