#include <algorithm>

#include "solver/stages/met_bodies.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// What damping c [1/s] leaves in a substep: 1 / (1 + h c), which is implicit, so stable for every
/// h. @pre the body has mass.
/// Without damping that is 1. @pre the factors are 1, or of the same body.
template <int D>
static void dampen(float h, const Body<D>& body, Acceleration<D>& of) {
  if (body.linear_damping == 0.0f && body.angular_damping == 0.0f) return;
  for (int i = 0; i < D; ++i) of.factor[i] = 1.0f / (1.0f + h * body.linear_damping);
  for (int i = 0; i < Dim<D>::kSpin; ++i)
    of.factor[D + i] = 1.0f / (1.0f + h * body.angular_damping);
}

/// (s g + f / m) and I^-1 torque, and what damping leaves. Bodies without mass keep their
/// velocities.
template <int D>
static Acceleration<D> acceleration_of(const StepContext<D>& context, const Body<D>& body,
                                       const BodyMass<D>& mass) {
  Acceleration<D> of;
  for (float& factor : of.factor) factor = 1.0f;
  for (float& rate : of.rate) rate = -0.0f;
  if (body.inverse_mass == 0.0f) return of;
  const Vec<D> linear = body.gravity_scale * context.gravity + body.inverse_mass * body.force;
  const Spin<D> angular = mass.inverse_inertia * body.torque;
  for (int i = 0; i < D; ++i) of.rate[i] = linear[i];
  for (int i = 0; i < Dim<D>::kSpin; ++i) of.rate[D + i] = angular[i];
  dampen(context.h, body, of);
  return of;
}

/// Which bodies constraints of this tick may write to: who is awake, what touches them or is
/// jointed to them, and the resting one of unused lanes. Where those are a good part of all, to
/// list them would cost more than to put all to rest.
template <int D>
static void list_met(const WorldState<D>& state, StepScratch<D>& scratch) {
  const std::size_t count = state.bodies.size();
  const std::size_t pairs = scratch.live.size() + scratch.live_joints.size();
  std::vector<std::uint32_t>& met = scratch.met;
  met.clear();
  scratch.met_many = 4 * (scratch.awake_bodies.size() + 2 * pairs) > count;
  if (scratch.met_many) return;
  met.assign(scratch.awake_bodies.begin(), scratch.awake_bodies.end());
  for_each_met_body(state, scratch, [&](std::uint32_t slot) { met.push_back(slot); });
  met.push_back(static_cast<std::uint32_t>(count));
}

/// All bodies at rest and without mass, as they are for those that are not awake. The step before,
/// maybe another world's, left all but those it met so: a world may be full of sleepers.
template <int D>
static void rest_all(const WorldState<D>& state, Workers& workers, StepScratch<D>& scratch) {
  Motion<D> resting{};
  resting.delta_rotation = identity_rotation<D>();
  const std::size_t before = scratch.motions.size();
  const std::size_t count = state.bodies.size() + 1;
  for (const std::uint32_t slot : scratch.met) {
    scratch.motions[slot] = resting;
    scratch.masses[slot] = {};
    scratch.inertia_turned[slot] = 0;
  }
  scratch.motions.resize(count, resting);
  scratch.masses.resize(count, BodyMass<D>{});
  scratch.inertia_turned.resize(count, 0);
  if (!scratch.met_many) return;
  workers.parallel_for(static_cast<int>(std::min(before, count)), kLookGrain, [&](Range range) {
    const auto fill = [&](auto& of_bodies, const auto& value) {
      std::fill(of_bodies.begin() + range.begin, of_bodies.begin() + range.end, value);
    };
    fill(scratch.motions, resting);
    fill(scratch.masses, BodyMass<D>{});
    fill(scratch.inertia_turned, std::uint8_t{0});
  });
}

/// I^-1 in the world frame = R I_body^-1 R^T, and the motion at the start of the tick. A body that
/// is not awake is at rest, and none that is awake can push it: to its neighbours it has no mass.
///
/// Reads the velocity, rotation, mass, forces and damping of who is awake; writes motions, masses,
/// and the accelerations of who is awake, each body its own, and whether any moves by more than a
/// metre in the tick, so any split into ranges gives the same bits.
template <int D>
void prepare_bodies(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                    StepScratch<D>& scratch) {
  rest_all(state, workers, scratch);
  list_met(state, scratch);
  scratch.accelerations.resize(scratch.moving_bodies.size());
  constexpr float kFar = 1.0f;  // m in a tick.
  const float far_speed = kFar / context.tick_s;
  Tally far;
  workers.parallel_for(
      static_cast<int>(scratch.moving_bodies.size()), kBodyGrain, [&](Range range) {
        bool any_far = false;
        for (int i = range.begin; i < range.end; ++i) {
          const auto place = static_cast<std::size_t>(i);
          const std::uint32_t slot = scratch.moving_bodies[place];
          const Body<D>& body = state.bodies[slot];
          any_far = any_far || dot(body.velocity, body.velocity) > far_speed * far_speed;
          scratch.motions[slot] = {body.velocity, body.spin, Vec<D>::zero(),
                                   identity_rotation<D>()};
          scratch.masses[slot] = {body.inverse_mass,
                                  world_inertia(body.inverse_inertia, body.rotation)};
          scratch.accelerations[place] = acceleration_of(context, body, scratch.masses[slot]);
        }
        if (any_far) far.add(1);
      });
  scratch.slides_far = far.sum() > 0;
}

template <int D>
void dampen_bodies(const StepContext<D>& context, const WorldState<D>& state,
                   StepScratch<D>& scratch) {
  const auto end = static_cast<std::size_t>(in_substeps(scratch).end);
  for (std::size_t place = 0; place < end; ++place) {
    const Body<D>& body = state.bodies[scratch.moving_bodies[place]];
    if (body.inverse_mass > 0.0f) dampen(context.h, body, scratch.accelerations[place]);
  }
}

template void dampen_bodies(const StepContext<2>&, const WorldState<2>&, StepScratch<2>&);
template void dampen_bodies(const StepContext<3>&, const WorldState<3>&, StepScratch<3>&);
template void prepare_bodies(const StepContext<2>&, const WorldState<2>&, Workers&,
                             StepScratch<2>&);
template void prepare_bodies(const StepContext<3>&, const WorldState<3>&, Workers&,
                             StepScratch<3>&);

}  // namespace cycloid::solver
