#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// (s g + f / m) and I^-1 torque, and what damping c [1/s] leaves: 1 / (1 + h c), which is
/// implicit, so stable for every h. Bodies without mass and those asleep keep their velocities.
template <int D>
static Acceleration<D> acceleration_of(const StepContext<D>& context, const Body<D>& body,
                                       const BodyMass<D>& mass, bool awake) {
  Acceleration<D> of;
  for (float& factor : of.factor) factor = 1.0f;
  for (float& rate : of.rate) rate = -0.0f;
  if (body.inverse_mass == 0.0f || !awake) return of;
  const Vec<D> linear = body.gravity_scale * context.gravity + body.inverse_mass * body.force;
  const Spin<D> angular = mass.inverse_inertia * body.torque;
  for (int i = 0; i < D; ++i) {
    of.factor[i] = 1.0f / (1.0f + context.h * body.linear_damping);
    of.rate[i] = linear[i];
  }
  for (int i = 0; i < Dim<D>::kSpin; ++i) {
    of.factor[D + i] = 1.0f / (1.0f + context.h * body.angular_damping);
    of.rate[D + i] = angular[i];
  }
  return of;
}

/// I^-1 in the world frame = R I_body^-1 R^T, and the motion at the start of the tick.
///
/// Reads each body's velocity, rotation, mass, forces and damping; writes its own entries of
/// motions, masses and accelerations, so any split into ranges gives the same bits.
template <int D>
void prepare_bodies(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                    StepScratch<D>& scratch) {
  const std::size_t count = state.bodies.size();
  scratch.motions.resize(count + 1);
  scratch.masses.resize(count + 1);
  scratch.accelerations.resize(count);
  scratch.motions[count] = Motion<D>{};
  scratch.motions[count].delta_rotation = identity_rotation<D>();
  scratch.masses[count] = BodyMass<D>{};
  scratch.inertia_turned.assign(count + 1, 0);
  workers.parallel_for(static_cast<int>(count), kBodyGrain, [&](Range range) {
    for (auto i = static_cast<std::size_t>(range.begin); i < static_cast<std::size_t>(range.end);
         ++i) {
      const Body<D>& body = state.bodies[i];
      scratch.motions[i] = {body.velocity, body.spin, Vec<D>::zero(), identity_rotation<D>()};
      scratch.masses[i] = {body.inverse_mass, world_inertia(body.inverse_inertia, body.rotation)};
      scratch.accelerations[i] =
          acceleration_of(context, body, scratch.masses[i], scratch.awake[i] != 0);
    }
  });
}

template void prepare_bodies(const StepContext<2>&, const WorldState<2>&, Workers&,
                             StepScratch<2>&);
template void prepare_bodies(const StepContext<3>&, const WorldState<3>&, Workers&,
                             StepScratch<3>&);

}  // namespace cycloid::solver
