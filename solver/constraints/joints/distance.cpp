#include "solver/constraints/joints/joints.hpp"

namespace cycloid::solver {

/// Two anchors at a distance. With d = anchor_b - anchor_a and u = d / |d|:
///   C = |d| - length [m],  Cdot = u . (v_b + w_b x r_b - v_a - w_a x r_a),
///   J = (-u, -r_a x u, u, r_b x u).
/// Rigid: one equality, impulse along u [N s] unbounded. With hertz > 0 a spring of rest length
/// `length` along the coordinate |d|; with limits a rope or a strut: lower <= |d| <= upper, each
/// limit's impulse >= 0. A position motor holds |d| at `target`, whatever the length.
/// Source: Catto, "Modeling and Solving Constraints" (GDC 2009) and "Soft Constraints" (2011).
template <int D>
void distance_rows(const JointFrame<D>& frame, JointRows<D>& rows) {
  // Anchors that have come to one point part along the first axis: any will do, but one it must be.
  Vec<D> fallback = Vec<D>::zero();
  fallback[0] = 1.0f;
  const Vec<D> u = normalized_or(frame.offset, fallback);
  Row<D> row;
  row.linear_a = -u;
  row.angular_a = -moment(frame.r_a, u);
  row.linear_b = u;
  row.angular_b = moment(frame.r_b, u);
  row.error = length(frame.offset);
  const bool rigid = frame.joint.hertz == 0.0f && frame.joint.limit_enabled == 0 &&
                     frame.joint.motor == MotorKind::kOff;
  if (!rigid) {
    rows.has_axis = true;
    rows.axis = row;
    return;
  }
  row.error -= frame.joint.length;
  rows.rows[static_cast<std::size_t>(rows.count++)] = row;
  rows.split = rows.count;
}

template void distance_rows(const JointFrame<2>&, JointRows<2>&);
template void distance_rows(const JointFrame<3>&, JointRows<3>&);

}  // namespace cycloid::solver
