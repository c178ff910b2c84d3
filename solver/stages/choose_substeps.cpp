#include <algorithm>
#include <utility>

#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// How far a body may turn in one of fewer substeps, rad: at twice as much a chain of 50,000:1 that
/// swings parts nearly twice as far, and without a bound it faults in every other run.
static constexpr float kTurn_rad = 0.025f;

/// Of the gap of a joint, what may close in one of fewer substeps. Sweeps must close the slower the
/// longer a substep is; what is solved at once need not, and a chain that did would part by half as
/// much again.
static constexpr float kClosed = 0.75f;

/// Whether islands that are solved at once have all that anything touches or holds, no sweep acts
/// on any, and no joint of theirs has far to close.
template <int D>
static bool islands_have_all(const StepScratch<D>& scratch) {
  const IslandSolver<D>& solver = scratch.islands_solved;
  if (!solver.acts || !solver.only_thin) return false;
  for (const auto& island : solver.islands)
    if (!island.taken || island.swept) return false;
  for (const JointRow<D>& row : scratch.joint_rows)
    if (!row.in_island || row.parted) return false;
  return true;
}

/// Puts what no island has behind all others: `fly_bodies` moves it in the substeps asked for,
/// which costs next to nothing, so it flies the same way whatever becomes of the others. What has
/// no mass stays, for an island may stand on it. @pre islands_have_all.
template <int D>
static void part_from_islands(StepScratch<D>& scratch) {
  const auto flies = [&](std::uint32_t slot) {
    return scratch.masses[slot].inverse_mass > 0.0f && scratch.islands_solved.island_of[slot] < 0;
  };
  std::vector<std::uint32_t>& moving = scratch.moving_bodies;
  std::size_t end = moving.size();
  for (std::size_t place = 0; place < end;) {
    if (!flies(moving[place])) {
      ++place;
      continue;
    }
    std::swap(moving[place], moving[--end]);
    std::swap(scratch.accelerations[place], scratch.accelerations[end]);
  }
  scratch.flying = static_cast<int>(moving.size() - end);
}

/// Whether what flies may come down on joints that are not closed yet.
template <int D>
static bool may_land_on_open_joints(const StepScratch<D>& scratch) {
  if (scratch.flying == 0) return false;
  const auto is_open = [](const JointRow<D>& row) { return row.open; };
  return std::any_of(scratch.joint_rows.begin(), scratch.joint_rows.end(), is_open);
}

/// Whether each island that is solved has joints. Without any it leans on its contacts alone, from
/// which overlap is taken out but once a substep: thirty boxes sink more than twice as far.
template <int D>
static bool joints_in_all(const IslandSolver<D>& solver) {
  for (const auto& island : solver.islands)
    if (island.taken && island.joint_count == 0) return false;
  return true;
}

/// What the fastest turns in `time_s`, rad, of all whose turn a constraint feels. Where joints
/// carry what lies on them, `rolls`, a ball that is touched and not held may turn as it likes: its
/// contacts stay where they are. Without joints a weight would sink into a pebble by twice as much.
template <int D>
static float most_turn(float time_s, bool rolls, const StepScratch<D>& scratch) {
  float fastest = 0.0f;
  const auto take = [&](std::uint32_t slot) {
    const Spin<D> spin = scratch.motions[slot].spin;
    fastest = std::max(fastest, dot(spin, spin));
  };
  for (const JointRow<D>& row : scratch.joint_rows) {
    take(row.body_a);
    take(row.body_b);
  }
  for (const LiveContact<D>& live : scratch.live) {
    if (!rolls || !live.a_is_ball) take(live.body_a);
    if (!rolls || !live.b_is_ball) take(live.body_b);
  }
  return time_s * sqrt(fastest);
}

/// By what the number of substeps is divided: 1, 2 or 4.
template <int D>
static std::uint32_t fewer_by(const StepContext<D>& context, StepScratch<D>& scratch) {
  const std::uint32_t substeps = context.tuning.substeps;
  if (substeps < 4 || substeps % 2 != 0 || !islands_have_all(scratch)) return 1;
  part_from_islands(scratch);
  if (may_land_on_open_joints(scratch)) return 1;
  const bool jointed = joints_in_all(scratch.islands_solved);
  const float turn_rad = most_turn(context.h, jointed, scratch);
  if (jointed && substeps % 4 == 0 && 4.0f * turn_rad <= kTurn_rad) return 4;
  return 2.0f * turn_rad <= kTurn_rad ? 2 : 1;
}

/// The context of substeps of which there are `divisor` times fewer. Joints close as fast as in
/// those asked for.
template <int D>
static StepContext<D> with_fewer(const StepContext<D>& context, std::uint32_t divisor) {
  Tuning tuning = context.tuning;
  tuning.substeps /= divisor;
  StepContext<D> fewer = make_step_context(context.tick_s, context.gravity, tuning);
  fewer.lanes = context.lanes;
  fewer.lot_contacts = context.lot_contacts;
  fewer.joint.bias_rate = min(context.joint.bias_rate, kClosed * fewer.inverse_h);
  return fewer;
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
/// needs them only to follow how it turns. So where it is all that moves but for what flies, and
/// nothing of it turns fast, half as many do, and where joints hold it a quarter.
///
/// Reads which islands are taken, joint rows, live contacts, spins and damping; writes who moves,
/// who of them flies, their accelerations in that order, the damping of a substep and the impulses
/// that it begins with.
/// @returns the context of the substeps. Serial.
template <int D, int W>
StepContext<D> choose_substeps(const StepContext<D>& context, const WorldState<D>& state,
                               StepScratch<D>& scratch) {
  const std::uint32_t divisor = fewer_by(context, scratch);
  scratch.islands_solved.has_all = divisor > 1;
  if (divisor == 1) return context;
  const StepContext<D> fewer = with_fewer(context, divisor);
  dampen_bodies(fewer, state, scratch);
  rescale_impulses<D, W>(static_cast<float>(divisor), scratch);
  return fewer;
}

template <int D, int W>
struct InstantiateSubsteps {
  decltype(&choose_substeps<D, W>) choose = &choose_substeps<D, W>;
  decltype(&rescale_impulses<D, W>) rescale = &rescale_impulses<D, W>;
};
template struct AtEveryWidth<InstantiateSubsteps>;

}  // namespace cycloid::solver
