#include <algorithm>

#include "solver/events.hpp"
#include "solver/floating_point_mode.hpp"
#include "solver/lane_widths.hpp"
#include "solver/stages/active_contacts.hpp"
#include "solver/stages/stages.hpp"
#include "solver/step_memory.hpp"
#include "solver/tracing/tracer.hpp"
#include "solver/validate.hpp"
#include "solver/world.hpp"

namespace cycloid::solver {

/// All that depends on where the bodies are now, and on the time.
template <int D, int W>
static void evaluate(const StepContext<D>& context, const WorldState<D>& state, Wide time_s,
                     Lot& lot, Workers& workers, StepScratch<D>& scratch) {
  evaluate_contacts<D, W>(lot, workers, scratch);
  evaluate_joints(context, state, time_s, workers, scratch);
  factor_trees(context, scratch);
}

/// The velocity methods: impulses first, then positions by velocities, then what the method does
/// about the errors that are left. @pre rows are those of the present poses; so they are after it.
template <int D, int W>
static void solve_substep(const StepContext<D>& context, const WorldState<D>& state, Wide time_s,
                          const Tracer<D>& traced, Lot& lot, Workers& workers,
                          StepScratch<D>& scratch) {
  const Tuning& tuning = context.tuning;
  watch_islands(scratch);
  integrate_velocities(context, lot, workers, scratch);
  traced(Phase::kVelocities);
  bounce_contacts<D, W>(context, lot, workers, scratch);
  traced(Phase::kBounce);
  warm_start_constraints<D, W>(context, lot, workers, scratch);
  traced(Phase::kWarmStart);
  solve_islands<D, W>(context, lot, workers, scratch);
  for (std::uint32_t sweep = 0; sweep < tuning.sweeps; ++sweep) {
    solve_constraints<D, W>(context, Sweep::kBiased, lot, workers, scratch);
    traced(Phase::kSweep, sweep);
  }
  if (tuning.stabilisation == Stabilisation::kSplitImpulse) {
    solve_pseudo_velocities<D, W>(context, lot, workers, scratch);
    traced(Phase::kPseudo);
  }
  correct_islands(context, scratch);
  integrate_positions(context, state, lot, workers, scratch);
  traced(Phase::kPositions);
  if (tuning.stabilisation == Stabilisation::kNgs) {
    for (std::uint32_t sweep = 0; sweep < tuning.position_sweeps; ++sweep) {
      correct_positions<D, W>(context, state, time_s, lot, workers, scratch);
      traced(Phase::kCorrect, sweep);
    }
  }
  evaluate<D, W>(context, state, time_s, lot, workers, scratch);
  traced(Phase::kEvaluate);
  for (std::uint32_t sweep = 0; sweep < tuning.relax_sweeps; ++sweep) {
    solve_constraints<D, W>(context, Sweep::kRelax, lot, workers, scratch);
    traced(Phase::kRelax, sweep);
  }
}

template <int D, int W>
static void solve_substeps(const StepContext<D>& context, const WorldState<D>& state,
                           Tracer<D> traced, Lot& lot, Workers& workers, StepScratch<D>& scratch) {
  // Signed, because 32-bit x86 turns large unsigned numbers into floats by x87 additions.
  const auto tick = static_cast<std::int64_t>(state.header.tick);
  const Wide start_s = static_cast<Wide>(tick) * static_cast<Wide>(context.tick_s);
  if (context.tuning.stabilisation != Stabilisation::kXpbd) {
    evaluate<D, W>(context, state, start_s, lot, workers, scratch);
    traced(Phase::kEvaluate);
  }
  StepContext<D> now = context;
  for (std::uint32_t substep = 0; substep < context.tuning.substeps; ++substep) {
    now.is_first = substep == 0;
    // Islands that have all take back what leans; in one order they stay at rest for longer.
    now.odd = (tick + substep) % 2 != 0;
    const Wide time_s = start_s + static_cast<Wide>(substep + 1) * static_cast<Wide>(context.h);
    traced.substep = substep;
    if (context.tuning.stabilisation == Stabilisation::kXpbd) {
      project_positions<D, W>(now, state, time_s, lot, workers, scratch);
      traced(Phase::kProject);
    } else {
      solve_substep<D, W>(now, state, time_s, traced, lot, workers, scratch);
    }
  }
}

/// All substeps, then impulses into the contacts. @param tick_h  s, of the substeps asked for.
/// @pre prepare_contacts.
template <int D, int W>
static void solve_lot(float tick_h, const StepContext<D>& context, const WorldState<D>& state,
                      const Tracer<D>& traced, Lot& lot, Workers& workers,
                      StepScratch<D>& scratch) {
  solve_substeps<D, W>(context, state, traced, lot, workers, scratch);
  store_pins(workers, scratch);
  if (context.h != tick_h) rescale_impulses<D, W>(tick_h / context.h, scratch);
  store_impulses<D, W>(lot, workers, scratch);
}

/// Lot after lot, each by one thread, in that thread's part of the memory of blocks.
template <int D, int W>
static void solve_lots(const StepContext<D>& context, const WorldState<D>& state,
                       const Tracer<D>& traced, Workers& workers, StepScratch<D>& scratch) {
  std::vector<Lot>& lots = scratch.lots.all;
  Seats seats;
  workers.parallel_for(static_cast<int>(lots.size()), 1, [&](Range range) {
    Workers alone(1);
    const int seat = seats.take();
    for (int i = range.begin; i < range.end; ++i) {
      Lot& lot = lots[static_cast<std::size_t>(i)];
      seat_lot<D, W>(seat, workers, scratch, lot);
      prepare_contacts<D, W>(context, state, lot, alone, scratch);
      solve_lot<D, W>(context.h, context, state, traced, lot, alone, scratch);
    }
    seats.give_back(seat);
  });
}

/// From the blocks of contacts on, in lanes of width W.
template <int D, int W>
static void solve_contacts(const StepContext<D>& context, const WorldState<D>& state,
                           Workers& workers, StepScratch<D>& scratch) {
  const Tracer<D> traced{state, scratch, &read_blocks<D, W>};
  // To who looks on, each phase is that of all.
  if (scratch.kept->trace != nullptr) scratch.lots.all.clear();
  join_loaded_lots<D, W>(context, state, workers, scratch);
  Lot whole = lay_out_contacts<D, W>(workers, scratch);
  const bool divided = !scratch.lots.all.empty();
  if (!divided) prepare_contacts<D, W>(context, state, whole, workers, scratch);
  prepare_islands<D, W>(context, workers, scratch);
  const StepContext<D> paced = choose_substeps<D, W>(context, state, scratch);
  scratch.substeps = paced.tuning.substeps;
  whole.bodies = in_substeps(scratch);
  prepare_pins(paced, state, workers, scratch);
  traced(Phase::kPrepare);
  if (divided)
    solve_lots<D, W>(paced, state, traced, workers, scratch);
  else
    solve_lot<D, W>(context.h, paced, state, traced, whole, workers, scratch);
  traced(Phase::kStore);
  fly_bodies(context, state, workers, scratch);
  stop_fast_bodies(context, state, workers, scratch);
  traced(Phase::kStop);
}

/// How many blocks of `width` contacts the colouring fills.
static int blocks_of(const Coloring& coloring, int width) {
  int blocks = 0;
  for (const Range& color : coloring.colors)
    blocks += (color.end - color.begin + width - 1) / width;
  return blocks;
}

template <int D>
static void solve_in_lanes(const StepContext<D>& context, const WorldState<D>& state,
                           Workers& workers, StepScratch<D>& scratch) {
  const auto blocks = [&](int width) { return blocks_of(scratch.contact_coloring, width); };
  const int width = context.lanes == 0 ? width_that_saves(blocks) : in_best_set(context.lanes);
  at_width(width, [&]<int W>() { solve_contacts<D, W>(context, state, workers, scratch); });
}

/// What follows once the contacts are known, read aloud. With World::step the only place that knows
/// the order of the stages.
template <int D>
static void solve_tick(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                       StepScratch<D>& scratch) {
  const Tracer<D> traced{state, scratch};
  wake_islands(context, state, scratch);
  traced(Phase::kIslands);
  color(state, workers, scratch);
  divide_into_lots(context, state, scratch);
  part_flying(context, state, scratch);
  traced(Phase::kColors);
  prepare_bodies(context, state, workers, scratch);
  prepare_joints(context, state, workers, scratch);
  solve_in_lanes(context, state, workers, scratch);
}

/// Particles move last, among bodies where the tick has left them. False where one leaves the
/// bounds.
template <int D>
static bool particles_moved(const StepContext<D>& context, StepScratch<D>& scratch,
                            WorldState<D>& state) {
  const Tuning& tuning = context.tuning;
  move_particles(context.tick_s, context.gravity,
                 {tuning.particle_substeps, tuning.particle_sweeps, tuning.particle_damping}, state,
                 std::span<Particle<D>>(state.particles), std::span<const Link>(state.links),
                 std::span<const Pin<D>>(state.pins), scratch.particles);
  for (const Particle<D>& particle : state.particles)
    if (!within(particle.position, kPositionMax) || !within(particle.velocity, kSpeedMax))
      return false;
  return true;
}

/// Puts the contacts that were apart as the tick began where they belong: those that have pushed
/// began, or went on; the others ended, if they touched in the tick before.
template <int D>
static void list_touches(StepScratch<D>& scratch) {
  for (const ApartContact& one : scratch.apart) {
    const bool touches = scratch.contacts[one.contact].touching != 0;
    const bool touched = one.touched != kNone;
    if (touches && !touched) scratch.began.push_back(one.contact);
    if (!touches && touched) scratch.ended.push_back(one.touched);
  }
  // Total order: each contact is listed once.
  std::sort(scratch.began.begin(), scratch.began.end());
  std::sort(scratch.ended.begin(), scratch.ended.end());
}

/// What has ended and begun, before the contacts of this tick take the place of the last one's; to
/// be told once nothing can undo the tick. @param ended  By calls since the last step.
template <int D>
static void list_events(const WorldState<D>& state, const std::vector<ContactEvent>& ended,
                        StepScratch<D>& scratch) {
  list_touches(scratch);
  scratch.events = ended;
  for (const std::uint32_t contact : scratch.ended)
    scratch.events.push_back(contact_event(state, state.contacts[contact], false));
  for (const std::uint32_t contact : scratch.began)
    scratch.events.push_back(contact_event(state, scratch.contacts[contact], true));
}

template <int D>
Error World<D>::step() {
  if (state_.header.fault.field != kFaultNone) return {Code::kFaulted, "step"};
  const Error error = step_in_lanes();
  const Fault& fault = state_.header.fault;
  const bool of_a_body = fault.field != kFaultNone && fault.body.index != kNone;
  return of_a_body && lanes_ != 1 ? step_in_one_lane() : error;
}

/// Sums that leave what float can hold come to other values in a lane whose neighbours have more
/// points or more rows: 0 times infinity is not 0. So a tick that faults is played again where no
/// lane has a neighbour, or machines would name another body, and their digests differ.
template <int D>
Error World<D>::step_in_one_lane() {
  World single;
  single.state_ = state_;
  single.state_.header.fault = {};
  single.kept_->user_rows = kept_->user_rows;
  single.ended_ = ended_;
  single.lanes_ = 1;
  single.lot_contacts_ = lot_contacts_;
  const Error error = single.step();
  if (error.ok()) {
    restore(single.state_);
    events_ = single.events_;
    statistics_ = single.statistics_;
  } else {
    state_.header.fault = single.state_.header.fault;
  }
  return error;
}

template <int D>
Error World<D>::step_in_lanes() {
  if (!floating_point_mode_is_ieee()) return {Code::kInvalid, "floating_point_mode"};
  for (const Joint<D>& joint : state_.joints)
    if (joint.kind == JointKind::kUser &&
        find_rows_function<D>(kept_->user_rows, joint.user_kind) == nullptr)
      return {Code::kInvalid, "user_kind"};
  StepContext<D> context =
      make_step_context(state_.header.tick_s, state_.header.gravity, state_.header.tuning);
  context.lanes = lanes_;
  context.lot_contacts = lot_contacts_;
  StepLoan<D> loan(*step_memory_, *kept_);
  StepScratch<D>& scratch = loan.scratch();
  const Tracer<D> traced{state_, scratch};
  traced(Phase::kForces);
  const bool paired = find_pairs(context, state_, *workers_, scratch);
  traced(Phase::kPairs);
  if (paired) {
    collide_pairs(context, state_, *workers_, scratch);
    if (is_written(scratch.kept->trace)) take_in_resting(state_, scratch);
    traced(Phase::kCollide);  // Else there is nothing of this tick to look at.
  }
  if (!paired || contact_count(state_, scratch) > state_.header.limits.contacts) {
    state_.header.fault = {state_.header.tick + 1, {kNone, 0}, kFaultContacts};
    return {Code::kFaulted, "limits.contacts"};
  }
  solve_tick(context, state_, *workers_, scratch);
  if (const Fault fault = find_fault(state_, *workers_, scratch); fault.field != kFaultNone) {
    state_.header.fault = fault;
    return {Code::kFaulted, fault_field_name(fault.field), static_cast<int>(fault.body.index)};
  }
  list_events<D>(state_, ended_, scratch);
  if (!state_.particles.empty()) scratch.before = state_;
  finalize(*workers_, scratch, state_);
  traced(Phase::kFinalize);
  rest_islands(context, *workers_, scratch, state_);
  traced(Phase::kRest);
  if (!state_.particles.empty() && !particles_moved(context, scratch, state_)) {
    state_ = scratch.before;
    state_.header.fault = {state_.header.tick + 1, {kNone, 0}, kFaultParticle};
    return {Code::kFaulted, "particle"};
  }
  if (!state_.particles.empty()) traced(Phase::kParticles);
  events_ = scratch.events;
  ended_.clear();
  statistics_ = count_work(state_, *workers_, scratch);
  return {};
}

template Error World<2>::step();
template Error World<3>::step();
template Error World<2>::step_in_lanes();
template Error World<3>::step_in_lanes();
template Error World<2>::step_in_one_lane();
template Error World<3>::step_in_one_lane();

}  // namespace cycloid::solver
