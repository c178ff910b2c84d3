#include "solver/constraints/joints/swing_twist.hpp"

#include "solver/constraints/joint_bounds.hpp"
#include "solver/constraints/joints/unwrap.hpp"
#include "solver/trig.hpp"

namespace cycloid::solver {

AxisPair axis_pair(const JointFrame<3>& frame, const Vec<3>& axis) {
  return axis_pair(frame, axis, axis);
}

AxisPair axis_pair(const JointFrame<3>& frame, const Vec<3>& before, const Vec<3>& now) {
  return {rotate(frame.rotation_a, now),
          rotate(frame.rotation_b, rotate_back(frame.joint.reference, before))};
}

static Row<3> couple(const Vec<3>& direction, float error) {
  Row<3> row;
  row.angular_a = -direction;
  row.angular_b = direction;
  row.error = error;
  return row;
}

void append_axis_rows(const AxisPair& pair, const Vec<3>& t_0, const Vec<3>& t_1,
                      JointRows<3>& rows) {
  const Vec<3> error = cross(pair.of_a, pair.of_b);
  const float inverse = 1.0f / max(1.0f + dot(pair.of_a, pair.of_b), kLeastTogether);
  for (const Vec<3>& t : {t_0, t_1}) {
    const float part = inverse * dot(t, error);
    rows.rows[static_cast<std::size_t>(rows.count++)] = couple(
        (2.0f * inverse) * (cross(pair.of_b, cross(t, pair.of_a)) + part * error), 2.0f * part);
  }
}

float twist_angle(const Rotation<3>& q, const Vec<3>& axis) {
  const float along = dot(Vec<3>{{q[0], q[1], q[2]}}, axis);
  // q and -q are one rotation; the half angle is taken in (-pi / 2, pi / 2].
  const bool flip = q[3] < 0.0f || (q[3] == 0.0f && along < 0.0f);
  return 2.0f * (flip ? atan2(-along, -q[3]) : atan2(along, q[3]));
}

Row<3> twist_row(const JointFrame<3>& frame, const Vec<3>& axis, const AxisPair& pair) {
  const float both = 1.0f + dot(pair.of_a, pair.of_b);
  if (both < kLeastTogether) return {};
  const float angle = twist_angle(frame.relative, rotate_back(frame.joint.reference, axis));
  return couple((1.0f / both) * (pair.of_a + pair.of_b), angle_between_limits(angle, frame.joint));
}

Row<3> swing_row(const AxisPair& pair) {
  const Vec<3> normal = cross(pair.of_a, pair.of_b);
  const float sine = length(normal);
  Vec<3> across[2];
  tangents(pair.of_a, across);
  return couple(sine > 1.0e-6f ? (1.0f / sine) * normal : across[0],
                atan2(sine, dot(pair.of_a, pair.of_b)));
}

}  // namespace cycloid::solver
