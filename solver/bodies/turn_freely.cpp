#include "solver/stages/turn_freely.hpp"

namespace cycloid::solver {

using FourLanes = Lanes<4>;

bool keeps_its_spin(const Body<3>& body) {
  if (!(body.inverse_inertia.m[0] > 0.0f)) return true;
  const float* m = body.inertia.m;
  const float off = abs(m[1]) + abs(m[2]) + abs(m[5]);
  return abs(m[0] - m[4]) + abs(m[4] - m[8]) + off <= 1.0e-6f * m[0];
}

/// exp(-turn) v - v.
static Vec<3> turned_back_change(const Spin<3>& turn, const Vec<3>& v) {
  if (dot(turn, turn) < kSmallTurnSquare) return small_turned_back_change(turn, v);
  return rotate_back(rotation_by(turn), v) - v;
}

void turn_freely(float h, const Body<3>& body, Motion<3>& motion) {
  if (keeps_its_spin(body)) return turn_by(h * motion.spin, motion);
  const Rotation<3> before = compose(motion.delta_rotation, body.rotation);
  const Spin<3> spin = rotate_back(before, motion.spin);
  const Spin<3> momentum = times(body.inertia.m, spin);
  const float half = 0.5f * h;
  Spin<3> middle = Spin<3>::zero();  // Of the spin in the middle, from `spin`.
  for (int i = 0; i < kMidpointIterations; ++i) {
    const Spin<3> change = turned_back_change(half * (spin + middle), momentum);
    const Spin<3> moved = solve_turning(body.inertia.m, -half * (momentum + change),
                                        change - times(body.inertia.m, middle));
    middle += moved;
    if (dot(moved, moved) <= kMidpointAccuracy * dot(spin, spin)) break;
  }
  const Spin<3> turn = h * (spin + middle);
  const Rotation<3> turned = rotation_by(rotate(before, turn));
  motion.delta_rotation =
      normalized_or(compose(turned, motion.delta_rotation), motion.delta_rotation);
  const Rotation<3> after = compose(motion.delta_rotation, body.rotation);
  motion.spin = rotate(turned, motion.spin) +
                rotate(after, times(body.inverse_inertia.m, turned_back_change(turn, momentum)));
}

/// What of four bodies decides how they turn, one in each lane.
struct TurningBodies {
  Rotation<3, FourLanes> rotation;
  FourLanes inertia[9];
  FourLanes inverse_inertia[9];
  FourLanes tumbles;  ///< 1, or 0 where the body keeps its spin.
};

static TurningBodies gather_bodies(const Body<3>* bodies, const LaneIndices<4>& slots) {
  float numbers[23][4];
  for (int lane = 0; lane < 4; ++lane) {
    const Body<3>& body = bodies[slots[lane]];
    for (int i = 0; i < 4; ++i) numbers[i][lane] = body.rotation[i];
    for (int i = 0; i < 9; ++i) numbers[4 + i][lane] = body.inertia.m[i];
    for (int i = 0; i < 9; ++i) numbers[13 + i][lane] = body.inverse_inertia.m[i];
    numbers[22][lane] = keeps_its_spin(body) ? 0.0f : 1.0f;
  }
  TurningBodies in_lanes;
  for (int i = 0; i < 4; ++i) in_lanes.rotation[i] = FourLanes::load(numbers[i]);
  for (int i = 0; i < 9; ++i) in_lanes.inertia[i] = FourLanes::load(numbers[4 + i]);
  for (int i = 0; i < 9; ++i) in_lanes.inverse_inertia[i] = FourLanes::load(numbers[13 + i]);
  in_lanes.tumbles = FourLanes::load(numbers[22]);
  return in_lanes;
}

template <int N>
static void choose(FourLanes::Mask mask, const Vec<N, FourLanes>& yes,
                   Vec<N, FourLanes>& or_as_it_is) {
  for (int i = 0; i < N; ++i) or_as_it_is[i] = select(mask, yes[i], or_as_it_is[i]);
}

static bool any(FourLanes::Mask mask) {
  return any_above_zero(select(mask, FourLanes(1.0f), FourLanes(0.0f)));
}

static FourLanes::Mask is_large(const Spin<3, FourLanes>& turn) {
  return ~(dot(turn, turn) < FourLanes(kSmallTurnSquare));
}

/// What Newton's method finds of the spin in the middle, from `spin`, in lanes of `tumbles`.
/// @returns false where a turn on the way is too large for a series.
static bool find_middle(FourLanes half, const TurningBodies& bodies, const Spin<3, FourLanes>& spin,
                        const Spin<3, FourLanes>& momentum, FourLanes::Mask tumbles,
                        Spin<3, FourLanes>& middle) {
  FourLanes::Mask open = tumbles;
  const FourLanes enough = FourLanes(kMidpointAccuracy) * dot(spin, spin);
  for (int i = 0; i < kMidpointIterations && any(open); ++i) {
    const Spin<3, FourLanes> turn = half * (spin + middle);
    if (any(open & is_large(turn))) return false;
    const Spin<3, FourLanes> change = small_turned_back_change(turn, momentum);
    const Spin<3, FourLanes> moved = solve_turning(bodies.inertia, -half * (momentum + change),
                                                   change - times(bodies.inertia, middle));
    choose(open, middle + moved, middle);
    open = open & ~(dot(moved, moved).raw <= enough.raw);
  }
  return true;
}

static void turn_lanes_by(const Rotation<3, FourLanes>& by, FourLanes::Mask mask,
                          Rotation<3, FourLanes>& q) {
  const Rotation<3, FourLanes> turned = compose(by, q);
  const FourLanes size = sqrt(dot(turned, turned));
  const FourLanes::Mask has_size = size > FourLanes(1.0e-12f);
  choose(mask & has_size, (FourLanes(1.0f) / select(has_size, size, FourLanes(1.0f))) * turned, q);
}

bool move_four(float h, const Body<3>* bodies, const LaneIndices<4>& slots, Motion<3>* motions) {
  MotionLanes<3, 4> motion = gather<3, 4>(motions, slots);
  const TurningBodies of = gather_bodies(bodies, slots);
  const FourLanes::Mask tumbles = of.tumbles > FourLanes(0.0f);
  const Rotation<3, FourLanes> before = compose(motion.delta_rotation, of.rotation);
  const Spin<3, FourLanes> spin = rotate_back(before, motion.spin);
  const Spin<3, FourLanes> momentum = times(of.inertia, spin);
  Spin<3, FourLanes> middle = Spin<3, FourLanes>::zero();
  if (!find_middle(FourLanes(0.5f * h), of, spin, momentum, tumbles, middle)) return false;
  const Spin<3, FourLanes> turn = FourLanes(h) * (spin + middle);
  Spin<3, FourLanes> turn_in_world = FourLanes(h) * motion.spin;
  choose(tumbles, rotate(before, turn), turn_in_world);
  if (any(is_large(turn_in_world) | (tumbles & is_large(turn)))) return false;
  const FourLanes square = dot(turn_in_world, turn_in_world);
  const Rotation<3, FourLanes> by = small_rotation_by(turn_in_world, square);
  turn_lanes_by(by, tumbles | (square.raw != FourLanes(0.0f).raw), motion.delta_rotation);
  const Rotation<3, FourLanes> after = compose(motion.delta_rotation, of.rotation);
  choose(tumbles,
         rotate(by, motion.spin) +
             rotate(after, times(of.inverse_inertia, small_turned_back_change(turn, momentum))),
         motion.spin);
  motion.delta_position += FourLanes(h) * motion.velocity;
  scatter_pose(motion, kAllLanes<4>, slots, motions);
  return true;
}

}  // namespace cycloid::solver
