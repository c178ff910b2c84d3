#include "solver/constraints/joints/joints.hpp"
#include "solver/constraints/joints/unwrap.hpp"
#include "solver/trig.hpp"

namespace cycloid::solver {

/// The coordinate is the angle of b relative to a, rad in (-pi, pi] or between its limits:
/// J = (0, -1, 0, 1).
static void set_angle_axis(const JointFrame<2>& frame, JointRows<2>& rows) {
  const Joint<2>& joint = frame.joint;
  // Most pins only pin: an arctangent that nothing asks for is a third of their cost.
  if (joint.limit_enabled == 0 && joint.motor == MotorKind::kOff && joint.hertz == 0.0f) return;
  rows.has_axis = true;
  rows.axis.angular_a[0] = -1.0f;
  rows.axis.angular_b[0] = 1.0f;
  rows.axis.error = angle_between_limits(atan2(frame.relative[1], frame.relative[0]), joint);
}
/// A ball joint turns about every axis; it has no coordinate.
static void set_angle_axis(const JointFrame<3>&, JointRows<3>&) {}

/// Two anchors at one point: a pin in the plane, a ball joint in space.
///   C = anchor_b - anchor_a [m],  Cdot = v_b + w_b x r_b - v_a - w_a x r_a,
///   J_i = (-u_i, -(r_a + d) x u_i, u_i, r_b x u_i) along the axes u_i of body a, d = C:
///   D equalities solved as one block, impulse [N s] unbounded.
/// In the plane a spring, a motor and limits act on the angle [rad], in N m s.
/// Source: Catto, "Modeling and Solving Constraints" (GDC 2009).
template <int D>
void revolute_rows(const JointFrame<D>& frame, JointRows<D>& rows) {
  append_point_rows(frame, rows);
  rows.split = rows.count;
  set_angle_axis(frame, rows);
}

template void revolute_rows(const JointFrame<2>&, JointRows<2>&);
template void revolute_rows(const JointFrame<3>&, JointRows<3>&);

}  // namespace cycloid::solver
