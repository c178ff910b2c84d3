#include "solver/constraints/joints/joints.hpp"

namespace cycloid::solver {

/// A wheel b on a chassis a: it slides along the axis u of a and turns freely. In the plane.
///   C = t . d [m] with t across u and d = anchor_b - anchor_a: one equality,
///   J = (-t, -(r_a + d) x t, t, r_b x t). Impulse N s, unbounded.
/// The coordinate u . d [m] takes the suspension: a spring about `target` and limits. The motor
/// acts on the angle instead: J = (0, -1, 0, 1), rad/s, N m. Source: the wheel joint of Box2D's
/// manual; rows as in Catto, GDC 2009.
template <>
void wheel_rows(const JointFrame<2>& frame, JointRows<2>& rows) {
  const Vec<2> u = rotate(frame.rotation_a, frame.joint.axis);
  Vec<2> across[1];
  tangents(u, across);
  rows.rows[0] = translation_row(frame, across[0]);
  rows.count = 1;
  rows.split = 1;
  rows.has_axis = true;
  rows.axis = translation_row(frame, u);
  rows.has_motor_axis = true;
  rows.motor_axis.angular_a[0] = -1.0f;
  rows.motor_axis.angular_b[0] = 1.0f;
}

template <>
void wheel_rows(const JointFrame<3>&, JointRows<3>&) {}

}  // namespace cycloid::solver
