#include "solver/constraints/joints/curves.hpp"
#include "solver/constraints/joints/joints.hpp"

namespace cycloid::solver {

static CurvePoint nearest_on_curve(const JointFrame<2>& frame) {
  const Joint<2>& joint = frame.joint;
  if (joint.curve == CurveKind::kPolyline)
    return nearest_on_outline(frame.state, joint.body_a,
                              rotate_back(frame.rotation_a, frame.r_a + frame.offset));
  return nearest_on_curve(joint.curve, joint.size, rotate_back(frame.rotation_a, frame.offset));
}

/// A bead on a wire, or a ball in a half-pipe: the point anchor_b of b and a curve fixed to a.
///   C = distance of the point from the curve [m], positive on its hollow side, n its gradient,
///   J = (-n, -(r_a + d) x n, n, r_b x n) with d from the origin of the curve to the point.
/// Without limits one equality (the constraint does no work: lambda Jv = 0); with limits the point
/// stays between the offsets `lower` and `upper` of the curve, each impulse >= 0, without friction.
/// Source: Catto, "Understanding Constraints" (GDC 2014), the bead on a wire and the half-pipe.
template <>
void curve_rows(const JointFrame<2>& frame, JointRows<2>& rows) {
  const CurvePoint nearest = nearest_on_curve(frame);
  Row<2> row = translation_row(frame, rotate(frame.rotation_a, nearest.normal));
  row.error = nearest.distance;
  if (frame.joint.limit_enabled != 0) {
    rows.has_axis = true;
    rows.axis = row;
    return;
  }
  rows.rows[0] = row;
  rows.count = 1;
  rows.split = 1;
}

template <>
void curve_rows(const JointFrame<3>&, JointRows<3>&) {}

}  // namespace cycloid::solver
