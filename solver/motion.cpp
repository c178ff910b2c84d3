#include "solver/motion.hpp"

#include "solver/trig.hpp"

namespace cycloid::solver {

Rotation<2> rotation_by(const Spin<2>& turn) {
  float sine = 0.0f;
  float cosine = 0.0f;
  sin_cos(turn[0], sine, cosine);  // Into q it would wait for both to be read back as one.
  return {{cosine, sine}};
}

Rotation<3> rotation_by(const Spin<3>& turn) {
  const float square = dot(turn, turn);
  if (square < kSmallTurnSquare) return small_rotation_by(turn, square);
  const float angle = sqrt(square);
  float sine = 0.0f;
  float cosine = 0.0f;
  sin_cos(0.5f * angle, sine, cosine);
  const float scale = sine / angle;
  return {{scale * turn[0], scale * turn[1], scale * turn[2], cosine}};
}

Spin<2> turn_of(const Rotation<2>& q) {
  return {{atan2(q[1], q[0])}};
}
Spin<3> turn_of(const Rotation<3>& q) {
  const Vec<3> axis = {{q[0], q[1], q[2]}};
  const float sine = length(axis);
  const float sign = q[3] < 0.0f ? -1.0f : 1.0f;
  // 2 atan2(s, c) / s -> 2 where the division has no digits left.
  const float scale = sine > 1.0e-6f ? 2.0f * atan2(sine, sign * q[3]) / sine : 2.0f;
  return (sign * scale) * axis;
}

}  // namespace cycloid::solver
