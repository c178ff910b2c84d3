#include <algorithm>

#include "solver/bodies/body_kernels.hpp"
#include "solver/lane_widths.hpp"
#include "solver/stages/met_bodies.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// To who looks on, each phase is that of all. And where positions have sweeps or velocities of
/// their own, those pass over every body that moves.
template <int D>
static bool may_part(const StepContext<D>& context, const StepScratch<D>& scratch) {
  const Stabilisation by = context.tuning.stabilisation;
  if (by == Stabilisation::kXpbd || by == Stabilisation::kSplitImpulse) return false;
  return scratch.kept->trace == nullptr && scratch.lots.all.empty();
}

/// Lists those that no contact or joint reads or writes in this tick behind all others, in a world
/// where they are many: where they are few, to look for them takes longer than they save.
///
/// Reads live contacts and joints, lots and who is awake; writes who moves, and how many of them
/// fly. Serial.
template <int D>
void part_flying(const StepContext<D>& context, const WorldState<D>& state,
                 StepScratch<D>& scratch) {
  scratch.flying = 0;
  const std::vector<std::uint32_t>& awake = scratch.awake_bodies;
  const std::size_t pairs = scratch.live.size() + scratch.live_joints.size();
  if (2 * pairs > awake.size() || !may_part(context, scratch)) return;
  std::vector<std::uint8_t>& is_met = scratch.is_met;
  if (is_met.size() < state.bodies.size()) is_met.resize(state.bodies.size(), 0);
  for_each_met_body(state, scratch, [&](std::uint32_t slot) { is_met[slot] = 1; });
  std::vector<std::uint32_t>& moving = scratch.moving_bodies;
  std::size_t met = 0;
  std::size_t last = awake.size();
  for (const std::uint32_t slot : awake) moving[is_met[slot] != 0 ? met++ : --last] = slot;
  for_each_met_body(state, scratch, [&](std::uint32_t slot) { is_met[slot] = 0; });
  scratch.flying = static_cast<int>(awake.size() - met);
}

static void fly_range(const StepContext<2>& context, const WorldState<2>&, Range range,
                      StepScratch<2>& scratch) {
  const auto first = static_cast<std::size_t>(range.begin);
  const int count = range.end - range.begin;
  const auto fly = [&]<int V>() {
    BodyKernels<V>::fly(context.h, static_cast<int>(context.tuning.substeps),
                        scratch.accelerations.data() + first, scratch.moving_bodies.data() + first,
                        count, scratch.motions.data());
  };
  at_width(widest_lanes(context.lanes), [&]<int W>() { in_lanes_that_hold<W>(count, fly); });
}

/// In space a turning inertia changes the acceleration, so the stages take turns, with few bodies.
static void fly_range(const StepContext<3>& context, const WorldState<3>& state, Range range,
                      StepScratch<3>& scratch) {
  constexpr int kFew = 64;
  Workers alone(1);
  Lot lot{};
  for (int begin = range.begin; begin < range.end; begin += kFew) {
    lot.bodies = {begin, std::min(begin + kFew, range.end)};
    for (std::uint32_t substep = 0; substep < context.tuning.substeps; ++substep) {
      integrate_velocities(context, lot, alone, scratch);
      integrate_positions(context, state, lot, alone, scratch);
    }
  }
}

/// The substeps of those that nothing touches or holds, one body after the other, as many as were
/// asked for: integrate_velocities, then integrate_positions, as often as there are substeps. To
/// the bit what these make of all bodies substep after substep.
///
/// Reads accelerations; writes the motions of who flies. Each body its own.
template <int D>
void fly_bodies(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                StepScratch<D>& scratch) {
  const auto count = static_cast<int>(scratch.moving_bodies.size());
  const int first = count - scratch.flying;
  workers.parallel_for(scratch.flying, kBodyGrain, [&](Range range) {
    fly_range(context, state, {first + range.begin, first + range.end}, scratch);
  });
}

template void part_flying(const StepContext<2>&, const WorldState<2>&, StepScratch<2>&);
template void part_flying(const StepContext<3>&, const WorldState<3>&, StepScratch<3>&);
template void fly_bodies(const StepContext<2>&, const WorldState<2>&, Workers&, StepScratch<2>&);
template void fly_bodies(const StepContext<3>&, const WorldState<3>&, Workers&, StepScratch<3>&);

}  // namespace cycloid::solver
