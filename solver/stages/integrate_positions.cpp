#include "solver/constraints/motion_lanes.hpp"
#include "solver/constraints/trig_lanes.hpp"
#include "solver/stages/stages.hpp"
#include "solver/stages/turn_freely.hpp"

namespace cycloid::solver {

/// In the plane a free body keeps its spin.
static void turn_freely(float h, const Body<2>&, Motion<2>& motion) {
  turn_by(h * motion.spin, motion);
}

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
/// In the plane nothing does.
static void turn_masses(float, const WorldState<2>&, std::size_t, std::size_t, StepScratch<2>&) {}

template <int D>
static void move_by_pseudo_velocities(float h, std::size_t begin, std::size_t end,
                                      StepScratch<D>& scratch) {
  for (std::size_t place = begin; place < end; ++place) {
    const std::uint32_t slot = scratch.awake_bodies[place];
    Motion<D>& motion = scratch.motions[slot];
    motion.delta_position += h * scratch.saved_motions[slot].velocity;
    turn_by(h * scratch.saved_motions[slot].spin, motion);
  }
}

/// x' = x + h v of four bodies of the plane in lanes, and to the bit as turn_by turns them.
static bool move_four(float h, const Body<2>*, const LaneIndices<4>& bodies, Motion<2>* motions) {
  using L = Lanes<4>;
  MotionLanes<2, 4> motion = gather<2, 4>(motions, bodies);
  motion.delta_position += L(h) * motion.velocity;
  const L turn = L(h) * motion.spin[0];
  Rotation<2, L> by;
  sin_cos(turn, by[1], by[0]);
  const Rotation<2, L> turned = compose(by, motion.delta_rotation);
  const L size = sqrt(dot(turned, turned));
  const auto has_size = size > L(1.0e-12f);
  const L inverse = L(1.0f) / select(has_size, size, L(1.0f));
  const L square = turn * turn;
  for (int i = 0; i < 2; ++i) {
    L& q = motion.delta_rotation[i];
    const L to = select(has_size, inverse * turned[i], q);
    // What does not turn keeps its bits; what is no number does not.
    q = select(square > L(0.0f), to, select(square < L(1.0f), q, to));
  }
  scatter_pose(motion, kAllLanes<4>, bodies, motions);
  return true;
}

/// Moves the four bodies from a place of awake_bodies on, or the one that lies there. @returns the
/// place behind them.
template <int D>
static std::size_t move_some(float h, const WorldState<D>& state, std::size_t place,
                             std::size_t end, StepScratch<D>& scratch) {
  const std::uint32_t* slots = scratch.awake_bodies.data() + place;
  Motion<D>* motions = scratch.motions.data();
  if (place + 4 <= end &&
      move_four(h, state.bodies.data(), {slots[0], slots[1], slots[2], slots[3]}, motions))
    return place + 4;
  Motion<D>& motion = motions[slots[0]];
  motion.delta_position += h * motion.velocity;
  turn_freely(h, state.bodies[slots[0]], motion);
  return place + 1;
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
    const auto end = static_cast<std::size_t>(range.end);
    for (auto i = static_cast<std::size_t>(range.begin); i < end;) {
      const std::size_t next = move_some(context.h, state, i, end, scratch);
      turn_masses(context.h, state, i, next, scratch);
      if (pseudo) move_by_pseudo_velocities(context.h, i, next, scratch);
      i = next;
    }
  });
}

template void integrate_positions(const StepContext<2>&, const WorldState<2>&, Workers&,
                                  StepScratch<2>&);
template void integrate_positions(const StepContext<3>&, const WorldState<3>&, Workers&,
                                  StepScratch<3>&);

}  // namespace cycloid::solver
