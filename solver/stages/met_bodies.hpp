#pragma once

#include "solver/step_scratch.hpp"

namespace cycloid::solver {

/// Calls act(slot) for both bodies of every live contact and joint, with mass or without, some of
/// them several times: nothing else of a tick is read or written by a constraint.
template <int D, class Act>
void for_each_met_body(const WorldState<D>& state, const StepScratch<D>& scratch, Act&& act) {
  for (const LiveContact<D>& live : scratch.live) {
    act(live.body_a);
    act(live.body_b);
  }
  for (const LiveJoint& live : scratch.live_joints) {
    const Joint<D>& joint = state.joints[static_cast<std::size_t>(live.slot)];
    act(joint.body_a);
    act(joint.body_b);
  }
}

}  // namespace cycloid::solver
