#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// How far a body may turn in one of fewer substeps, rad: at twice as much a chain of 50,000:1 that
/// swings parts nearly twice as far, and without a bound it faults in every other run.
static constexpr float kTurn_rad = 0.025f;

/// Whether islands that are solved at once have all that moves, and no sweep acts on any.
template <int D>
static bool islands_have_all(const StepScratch<D>& scratch) {
  const IslandSolver<D>& solver = scratch.islands_solved;
  if (!solver.acts || !solver.only_thin) return false;
  int taken = 0;
  for (const auto& island : solver.islands) {
    if (!island.taken || island.swept) return false;
    taken += island.bodies;
  }
  for (const JointRow<D>& row : scratch.joint_rows)
    if (!row.in_island) return false;
  int awake = 0;
  for (const std::uint32_t slot : scratch.awake_bodies)
    if (scratch.masses[slot].inverse_mass > 0.0f) ++awake;
  return awake == taken;
}

template <int D>
static bool all_turn_little(float h, const StepScratch<D>& scratch) {
  for (const std::uint32_t slot : scratch.awake_bodies)
    if (h * length(scratch.motions[slot].spin) > kTurn_rad) return false;
  return true;
}

template <int D, int W>
void rescale_impulses(float scale, StepScratch<D>& scratch) {
  using L = Lanes<W>;
  for (ContactBlock<D, W>& block : std::get<ContactBlocks<D, W>>(scratch.contact_blocks).blocks)
    for (auto& point : block.points) {
      point.normal_impulse = L(scale) * point.normal_impulse;
      for (L& impulse : point.tangent_impulse) impulse = L(scale) * impulse;
    }
  for (JointRow<D>& row : scratch.joint_rows)
    for (float& impulse : row.impulse) impulse *= scale;
}

/// Substeps are there for the sweeps, whose errors shrink with their square. What is solved at once
/// needs them only to follow how it turns. So where it is all that moves, and nothing turns fast,
/// half as many do.
///
/// Reads which islands are taken, spins and damping; writes the damping of a substep and the
/// impulses that it begins with. @returns the context of the substeps. Serial.
template <int D, int W>
StepContext<D> choose_substeps(const StepContext<D>& context, const WorldState<D>& state,
                               StepScratch<D>& scratch) {
  const std::uint32_t substeps = context.tuning.substeps;
  bool& has_all = scratch.islands_solved.has_all;
  has_all = substeps >= 4 && substeps % 2 == 0 && islands_have_all(scratch) &&
            all_turn_little(2.0f * context.h, scratch);
  if (!has_all) return context;
  Tuning tuning = context.tuning;
  tuning.substeps = substeps / 2;
  const StepContext<D> halved = make_step_context(context.tick_s, context.gravity, tuning);
  dampen_bodies(halved, state, scratch);
  rescale_impulses<D, W>(2.0f, scratch);
  return halved;
}

template <int D, int W>
struct InstantiateSubsteps {
  decltype(&choose_substeps<D, W>) choose = &choose_substeps<D, W>;
  decltype(&rescale_impulses<D, W>) rescale = &rescale_impulses<D, W>;
};
template struct AtEveryWidth<InstantiateSubsteps>;

}  // namespace cycloid::solver
