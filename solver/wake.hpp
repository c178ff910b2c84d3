#pragma once

#include "solver/state.hpp"

namespace cycloid::solver {

/// A change that a sleeping body could answer to wakes it; its island follows with the next step.

template <int D>
void wake(Body<D>& body) {
  body.asleep = 0;
  body.rest_ticks = 0;
}

template <int D>
void wake_all(WorldState<D>& state) {
  for (Body<D>& body : state.bodies) wake(body);
}

template <int D>
void wake_both(WorldState<D>& state, const Joint<D>& joint) {
  wake(state.bodies[joint.body_a]);
  wake(state.bodies[joint.body_b]);
}

}  // namespace cycloid::solver
