#include "solver/constraints/joints/joints.hpp"
#include "solver/constraints/joints/unwrap.hpp"

namespace cycloid::solver {

/// Two bodies, each on an axle of its own, turn in a fixed ratio. In the plane.
///   C = angle_a + ratio angle_b - target [rad],  J = (0, 1, 0, ratio); with an axis u (world) body
///   b is a rack: C = angle_a + ratio u . x_b - target,  J = (0, 1, ratio u, 0).
/// Angles count whole turns in a float, so a wheel is held to 0.01 rad at 1e5 rad and to 0.06 at
/// 1e6, beyond which it slips; and they are counted once a tick, so one that makes more than half a
/// turn in it (1,800 rpm at 60 Hz) is miscounted by whole turns. `target` is the sum at creation.
/// Impulse N m s, unbounded. Loops of gears whose ratios contradict each other have no solution but
/// rest: the impulses stay bounded because each row is solved on its own effective mass.
/// Source: the gear joint of Box2D's manual; Catto, GDC 2009, for the rows.
template <>
void gear_rows(const JointFrame<2>& frame, JointRows<2>& rows) {
  const Joint<2>& joint = frame.joint;
  Row<2>& row = rows.rows[0];
  row = Row<2>{};
  row.angular_a[0] = 1.0f;
  const float angle_a = unwrapped_angle(frame.rotation_a, joint.unwrapped[0]);
  if (dot(joint.axis, joint.axis) > 0.0f) {
    row.linear_b = joint.ratio * joint.axis;
    row.error = angle_a + joint.ratio * dot(joint.axis, frame.position_b) - joint.target;
  } else {
    row.angular_b[0] = joint.ratio;
    const float angle_b = unwrapped_angle(frame.rotation_b, joint.unwrapped[1]);
    row.error = angle_a + joint.ratio * angle_b - joint.target;
  }
  rows.count = 1;
  rows.split = 1;
}

template <>
void gear_rows(const JointFrame<3>&, JointRows<3>&) {}

}  // namespace cycloid::solver
