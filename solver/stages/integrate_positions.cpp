#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// x' = x + h v,  q' = exp(h w) q, at unit length.
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
      turn_by(context.h * motion.spin, motion);
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
