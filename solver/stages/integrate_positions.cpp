#include "solver/constraints/motion_lanes.hpp"
#include "solver/constraints/trig_lanes.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// In the plane a free body keeps its spin.
static void turn_freely(float h, const Body<2>&, Motion<2>& motion) {
  turn_by(h * motion.spin, motion);
}

static bool is_round(const Inertia<3>& inertia) {
  const float* m = inertia.m;
  const float off = abs(m[1]) + abs(m[2]) + abs(m[5]);
  return abs(m[0] - m[4]) + abs(m[4] - m[8]) + off <= 1.0e-6f * m[0];
}

/// exp(-turn) v - v, as a difference that keeps its digits for small turns.
static Vec<3> turned_back_change(const Spin<3>& turn, const Vec<3>& v) {
  const float square = dot(turn, turn);
  if (square >= 0.25f) return rotate_back(rotation_by(turn), v) - v;
  const float sine = 1.0f - square * (1.0f / 6.0f - square * (1.0f / 120.0f - square / 5040.0f));
  const float versine =
      0.5f - square * (1.0f / 24.0f - square * (1.0f / 720.0f - square / 40320.0f));
  const Vec<3> across = cross(turn, v);
  return versine * cross(turn, across) - sine * across;
}

/// (I + [a]x)^-1 b by Cramer's rule: regular for every a, since its determinant is
/// det I + a . I a > 0.
static Vec<3> solve_turning(const Inertia<3>& inertia, const Vec<3>& a, const Vec<3>& b) {
  const float* m = inertia.m;
  const Vec<3> x = {{m[0], m[3] + a[2], m[6] - a[1]}};
  const Vec<3> y = {{m[1] - a[2], m[4], m[7] + a[0]}};
  const Vec<3> z = {{m[2] + a[1], m[5] - a[0], m[8]}};
  const Vec<3> across = cross(y, z);
  const float inverse = 1.0f / dot(x, across);
  return {{inverse * dot(b, across), inverse * dot(b, cross(z, x)), inverse * dot(b, cross(x, y))}};
}

/// Most of them; two or three are the rule, a needle across its length at 1 rad per substep takes
/// all.
static constexpr int kMidpointIterations = 8;

/// In space it keeps its angular momentum L = I w, so the spin changes as the inertia turns with
/// the body. In the body's frame L' = exp(-h m) L, where m, the spin of the step's middle, answers
/// to exp(-h m / 2) L: the implicit midpoint rule, symmetric in time, so that L is kept to rounding
/// and the energy without drift. The explicit term h w x I w gains energy, Catto's implicit one
/// (GDC 2015) loses it. By Newton's method: simple iteration diverges for needles, whose small
/// moment answers to the large momentum.
///
/// Only changes of the spin pass through I^-1 and the frame of the body: whole spins would take
/// their rounding along in every substep.
static void turn_freely(float h, const Body<3>& body, Motion<3>& motion) {
  const bool turns = body.inverse_inertia.m[0] > 0.0f;
  if (!turns || is_round(body.inertia)) return turn_by(h * motion.spin, motion);
  const Rotation<3> before = compose(motion.delta_rotation, body.rotation);
  const Spin<3> spin = rotate_back(before, motion.spin);
  const Spin<3> momentum = body.inertia * spin;
  const float half = 0.5f * h;
  Spin<3> middle = Spin<3>::zero();  // Of the spin in the middle, from `spin`.
  for (int i = 0; i < kMidpointIterations; ++i) {
    const Spin<3> change = turned_back_change(half * (spin + middle), momentum);
    const Spin<3> moved =
        solve_turning(body.inertia, -half * (momentum + change), change - body.inertia * middle);
    middle += moved;
    if (dot(moved, moved) <= 1.0e-14f * dot(spin, spin)) break;
  }
  const Spin<3> turn = h * (spin + middle);
  const Rotation<3> turned = rotation_by(rotate(before, turn));
  motion.delta_rotation =
      normalized_or(compose(turned, motion.delta_rotation), motion.delta_rotation);
  const Rotation<3> after = compose(motion.delta_rotation, body.rotation);
  motion.spin = rotate(turned, motion.spin) +
                rotate(after, body.inverse_inertia * turned_back_change(turn, momentum));
}

static bool turn_inertia(float, const Body<2>&, const Motion<2>&, BodyMass<2>&) {
  return false;
}
/// The inverse inertia in the world at the present rotation, where that has changed by more than a
/// thousandth of a radian in this substep. Kept for a whole tick it would turn a top's joint force
/// into spin about its own axis: at 60 rad/s a tick is one radian.
static bool turn_inertia(float h, const Body<3>& body, const Motion<3>& motion, BodyMass<3>& mass) {
  constexpr float kTurnMin = 1.0e-3f;
  if (body.inverse_inertia.m[0] == 0.0f || is_round(body.inertia)) return false;
  if (h * h * dot(motion.spin, motion.spin) <= kTurnMin * kTurnMin) return false;
  mass.inverse_inertia =
      world_inertia(body.inverse_inertia, compose(motion.delta_rotation, body.rotation));
  return true;
}

/// x' = x + h v and q' = exp(h w) q of the body at a place of awake_bodies; see
/// integrate_positions.
template <int D>
static void move_body(float h, const WorldState<D>& state, std::size_t place,
                      StepScratch<D>& scratch) {
  const std::uint32_t slot = scratch.awake_bodies[place];
  const Body<D>& body = state.bodies[slot];
  Motion<D>& motion = scratch.motions[slot];
  motion.delta_position += h * motion.velocity;
  turn_freely(h, body, motion);
  const bool turned = turn_inertia(h, body, motion, scratch.masses[slot]);
  scratch.inertia_turned[slot] = turned ? 1 : 0;
  if (!turned) return;
  const Spin<D> rate = scratch.masses[slot].inverse_inertia * body.torque;
  for (int axis = 0; axis < Dim<D>::kSpin; ++axis)
    scratch.accelerations[place].rate[D + axis] = rate[axis];
}

/// The same for four bodies of the plane in lanes, to the bit as turn_by does it.
static void move_four(float h, const LaneIndices<4>& bodies, Motion<2>* motions) {
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
  const std::vector<std::uint32_t>& bodies = scratch.awake_bodies;
  workers.parallel_for(static_cast<int>(bodies.size()), kBodyGrain, [&](Range range) {
    auto i = static_cast<std::size_t>(range.begin);
    const auto end = static_cast<std::size_t>(range.end);
    if constexpr (Dim<D>::kSpin == 1) {
      for (; !pseudo && i + 4 <= end; i += 4)
        move_four(context.h, {bodies[i], bodies[i + 1], bodies[i + 2], bodies[i + 3]},
                  scratch.motions.data());
    }
    for (; i < end; ++i) {
      move_body(context.h, state, i, scratch);
      if (!pseudo) continue;
      Motion<D>& motion = scratch.motions[bodies[i]];
      motion.delta_position += context.h * scratch.saved_motions[bodies[i]].velocity;
      turn_by(context.h * scratch.saved_motions[bodies[i]].spin, motion);
    }
  });
}

template void integrate_positions(const StepContext<2>&, const WorldState<2>&, Workers&,
                                  StepScratch<2>&);
template void integrate_positions(const StepContext<3>&, const WorldState<3>&, Workers&,
                                  StepScratch<3>&);

}  // namespace cycloid::solver
