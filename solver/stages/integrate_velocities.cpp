#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// v' = (v + h (s g + f / m)) / (1 + h c),  w' = (w + h I^-1 torque) / (1 + h c_w): implicit in the
/// damping c [1/s], so stable for every h.
///
/// Reads force, torque, damping and gravity scale of each body and its mass; writes its motion's
/// velocity and spin. Bodies without mass keep theirs. Any split into ranges gives the same bits.
template <int D>
void integrate_velocities(const StepContext<D>& context, const WorldState<D>& state,
                          Workers& workers, StepScratch<D>& scratch) {
  workers.parallel_for(static_cast<int>(state.bodies.size()), kBodyGrain, [&](Range range) {
    for (auto i = static_cast<std::size_t>(range.begin); i < static_cast<std::size_t>(range.end);
         ++i) {
      const Body<D>& body = state.bodies[i];
      if (body.inverse_mass == 0.0f || scratch.awake[i] == 0) continue;
      Motion<D>& motion = scratch.motions[i];
      const Vec<D> acceleration =
          body.gravity_scale * context.gravity + body.inverse_mass * body.force;
      const Spin<D> turn = scratch.masses[i].inverse_inertia * body.torque;
      const float linear = 1.0f / (1.0f + context.h * body.linear_damping);
      const float angular = 1.0f / (1.0f + context.h * body.angular_damping);
      motion.velocity = linear * (motion.velocity + context.h * acceleration);
      motion.spin = angular * (motion.spin + context.h * turn);
    }
  });
}

template void integrate_velocities(const StepContext<2>&, const WorldState<2>&, Workers&,
                                   StepScratch<2>&);
template void integrate_velocities(const StepContext<3>&, const WorldState<3>&, Workers&,
                                   StepScratch<3>&);

}  // namespace cycloid::solver
