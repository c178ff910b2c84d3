#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// Rigid and unbounded equalities are the tree solver's; what yields stays with the sweeps.
template <int D>
static bool is_rigid(const JointRow<D>& row) {
  return !row.in_island && row.rows.count > 0 && !row.is_spring[0] && !row.is_spring[1];
}

template <int D>
static JointBlock<D> block_of(const JointRow<D>& row) {
  JointBlock<D> block{};
  // Between ground and ground: the tree solver leaves it out.
  if (!is_rigid(row)) return {kNone, kNone, 0, {}, {}, {}};
  block.body_a = row.body_a;
  block.body_b = row.body_b;
  block.rows = row.rows.count;
  for (int r = 0; r < block.rows; ++r) {
    const Row<D>& from = row.rows.rows[static_cast<std::size_t>(r)];
    for (int i = 0; i < D; ++i) {
      block.j_a[r][i] = from.linear_a[i];
      block.j_b[r][i] = from.linear_b[i];
    }
    for (int i = 0; i < Dim<D>::kSpin; ++i) {
      block.j_a[r][D + i] = from.angular_a[i];
      block.j_b[r][D + i] = from.angular_b[i];
    }
  }
  return block;
}

/// Sorts the joints into trees and factors them at the present poses; marks those that it takes.
///
/// Reads joint rows and masses; writes the tree solver and each row's solved_directly. Serial, in
/// the order of the rows.
template <int D>
void factor_trees(const StepContext<D>& context, StepScratch<D>& scratch) {
  if (context.tuning.joint_solver != JointSolver::kDirect) return;
  scratch.tree_blocks.clear();
  for (const JointRow<D>& row : scratch.joint_rows) scratch.tree_blocks.push_back(block_of(row));
  scratch.trees.analyse(scratch.tree_blocks, scratch.masses);
  scratch.trees.factor(scratch.tree_blocks, scratch.masses);
  for (std::size_t i = 0; i < scratch.joint_rows.size(); ++i)
    scratch.joint_rows[i].solved_directly =
        scratch.joint_rows[i].in_island || scratch.trees.in_tree(static_cast<int>(i));
}

/// Every joint of every tree in one solve: lambda += A^-1 (-(Jv + bias C)), exact at any mass
/// ratio.
///
/// Reads joint rows, masses and velocities; writes velocities and impulses. Serial, in the order of
/// the rows.
template <int D>
void solve_trees(const StepContext<D>& context, Sweep sweep, StepScratch<D>& scratch) {
  if (context.tuning.joint_solver != JointSolver::kDirect) return;
  constexpr int kRows = JointRow<D>::kRows;
  const float rate = sweep == Sweep::kRelax    ? 0.0f
                     : sweep == Sweep::kPseudo ? context.pseudo.bias_rate
                                               : context.joint.bias_rate;
  scratch.tree_wanted.assign(scratch.joint_rows.size() * kRows, 0.0f);
  scratch.tree_impulses.resize(scratch.tree_wanted.size());
  for (std::size_t i = 0; i < scratch.joint_rows.size(); ++i) {
    const JointRow<D>& row = scratch.joint_rows[i];
    if (!row.solved_directly || row.in_island) continue;
    for (int r = 0; r < row.rows.count; ++r) {
      const Row<D>& equality = row.rows.rows[static_cast<std::size_t>(r)];
      scratch.tree_wanted[i * kRows + static_cast<std::size_t>(r)] =
          -(row_speed(equality, scratch.motions[row.body_a], scratch.motions[row.body_b]) +
            rate * equality.error);
    }
  }
  scratch.trees.solve(scratch.tree_wanted, scratch.tree_impulses);
  for (std::size_t i = 0; i < scratch.joint_rows.size(); ++i) {
    JointRow<D>& row = scratch.joint_rows[i];
    if (!row.solved_directly || row.in_island) continue;
    for (int r = 0; r < row.rows.count; ++r)
      row.impulse[r] += scratch.tree_impulses[i * kRows + static_cast<std::size_t>(r)];
  }
  // Not from the impulses: those of a heavy tip, rounded, would move its light links by 1e-2 g h.
  for (std::uint32_t body = 0; body + 1 < scratch.motions.size(); ++body) {
    Motion<D>& motion = scratch.motions[body];
    for (int i = 0; i < D; ++i) motion.velocity[i] += scratch.trees.velocity_change(body, i);
    for (int i = 0; i < Dim<D>::kSpin; ++i)
      motion.spin[i] += scratch.trees.velocity_change(body, D + i);
  }
}

template void factor_trees(const StepContext<2>&, StepScratch<2>&);
template void factor_trees(const StepContext<3>&, StepScratch<3>&);
template void solve_trees(const StepContext<2>&, Sweep, StepScratch<2>&);
template void solve_trees(const StepContext<3>&, Sweep, StepScratch<3>&);

}  // namespace cycloid::solver
