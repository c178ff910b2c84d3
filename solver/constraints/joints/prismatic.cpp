#include "solver/constraints/joints/joints.hpp"

namespace cycloid::solver {

/// A slider: b moves along an axis u of a and does not turn relative to it.
///   C_t = t . d [m] for each direction t across u, with d = anchor_b - anchor_a,
///   J_t = (-t, -(r_a + d) x t, t, r_b x t), and the rotation rows [rad]: 2 equalities in the
///   plane, 5 in space, one block. Impulses N s and N m s, unbounded.
/// The coordinate u . d [m] takes a spring, limits and a motor.
/// Source: Catto, "Modeling and Solving Constraints" (GDC 2009).
template <int D>
void prismatic_rows(const JointFrame<D>& frame, JointRows<D>& rows) {
  const Vec<D> u = rotate(frame.rotation_a, frame.joint.axis);
  Vec<D> across[Dim<D>::kTangents];
  directions_across(frame, across);
  for (const Vec<D>& t : across)
    rows.rows[static_cast<std::size_t>(rows.count++)] = translation_row(frame, t);
  append_rotation_rows(frame, rows);
  rows.split = rows.count;
  rows.has_axis = true;
  rows.axis = translation_row(frame, u);
}

template void prismatic_rows(const JointFrame<2>&, JointRows<2>&);
template void prismatic_rows(const JointFrame<3>&, JointRows<3>&);

}  // namespace cycloid::solver
