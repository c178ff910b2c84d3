#include <span>

#include "solver/bodies/body_kernels.hpp"
#include "solver/lane_widths.hpp"
#include "solver/stages/stages.hpp"
#include "solver/stages/turn_freely.hpp"

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

/// What follows of the new rotations of the bodies at places [begin, end) of awake_bodies.
static void turn_masses(float h, const WorldState<3>& state, std::size_t begin, std::size_t end,
                        StepScratch<3>& scratch) {
  for (std::size_t place = begin; place < end; ++place) {
    const std::uint32_t slot = scratch.awake_bodies[place];
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
    const std::uint32_t slot = scratch.awake_bodies[static_cast<std::size_t>(place)];
    Motion<D>& motion = scratch.motions[slot];
    motion.delta_position += h * scratch.saved_motions[slot].velocity;
    turn_by(h * scratch.saved_motions[slot].spin, motion);
  }
}

/// Moves the bodies of these slots W at a time. What would leave half of the lanes empty goes in
/// fours.
template <int W>
static void move_in_lanes(float h, std::span<const std::uint32_t> slots, Motion<2>* motions) {
  constexpr std::size_t kLanes = kLaneCount<W>;
  const std::size_t last = slots.size() % kLanes;
  const std::size_t wide = 2 * last > kLanes ? slots.size() : slots.size() - last;
  const auto count = [](std::span<const std::uint32_t> of) { return static_cast<int>(of.size()); };
  const auto rest = slots.subspan(wide);
  BodyKernels<W>::move(h, slots.data(), static_cast<int>(wide), motions);
  if (!rest.empty()) BodyKernels < kLanes<4 ? W : 4>::move(h, rest.data(), count(rest), motions);
}

static void move_range(const StepContext<2>& context, const WorldState<2>&, Range range,
                       StepScratch<2>& scratch) {
  const auto slots = std::span<const std::uint32_t>(scratch.awake_bodies)
                         .subspan(static_cast<std::size_t>(range.begin),
                                  static_cast<std::size_t>(range.end - range.begin));
  Motion<2>* motions = scratch.motions.data();
  switch (widest_lanes(context.lanes)) {
    case 1:
      return move_in_lanes<1>(context.h, slots, motions);
    case 8:
      return move_in_lanes<8>(context.h, slots, motions);
    case 16:
      return move_in_lanes<16>(context.h, slots, motions);
    case kAvx2Lanes:
      return move_in_lanes<kAvx2Lanes>(context.h, slots, motions);
    case kAvx512Lanes:
      return move_in_lanes<kAvx512Lanes>(context.h, slots, motions);
    default:
      return move_in_lanes<4>(context.h, slots, motions);
  }
}

/// Moves the four bodies from a place of awake_bodies on, or the one that lies there. @returns the
/// place behind them.
static std::size_t move_some(float h, const WorldState<3>& state, std::size_t place,
                             std::size_t end, StepScratch<3>& scratch) {
  const std::uint32_t* slots = scratch.awake_bodies.data() + place;
  Motion<3>* motions = scratch.motions.data();
  if (place + 4 <= end &&
      move_four(h, state.bodies.data(), {slots[0], slots[1], slots[2], slots[3]}, motions))
    return place + 4;
  Motion<3>& motion = motions[slots[0]];
  motion.delta_position += h * motion.velocity;
  turn_freely(h, state.bodies[slots[0]], motion);
  return place + 1;
}

static void move_range(const StepContext<3>& context, const WorldState<3>& state, Range range,
                       StepScratch<3>& scratch) {
  const auto end = static_cast<std::size_t>(range.end);
  for (auto i = static_cast<std::size_t>(range.begin); i < end;) {
    const std::size_t next = move_some(context.h, state, i, end, scratch);
    turn_masses(context.h, state, i, next, scratch);
    i = next;
  }
}

/// x' = x + h v,  q' = exp(h w) q, at unit length; in space I(q') w' = I(q) w.
///
/// Reads velocity and spin of each motion that is awake, and its pseudo-velocity where there are
/// any; writes its deltas, and its inverse inertia in the world. Any split into ranges gives the
/// same bits.
template <int D>
void integrate_positions(const StepContext<D>& context, const WorldState<D>& state,
                         Workers& workers, StepScratch<D>& scratch) {
  const bool pseudo = context.tuning.stabilisation == Stabilisation::kSplitImpulse;
  const auto count = static_cast<int>(scratch.awake_bodies.size());
  workers.parallel_for(count, kBodyGrain, [&](Range range) {
    move_range(context, state, range, scratch);
    if (pseudo) move_by_pseudo_velocities(context.h, range, scratch);
  });
}

template void integrate_positions(const StepContext<2>&, const WorldState<2>&, Workers&,
                                  StepScratch<2>&);
template void integrate_positions(const StepContext<3>&, const WorldState<3>&, Workers&,
                                  StepScratch<3>&);

}  // namespace cycloid::solver
