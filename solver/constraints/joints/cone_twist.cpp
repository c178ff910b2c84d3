#include "solver/constraints/joints/joints.hpp"
#include "solver/constraints/joints/swing_twist.hpp"
#include "solver/trig.hpp"

namespace cycloid::solver {

/// A shoulder: a ball joint whose swing and twist have limits and whose rotation may rub. In space.
///   C = anchor_b - anchor_a [m]: 3 equalities, J as in append_point_rows, impulse N s unbounded.
/// With limits, one-sided rows in N m s with the equalities held: swing <= cone (swing_row) and
/// lower <= twist <= upper (twist_row). With torque_max or angular_hertz a second block of 3 rows,
/// C = rotation since creation [rad] (append_rotation_rows), of length <= h torque_max where that
/// is > 0: a spring to the pose of creation, or friction, which knows only the speed.
/// Sources: Catto, "Modeling and Solving Constraints" (GDC 2009); the cone-twist constraint of
/// Bullet's manual for the parameters.
template <>
void cone_twist_rows(const JointFrame<3>& frame, JointRows<3>& rows) {
  const Joint<3>& joint = frame.joint;
  append_point_rows(frame, rows);
  rows.split = rows.count;
  if (joint.torque_max > 0.0f || joint.angular_hertz > 0.0f) append_rotation_rows(frame, rows);
  if (joint.limit_enabled == 0) return;
  const AxisPair pair = axis_pair(frame, joint.axis);
  rows.has_axis = true;
  rows.axis = twist_row(frame, joint.axis, pair);
  // Swing does not go beyond pi but comes back: a limit there would stop what passes through.
  if (joint.cone >= kPi) return;
  rows.has_cone_axis = true;
  rows.cone_axis = swing_row(pair);
}

template <>
void cone_twist_rows(const JointFrame<2>&, JointRows<2>&) {}

}  // namespace cycloid::solver
