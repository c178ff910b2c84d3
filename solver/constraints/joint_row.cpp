#include "solver/constraints/joint_row.hpp"

namespace cycloid::solver {

/// K of the equalities [begin, end), factored.
template <int D>
static void factor_block(int begin, int end, JointRow<D>& joint,
                         BlockFactor<JointRow<D>::kRows>& block) {
  constexpr int kRows = JointRow<D>::kRows;
  float k[kRows][kRows];
  for (int j = begin; j < end; ++j) {
    const RowResponse<D> response =
        response_to(joint, joint.rows.rows[static_cast<std::size_t>(j)]);
    for (int i = j; i < end; ++i)
      k[i - begin][j - begin] =
          row_coupling(joint.rows.rows[static_cast<std::size_t>(i)], response);
  }
  block.factor(k, end - begin);
}

/// K of a spring's equalities with the other block, which is rigid, held: K_ss - K_sr K_rr^-1 K_rs,
/// in place of K_ss. On that mass it swings at its frequency, however far its anchor is from the
/// centres of mass. @pre both blocks are factored.
template <int D>
static void hold_other_block(JointRow<D>& joint) {
  constexpr int kRows = JointRow<D>::kRows;
  const int spring = joint.is_spring[0] ? 0 : 1;
  const BlockRows block = rows_of_block(joint.rows, spring);
  const Row<D>* rows = joint.rows.rows.data() + block.begin;
  float k[kRows][kRows];
  for (int j = 0; j < block.count; ++j) {
    PairImpulse<D> held;
    float reaction[kRows];
    held.add(rows[j], 1.0f);
    add_reaction(joint, 1 - spring, held, reaction);
    const RowResponse<D> response = response_to(joint, held);
    for (int i = j; i < block.count; ++i) k[i][j] = row_coupling(rows[i], response);
    // A row that the other block decides already has nothing to give.
    const float alone = row_coupling(rows[j], response_to(joint, rows[j]));
    if (!(k[j][j] > 1.0e-6f * alone)) k[j][j] = 0.0f;
  }
  joint.blocks[spring].factor(k, block.count);
}

/// K_ll - K_le K_ee^-1 K_el, inverted, and K_ee^-1 K_el: row l with the equalities e held.
template <int D>
static HeldRow<D> hold_block(const JointRow<D>& joint, const Row<D>& row) {
  HeldRow<D> held{};
  const RowResponse<D> response = response_to(joint, row);
  const float k = row_coupling(row, response);
  const int count = joint.rows.split;
  float across[JointRow<D>::kRows];
  for (int i = 0; i < count; ++i) {
    across[i] = row_coupling(joint.rows.rows[static_cast<std::size_t>(i)], response);
    held.reaction[i] = across[i];
  }
  joint.blocks[0].solve(held.reaction, count);
  float left = k;
  for (int i = 0; i < count; ++i) left -= across[i] * held.reaction[i];
  // A row that the equalities decide already has nothing to give.
  held.mass = left > 1.0e-6f * k ? 1.0f / left : 0.0f;
  return held;
}

static void hold_cone(JointRow<2>&) {}
static void hold_cone(JointRow<3>& row) {
  if (has_cone(row)) row.held_cone = hold_block(row, row.rows.cone_axis);
}

static bool cone_is_near(float, const JointRow<2>&, const Motion<2>&, const Motion<2>&) {
  return false;
}
static bool cone_is_near(float room, const JointRow<3>& row, const Motion<3>& a,
                         const Motion<3>& b) {
  if (!has_cone(row)) return false;
  const float way = row.limit_reach_s * abs(row_speed(row.rows.cone_axis, a, b));
  return row.cone_impulse > 0.0f || row.cone - row.rows.cone_axis.error < room + way;
}

/// Whether a limit pushes already or could be reached soon (joint_bounds.hpp).
template <int D>
static bool limit_is_near(const JointRow<D>& row, const Motion<D>& a, const Motion<D>& b) {
  if (!row.limit_enabled) return false;
  if (row.lower_impulse > 0.0f || row.upper_impulse > 0.0f) return true;
  const float coordinate = row.rows.axis.error;
  const float reach = kLimitRoom + row.limit_reach_s * abs(row_speed(row.rows.axis, a, b));
  return coordinate - row.lower < reach || row.upper - coordinate < reach ||
         cone_is_near(kLimitRoom, row, a, b);
}

template <int D>
void evaluate_rows(const WorldState<D>& state, Wide time_s, const Motion<D>& a, const Motion<D>& b,
                   JointRow<D>& row) {
  const Body<D>& body_a = state.bodies[row.body_a];
  const Body<D>& body_b = state.bodies[row.body_b];
  const JointFrame<D> frame =
      make_frame(state, state.joints[row.joint], body_a.position + a.delta_position,
                 row.centre_offset + (b.delta_position - a.delta_position),
                 compose(a.delta_rotation, body_a.rotation),
                 compose(b.delta_rotation, body_b.rotation), static_cast<float>(time_s));
  row.rows.clear();
  // A user's function may count on rows of zeros.
  if (frame.joint.kind == JointKind::kUser) row.rows.rows.fill(Row<D>{});
  write_rows(row.rows_function, frame, row.rows);
  for (int i = row.rows.count; i < JointRow<D>::kRows; ++i) row.impulse[i] = 0.0f;
  factor_block(0, row.rows.split, row, row.blocks[0]);
  factor_block(row.rows.split, row.rows.count, row, row.blocks[1]);
  if (row.has_held_spring) hold_other_block(row);
  row.limit_near = row.rows.has_axis && limit_is_near(row, a, b);
  if (!drives_act(row)) return;
  row.axis = hold_block(row, row.rows.axis);
  row.motor = row.rows.has_motor_axis ? hold_block(row, row.rows.motor_axis) : row.axis;
  if (row.limit_near) hold_cone(row);
}

template void evaluate_rows(const WorldState<2>&, Wide, const Motion<2>&, const Motion<2>&,
                            JointRow<2>&);
template void evaluate_rows(const WorldState<3>&, Wide, const Motion<3>&, const Motion<3>&,
                            JointRow<3>&);

}  // namespace cycloid::solver
