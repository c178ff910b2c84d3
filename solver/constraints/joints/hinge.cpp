#include "solver/constraints/joints/joints.hpp"
#include "solver/constraints/joints/swing_twist.hpp"

namespace cycloid::solver {

/// A door: b turns about an axis u of a, which stays fixed in both. In space.
///   C = (anchor_b - anchor_a [m], twice the tangent of half the angle between u and u',
///   along two directions across u), u' being u as b carries it: 5 equalities, one block, J as in
///   append_point_rows and append_axis_rows, impulses N s and N m s, unbounded.
/// The coordinate is the twist of b about u since creation, rad in (-pi, pi], J as in twist_row. A
/// spring, limits and a motor act on it, in N m s.
/// Source: Catto, "Modeling and Solving Constraints" (GDC 2009).
template <>
void hinge_rows(const JointFrame<3>& frame, JointRows<3>& rows) {
  const Joint<3>& joint = frame.joint;
  append_point_rows(frame, rows);
  Vec<3> across[2];
  directions_across(frame, across);
  const AxisPair pair = axis_pair(frame, joint.axis);
  append_axis_rows(pair, across[0], across[1], rows);
  rows.split = rows.count;
  if (joint.limit_enabled == 0 && joint.motor == MotorKind::kOff && joint.hertz == 0.0f) return;
  rows.has_axis = true;
  rows.axis = twist_row(frame, joint.axis, pair);
}

template <>
void hinge_rows(const JointFrame<2>&, JointRows<2>&) {}

}  // namespace cycloid::solver
