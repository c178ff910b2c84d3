#include "solver/constraints/joints/joints.hpp"

namespace cycloid::solver {

/// The point anchor_b of b is drawn to anchor_a of a, which is the world's most of the time: a
/// mouse.
///   C = anchor_b - anchor_a [m], J as in the revolute joint, on a spring of `hertz` and
///   `damping_ratio`, with an impulse of length <= h force_max [N s], so that what hangs on it can
///   be held back and nothing is torn.
/// Source: Catto, "Soft Constraints" (GDC 2011).
template <int D>
void target_rows(const JointFrame<D>& frame, JointRows<D>& rows) {
  append_point_rows(frame, rows);
  rows.split = rows.count;
}

template void target_rows(const JointFrame<2>&, JointRows<2>&);
template void target_rows(const JointFrame<3>&, JointRows<3>&);

}  // namespace cycloid::solver
