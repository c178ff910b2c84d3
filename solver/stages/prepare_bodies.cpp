#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// I^-1 in the world frame = R I_body^-1 R^T, and the motion at the start of the tick.
///
/// Reads each body's velocity, rotation and mass; writes its own entries of motions and masses, so
/// any split into ranges gives the same bits.
template <int D>
void prepare_bodies(const WorldState<D>& state, Workers& workers, StepScratch<D>& scratch) {
  const std::size_t count = state.bodies.size();
  scratch.motions.resize(count + 1);
  scratch.masses.resize(count + 1);
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
    }
  });
}

template void prepare_bodies(const WorldState<2>&, Workers&, StepScratch<2>&);
template void prepare_bodies(const WorldState<3>&, Workers&, StepScratch<3>&);

}  // namespace cycloid::solver
