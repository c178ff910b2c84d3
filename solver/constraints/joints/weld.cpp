#include "solver/constraints/joints/joints.hpp"

namespace cycloid::solver {

/// b keeps the pose that it had relative to a at creation.
///   C = (anchor_b - anchor_a [m], rotation since creation [rad]): every freedom an equality,
///   J as in append_point_rows and append_rotation_rows. Rigid: one block of 3 or 6 rows, impulses
///   unbounded. Soft (hertz or angular_hertz > 0): point and rotation are a block each, and a
///   spring beside a rigid one is on the mass that this leaves it (hold_other_block).
/// Source: Catto, "Modeling and Solving Constraints" (GDC 2009).
template <int D>
void weld_rows(const JointFrame<D>& frame, JointRows<D>& rows) {
  append_point_rows(frame, rows);
  append_rotation_rows(frame, rows);
  const bool soft = frame.joint.hertz > 0.0f || frame.joint.angular_hertz > 0.0f;
  rows.split = soft ? D : rows.count;
}

template void weld_rows(const JointFrame<2>&, JointRows<2>&);
template void weld_rows(const JointFrame<3>&, JointRows<3>&);

}  // namespace cycloid::solver
