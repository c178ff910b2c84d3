#include "solver/constraints/joint_solve.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// One non-linear Gauss-Seidel sweep on positions: joints, then contacts, each row with its error
/// and Jacobian where the bodies are now. Velocities are not touched, so no energy is put in.
///
/// Reads masses, arms and joints; writes deltas. Colour after colour (for_each_by_color).
template <int D, int W>
void correct_positions(const StepContext<D>& context, const WorldState<D>& state, Wide time_s,
                       const Lot& lot, Workers& workers, StepScratch<D>& scratch) {
  const std::span<Motion<D>> motions = scratch.motions;
  for_each_by_color(scratch.joint_coloring, workers, [&](int i) {
    JointRow<D>& row = scratch.joint_rows[static_cast<std::size_t>(i)];
    Motion<D> a = motions[row.body_a];
    Motion<D> b = motions[row.body_b];
    evaluate_rows(state, time_s, a, b, row);
    correct_joint(context, row, a, b);
    write_back(row, a, b, motions);
  });
  for_each_block_range<D, W>(lot, workers, scratch, [&](const BlockRange<D, W>& blocks) {
    ContactKernels<D, W>::correct(context, blocks);
  });
}

template <int D, int W>
struct InstantiateCorrect {
  decltype(&correct_positions<D, W>) correct = &correct_positions<D, W>;
};
template struct AtEveryWidth<InstantiateCorrect>;

}  // namespace cycloid::solver
