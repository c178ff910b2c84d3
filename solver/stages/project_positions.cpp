#include "solver/constraints/joint_solve.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// v = (x - x_before) / h,  w = w_predicted + turn / h, where the turn is the projection's alone:
/// of the whole one of a substep a rotation does not know how often it went round, nor in space
/// what it has changed of the spin.
template <int D>
static void take_velocities(const StepContext<D>& context, const WorldState<D>& state,
                            StepScratch<D>& scratch) {
  for (const std::uint32_t i : scratch.awake_bodies) {
    if (state.bodies[i].inverse_mass == 0.0f) continue;
    Motion<D>& motion = scratch.motions[i];
    const Motion<D>& before = scratch.saved_motions[i];
    const Motion<D>& predicted = scratch.predicted_motions[i];
    motion.velocity = context.inverse_h * (motion.delta_position - before.delta_position);
    motion.spin = predicted.spin +
                  context.inverse_h *
                      turn_of(compose(motion.delta_rotation, conjugate(predicted.delta_rotation)));
  }
}

/// Springs and motors act on velocities before positions are predicted; equalities and limits are
/// projected afterwards.
template <int D>
static void drive_joints(const StepContext<D>& context, StepScratch<D>& scratch) {
  for (JointRow<D>& row : scratch.joint_rows) {
    Motion<D> a = scratch.motions[row.body_a];
    Motion<D> b = scratch.motions[row.body_b];
    for (float& impulse : row.impulse) impulse = 0.0f;
    row.spring_impulse = 0.0f;
    row.motor_impulse = 0.0f;
    if (row.rows.has_axis) solve_drives(row, a, b);
    for (int index = 0; index < 2; ++index)
      if (row.is_spring[index]) solve_block(context, Sweep::kBiased, index, row, a, b);
    write_back(row, a, b, std::span<Motion<D>>(scratch.motions));
  }
}

/// A substep of XPBD: predict, project joints and contacts, velocities from displacements, then
/// dynamic friction. Rigid rows have no compliance, so no impulse is carried over.
///
/// Reads masses, arms and joints; writes motions and the points' impulses. Colour after colour.
/// Source: Mueller et al., "Detailed Rigid Body Simulation with XPBD" (SCA 2020). We deviate:
/// springs and motors stay velocity rows, an overlap leaves at push_speed_max at most, and spins
/// are those predicted plus what the projection has turned.
template <int D, int W>
void project_positions(const StepContext<D>& context, const WorldState<D>& state, Wide time_s,
                       Lot& lot, Workers& workers, StepScratch<D>& scratch) {
  const std::span<Motion<D>> motions = scratch.motions;
  integrate_velocities(context, lot, workers, scratch);
  evaluate_contacts<D, W>(lot, workers, scratch);
  bounce_contacts<D, W>(context, lot, workers, scratch);
  evaluate_joints(context, state, time_s, workers, scratch);
  drive_joints(context, scratch);
  scratch.saved_motions = scratch.motions;
  integrate_positions(context, state, lot, workers, scratch);
  scratch.predicted_motions = scratch.motions;
  const std::uint32_t sweeps = context.tuning.position_sweeps;
  for (std::uint32_t sweep = 0; sweep < sweeps; ++sweep) {
    for_each_by_color(scratch.joint_coloring, workers, [&](int i) {
      JointRow<D>& row = scratch.joint_rows[static_cast<std::size_t>(i)];
      Motion<D> a = motions[row.body_a];
      Motion<D> b = motions[row.body_b];
      evaluate_rows(state, time_s, a, b, row);
      correct_joint(context, row, a, b);
      write_back(row, a, b, motions);
    });
    for_each_block_range<D, W>(lot, workers, scratch, [&](const BlockRange<D, W>& blocks) {
      ContactKernels<D, W>::project(context, scratch.saved_motions.data(), blocks);
    });
  }
  take_velocities(context, state, scratch);
  for_each_block_range<D, W>(lot, workers, scratch, [&](const BlockRange<D, W>& blocks) {
    ContactKernels<D, W>::rub(context, blocks);
  });
}

template <int D, int W>
struct InstantiateProject {
  decltype(&project_positions<D, W>) project = &project_positions<D, W>;
};
template struct AtEveryWidth<InstantiateProject>;

}  // namespace cycloid::solver
