#include "solver/bodies/turn_freely.hpp"

namespace cycloid::solver {

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

static void turn_tumbling(float h, const Body<3>& body, Motion<3>& motion) {
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

void turn_freely(float h, const Body<3>& body, Motion<3>& motion) {
  if (keeps_its_spin(body)) return turn_by(h * motion.spin, motion);
  const float turn = h * length(motion.spin);
  int parts = 1;
  while (turn > kTurnMost * static_cast<float>(parts) && parts < kTurnParts) parts *= 2;
  for (int i = 0; i < parts; ++i) turn_tumbling(h / static_cast<float>(parts), body, motion);
}

}  // namespace cycloid::solver
