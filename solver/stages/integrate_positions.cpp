#include "solver/stages/stages.hpp"
#include "solver/trig.hpp"

namespace cycloid::solver {

/// The rotation by the vector `turn` [rad], exact and not its linearisation: a body that spins
/// freely keeps its rate.
static Rotation<2> rotation_by(const Spin<2>& turn) {
  Rotation<2> q;
  sin_cos(turn[0], q[1], q[0]);
  return q;
}
static Rotation<3> rotation_by(const Spin<3>& turn) {
  const float angle = length(turn);
  float sine = 0.0f;
  float cosine = 0.0f;
  sin_cos(0.5f * angle, sine, cosine);
  // sin(a/2)/a -> 1/2 where the division has no digits left.
  const float scale = angle > 1.0e-6f ? sine / angle : 0.5f;
  return {{scale * turn[0], scale * turn[1], scale * turn[2], cosine}};
}

/// x' = x + h v,  q' = exp(h w) q, at unit length.
///
/// Reads each motion's velocity and spin; writes its deltas. Any split into ranges gives the same
/// bits.
template <int D>
void integrate_positions(const StepContext<D>& context, const WorldState<D>& state,
                         Workers& workers, StepScratch<D>& scratch) {
  workers.parallel_for(static_cast<int>(state.bodies.size()), kBodyGrain, [&](Range range) {
    for (auto i = static_cast<std::size_t>(range.begin); i < static_cast<std::size_t>(range.end);
         ++i) {
      if (state.bodies[i].kind <= BodyKind::kStatic) continue;
      Motion<D>& motion = scratch.motions[i];
      motion.delta_position += context.h * motion.velocity;
      if (dot(motion.spin, motion.spin) == 0.0f) continue;
      motion.delta_rotation =
          normalized_or(compose(rotation_by(context.h * motion.spin), motion.delta_rotation),
                        motion.delta_rotation);
    }
  });
}

template void integrate_positions(const StepContext<2>&, const WorldState<2>&, Workers&,
                                  StepScratch<2>&);
template void integrate_positions(const StepContext<3>&, const WorldState<3>&, Workers&,
                                  StepScratch<3>&);

}  // namespace cycloid::solver
