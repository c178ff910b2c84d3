#include "solver/stages/stages.hpp"
#include "solver/transpose.hpp"

namespace cycloid::solver {

/// v' = (v + h (s g + f / m)) / (1 + h c),  w' = (w + h I^-1 torque) / (1 + h c_w): implicit in the
/// damping c [1/s], so stable for every h.
///
/// Reads the acceleration of each body that is awake; writes its motion's velocity and spin. Bodies
/// without mass keep theirs. Any split into ranges gives the same bits.
template <int D>
void integrate_velocities(const StepContext<D>& context, const Lot& lot, Workers& workers,
                          StepScratch<D>& scratch) {
  using L = Lanes<4>;
  const L h(context.h);
  for_each_body_range(lot, workers, [&](Range range) {
    for (int i = range.begin; i < range.end; ++i) {
      const Acceleration<D>& acceleration = scratch.accelerations[static_cast<std::size_t>(i)];
      Motion<D>& motion = scratch.motions[scratch.moving_bodies[static_cast<std::size_t>(i)]];
      for (int quad = 0; quad < kVelocityQuads<D>; ++quad) {
        const L factor = L::load(acceleration.factor + 4 * quad);
        const L rate = L::load(acceleration.rate + 4 * quad);
        L moved(load_quad(motion, quad));
        moved = factor * (moved + h * rate);
        store_quad(moved.raw, quad, motion);
      }
    }
  });
}

template void integrate_velocities(const StepContext<2>&, const Lot&, Workers&, StepScratch<2>&);
template void integrate_velocities(const StepContext<3>&, const Lot&, Workers&, StepScratch<3>&);

}  // namespace cycloid::solver
