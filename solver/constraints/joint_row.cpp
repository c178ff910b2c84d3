#include "solver/constraints/joint_row.hpp"

namespace cycloid::solver {

template <int D>
static float effective_mass(const JointRow<D>& joint, const Row<D>& row) {
  const float k = row_coupling(joint, row, row);
  return k > 0.0f ? 1.0f / k : 0.0f;
}

/// K of the equalities [begin, end), factored.
template <int D>
static void factor_block(int begin, int end, JointRow<D>& joint,
                         BlockFactor<JointRow<D>::kRows>& block) {
  constexpr int kRows = JointRow<D>::kRows;
  float k[kRows][kRows];
  for (int i = begin; i < end; ++i)
    for (int j = begin; j <= i; ++j)
      k[i - begin][j - begin] = row_coupling(joint, joint.rows.rows[static_cast<std::size_t>(i)],
                                             joint.rows.rows[static_cast<std::size_t>(j)]);
  block.factor(k, end - begin);
}

template <int D>
void evaluate_rows(const WorldState<D>& state, float time_s, const Motion<D>& a, const Motion<D>& b,
                   JointRow<D>& row) {
  const Body<D>& body_a = state.bodies[row.body_a];
  const Body<D>& body_b = state.bodies[row.body_b];
  const JointFrame<D> frame =
      make_frame(state, state.joints[row.joint], body_a.position + a.delta_position,
                 row.centre_offset + (b.delta_position - a.delta_position),
                 compose(a.delta_rotation, body_a.rotation),
                 compose(b.delta_rotation, body_b.rotation), time_s);
  row.rows = JointRows<D>{};
  row.rows_function(frame, row.rows);
  factor_block(0, row.rows.split, row, row.blocks[0]);
  factor_block(row.rows.split, row.rows.count, row, row.blocks[1]);
  row.axis_mass = row.rows.has_axis ? effective_mass(row, row.rows.axis) : 0.0f;
  row.motor_mass =
      row.rows.has_motor_axis ? effective_mass(row, row.rows.motor_axis) : row.axis_mass;
}

template void evaluate_rows(const WorldState<2>&, float, const Motion<2>&, const Motion<2>&,
                            JointRow<2>&);
template void evaluate_rows(const WorldState<3>&, float, const Motion<3>&, const Motion<3>&,
                            JointRow<3>&);

}  // namespace cycloid::solver
