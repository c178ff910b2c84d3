#include <span>

#include "solver/bodies/body_kernels.hpp"
#include "solver/bodies/turn_freely.hpp"
#include "solver/lane_widths.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// The inverse inertia in the world at the present rotation, where that has changed by more than a
/// thousandth of a radian in this substep. Kept for a whole tick it would turn a top's joint force
/// into spin about its own axis: at 60 rad/s a tick is one radian.
static bool turn_inertia(float h, const Body<3>& body, const Motion<3>& motion, BodyMass<3>& mass) {
  constexpr float kTurnMin = 1.0e-3f;
  if (keeps_its_spin(body)) return false;
  if (h * h * dot(motion.spin, motion.spin) <= kTurnMin * kTurnMin) return false;
  mass.inverse_inertia =
      world_inertia(body.inverse_inertia, compose(motion.delta_rotation, body.rotation));
  return true;
}

/// What follows of the new rotations of the bodies at these places of moving_bodies.
static void turn_masses(float h, const WorldState<3>& state, Range range, StepScratch<3>& scratch) {
  for (auto place = static_cast<std::size_t>(range.begin);
       place < static_cast<std::size_t>(range.end); ++place) {
    const std::uint32_t slot = scratch.moving_bodies[place];
    const Body<3>& body = state.bodies[slot];
    const bool turned = turn_inertia(h, body, scratch.motions[slot], scratch.masses[slot]);
    scratch.inertia_turned[slot] = turned ? 1 : 0;
    if (!turned) continue;
    const Spin<3> rate = scratch.masses[slot].inverse_inertia * body.torque;
    for (int axis = 0; axis < 3; ++axis) scratch.accelerations[place].rate[3 + axis] = rate[axis];
  }
}

template <int D>
static void move_by_pseudo_velocities(float h, Range range, StepScratch<D>& scratch) {
  for (int place = range.begin; place < range.end; ++place) {
    const std::uint32_t slot = scratch.moving_bodies[static_cast<std::size_t>(place)];
    Motion<D>& motion = scratch.motions[slot];
    motion.delta_position += h * scratch.saved_motions[slot].velocity;
    turn_by(h * scratch.saved_motions[slot].spin, motion);
  }
}

static std::span<const std::uint32_t> slots_of(Range range, const StepScratch<3>& scratch) {
  return std::span(scratch.moving_bodies)
      .subspan(static_cast<std::size_t>(range.begin),
               static_cast<std::size_t>(range.end - range.begin));
}

static void move_range(const StepContext<2>& context, const WorldState<2>&, Range range,
                       StepScratch<2>& scratch) {
  const std::uint32_t* slots = scratch.moving_bodies.data();
  Motion<2>* motions = scratch.motions.data();
  at_width(widest_lanes(context.lanes), [&]<int W>() {
    in_lanes<W>(range.begin, range.end, [&]<int V>(int begin, int end) {
      BodyKernels<V>::move(context.h, slots + begin, end - begin, motions);
    });
  });
}

static void move_one(float h, const Body<3>& body, Motion<3>& motion) {
  motion.delta_position += h * motion.velocity;
  turn_freely(h, body, motion);
}

/// Moves bodies of space W at a time; four or one where one of them turns too far for a lane, or
/// too few are left.
template <int W>
static void move_in_lanes(float h, const Body<3>* bodies, std::span<const std::uint32_t> slots,
                          Motion<3>* motions) {
  constexpr std::size_t kLanes = kLaneCount<W>;
  for (; slots.size() >= kLanes; slots = slots.subspan(kLanes)) {
    if (BodyKernels<W>::move_in_space(h, bodies, slots.data(), motions)) continue;
    if constexpr (kLanes > 4)
      move_in_lanes<4>(h, bodies, slots.first(kLanes), motions);
    else
      for (const std::uint32_t slot : slots.first(kLanes)) move_one(h, bodies[slot], motions[slot]);
  }
  if constexpr (kLanes > 4) return move_in_lanes<4>(h, bodies, slots, motions);
  for (const std::uint32_t slot : slots) move_one(h, bodies[slot], motions[slot]);
}

static void move_range(const StepContext<3>& context, const WorldState<3>& state, Range range,
                       StepScratch<3>& scratch) {
  const auto slots = slots_of(range, scratch);
  const Body<3>* bodies = state.bodies.data();
  Motion<3>* motions = scratch.motions.data();
  at_width(widest_lanes(context.lanes),
           [&]<int W>() { move_in_lanes<W>(context.h, bodies, slots, motions); });
  turn_masses(context.h, state, range, scratch);
}

/// x' = x + h v,  q' = exp(h w) q, at unit length; in space I(q') w' = I(q) w.
///
/// Reads velocity and spin of each motion that is awake, and its pseudo-velocity where there are
/// any; writes its deltas, and its inverse inertia in the world. Any split into ranges gives the
/// same bits.
template <int D>
void integrate_positions(const StepContext<D>& context, const WorldState<D>& state, const Lot& lot,
                         Workers& workers, StepScratch<D>& scratch) {
  const bool pseudo = context.tuning.stabilisation == Stabilisation::kSplitImpulse;
  for_each_body_range(lot, workers, [&](Range range) {
    move_range(context, state, range, scratch);
    if (pseudo) move_by_pseudo_velocities(context.h, range, scratch);
  });
}

template void integrate_positions(const StepContext<2>&, const WorldState<2>&, const Lot&, Workers&,
                                  StepScratch<2>&);
template void integrate_positions(const StepContext<3>&, const WorldState<3>&, const Lot&, Workers&,
                                  StepScratch<3>&);

}  // namespace cycloid::solver
