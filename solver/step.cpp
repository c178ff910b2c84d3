#include "solver/events.hpp"
#include "solver/stages/stages.hpp"
#include "solver/world.hpp"

namespace cycloid::solver {

/// A tick, read aloud. The only place that knows the order of the stages.
template <int D, int W>
static void solve_tick(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                       StepScratch<D>& scratch) {
  color(state, scratch);
  prepare_bodies(state, workers, scratch);
  prepare_joints(context, state, scratch);
  prepare_contacts<D, W>(context, state, workers, scratch);

  const Tuning& tuning = context.tuning;
  for (std::uint32_t substep = 0; substep < tuning.substeps; ++substep) {
    integrate_velocities(context, state, workers, scratch);
    warm_start_constraints<D, W>(workers, scratch);
    for (std::uint32_t sweep = 0; sweep < tuning.sweeps; ++sweep)
      solve_constraints<D, W>(context, Sweep::kBiased, workers, scratch);
    integrate_positions(context, state, workers, scratch);
    for (std::uint32_t sweep = 0; sweep < tuning.relax_sweeps; ++sweep)
      solve_constraints<D, W>(context, Sweep::kRelax, workers, scratch);
  }
  apply_restitution<D, W>(context, workers, scratch);
  store_impulses<D, W>(workers, scratch);
}

template <int D>
static void solve_in_lanes(int lanes, const StepContext<D>& context, const WorldState<D>& state,
                           Workers& workers, StepScratch<D>& scratch) {
  switch (lanes) {
    case 1:
      return solve_tick<D, 1>(context, state, workers, scratch);
    case 8:
      return solve_tick<D, 8>(context, state, workers, scratch);
    case 16:
      return solve_tick<D, 16>(context, state, workers, scratch);
    default:
      return solve_tick<D, 4>(context, state, workers, scratch);
  }
}

template <int D>
static Statistics statistics_of(const WorldState<D>& state, const StepScratch<D>& scratch) {
  Statistics statistics;
  statistics.bodies = static_cast<std::uint32_t>(state.bodies.size() - state.free_bodies.size());
  statistics.pairs = static_cast<std::uint32_t>(scratch.pairs.size());
  statistics.contacts = static_cast<std::uint32_t>(state.contacts.size());
  statistics.colors = static_cast<std::uint32_t>(scratch.contact_coloring.colors.size());
  for (const Contact<D>& contact : state.contacts)
    statistics.rows_per_sweep += contact.point_count * (1 + Dim<D>::kTangents);
  for (const JointRow<D>& row : scratch.joint_rows) {
    statistics.rows_per_sweep += row.kind == JointKind::kDistance ? 1 : D;
    statistics.rows_per_sweep += (row.motor_enabled ? 1 : 0) + (row.limit_enabled ? 2 : 0);
  }
  const Tuning& tuning = state.header.tuning;
  statistics.rows = std::uint64_t{statistics.rows_per_sweep} * tuning.substeps *
                    (tuning.sweeps + tuning.relax_sweeps);
  return statistics;
}

template <int D>
Error World<D>::step() {
  if (state_.header.fault.field != kFaultNone) return {Code::kFaulted, "step"};
  const StepContext<D> context =
      make_step_context(state_.header.tick_s, state_.header.gravity, state_.header.tuning);
  StepScratch<D>& scratch = *scratch_;
  find_pairs(context, state_, *workers_, scratch);
  collide_pairs(context, state_, *workers_, scratch);
  if (scratch.contacts.size() > state_.header.limits.contacts) {
    state_.header.fault = {state_.header.tick + 1, {kNone, 0}, kFaultContacts};
    return {Code::kFaulted, "limits.contacts"};
  }
  solve_in_lanes(lanes_, context, state_, *workers_, scratch);
  if (const Fault fault = find_fault(state_, scratch); fault.field != kFaultNone) {
    state_.header.fault = fault;
    return {Code::kFaulted, fault_field_name(fault.field), static_cast<int>(fault.body.index)};
  }
  events_.swap(ended_);
  ended_.clear();
  append_contact_events(state_, scratch.contacts, events_);
  finalize(scratch, state_);
  statistics_ = statistics_of(state_, scratch);
  return {};
}

template Error World<2>::step();
template Error World<3>::step();

}  // namespace cycloid::solver
