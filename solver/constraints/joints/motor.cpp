#include "solver/constraints/joints/joints.hpp"
#include "solver/constraints/joints/unwrap.hpp"

namespace cycloid::solver {

static void aim(const JointFrame<2>& frame, Row<2>& row) {
  row.error -= nearest_turn(frame.joint.target, row.error);
}
static void aim(const JointFrame<3>&, Row<3>&) {}

/// A weld that yields: b is driven to a relative pose with bounded force.
///   C = (anchor_b - anchor_a [m], rotation since creation - target [rad], the shorter way round),
///   J as in the weld,
///   and the point's impulse has length <= h force_max, the rotation's <= h torque_max.
/// Top-down games use it as friction against the ground: anchors at the centre, hertz tiny.
/// Source: the motor joint of Box2D's manual; the bounds as in Catto, "Understanding Constraints"
/// (GDC 2014): a limit on the force is a limit h times it on the impulse.
template <int D>
void motor_rows(const JointFrame<D>& frame, JointRows<D>& rows) {
  append_point_rows(frame, rows);
  append_rotation_rows(frame, rows);
  rows.split = D;
  aim(frame, rows.rows[D]);
}

template void motor_rows(const JointFrame<2>&, JointRows<2>&);
template void motor_rows(const JointFrame<3>&, JointRows<3>&);

}  // namespace cycloid::solver
