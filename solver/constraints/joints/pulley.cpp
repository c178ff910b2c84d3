#include "solver/constraints/joints/joints.hpp"

namespace cycloid::solver {

/// A rope over two fixed points. With d_a = anchor_a - ground_a, u_a = d_a / |d_a|, and b alike:
///   C = |d_a| + ratio |d_b| - length [m],
///   J = (u_a, r_a x u_a, ratio u_b, ratio r_b x u_b): one equality, impulse N s unbounded. With
///   limits the rope may slacken: lower <= |d_a| + ratio |d_b| <= upper.
/// Source: the pulley joint of Box2D's manual; Catto, GDC 2009, for the rows.
template <int D>
void pulley_rows(const JointFrame<D>& frame, JointRows<D>& rows) {
  const Joint<D>& joint = frame.joint;
  Vec<D> down = Vec<D>::zero();
  down[1] = -1.0f;
  const Vec<D> d_a = (frame.position_a - joint.ground_a) + frame.r_a;
  const Vec<D> d_b = (frame.position_b - joint.ground_b) + frame.r_b;
  const Vec<D> u_a = normalized_or(d_a, down);
  const Vec<D> u_b = normalized_or(d_b, down);
  Row<D> row;
  row.linear_a = u_a;
  row.angular_a = moment(frame.r_a, u_a);
  row.linear_b = joint.ratio * u_b;
  row.angular_b = joint.ratio * moment(frame.r_b, u_b);
  row.error = length(d_a) + joint.ratio * length(d_b);
  if (joint.limit_enabled != 0) {
    rows.has_axis = true;
    rows.axis = row;
    return;
  }
  row.error -= joint.length;
  rows.rows[0] = row;
  rows.count = 1;
  rows.split = 1;
}

template void pulley_rows(const JointFrame<2>&, JointRows<2>&);
template void pulley_rows(const JointFrame<3>&, JointRows<3>&);

}  // namespace cycloid::solver
