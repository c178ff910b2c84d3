#include "solver/constraints/joints/joints.hpp"
#include "solver/constraints/joints/swing_twist.hpp"
#include "solver/motion.hpp"

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

/// A wheel b on a chassis a in space: it slides along the axis u of a and turns about its axle.
///   C = t . d [m] for two directions t across u, and the axle e' of b along e, the axle of a
///   turned about u by the angle of steering: 4 equalities, one block, J as in translation_row and
///   append_axis_rows, whose directions u and e x u turn with e. Impulses N s and N m s, unbounded.
/// The coordinate u . d [m] takes the suspension: a spring about `target` and limits. The motor
/// acts on the spin about the axle: J = (0, -e', 0, e'), rad/s, N m.
/// Sources: as in the plane.
template <>
void wheel_rows(const JointFrame<3>& frame, JointRows<3>& rows) {
  const Joint<3>& joint = frame.joint;
  Vec<3> across[2];
  directions_across(frame, across);
  for (const Vec<3>& t : across)
    rows.rows[static_cast<std::size_t>(rows.count++)] = translation_row(frame, t);
  const Vec<3> steered = rotate(rotation_by(joint.steering * joint.axis), joint.axle);
  const AxisPair pair = axis_pair(frame, joint.axle, steered);
  const Vec<3> u = rotate(frame.rotation_a, joint.axis);
  append_axis_rows(pair, u, cross(pair.of_a, u), rows);
  rows.split = rows.count;
  rows.has_axis = true;
  rows.axis = translation_row(frame, u);
  rows.has_motor_axis = true;
  rows.motor_axis.angular_a = -pair.of_b;
  rows.motor_axis.angular_b = pair.of_b;
}

}  // namespace cycloid::solver
