#pragma once

#include "solver/active_bodies.hpp"
#include "solver/state.hpp"

namespace cycloid::solver {

/// A change that a sleeping body could answer to wakes it; its island follows with the next step.

template <int D>
void wake(WorldState<D>& state, std::uint32_t slot, ActiveBodies& active) {
  state.bodies.moved(slot).asleep = 0;
  state.bodies.moved(slot).rest_ticks = 0;
  active.touch(slot);
}

template <int D>
void wake_all(WorldState<D>& state, ActiveBodies& active) {
  active.forget_all();
  for (std::uint32_t slot = 0; slot < state.bodies.size(); ++slot) wake(state, slot, active);
}

template <int D>
void wake_both(WorldState<D>& state, const Joint<D>& joint, ActiveBodies& active) {
  wake(state, joint.body_a, active);
  wake(state, joint.body_b, active);
}

}  // namespace cycloid::solver
