#pragma once

#include <span>

#include "solver/collision/collide.hpp"
#include "solver/constraints/contact_kernels.hpp"
#include "solver/constraints/pin_kernels.hpp"
#include "solver/stages/by_color.hpp"
#include "solver/step_context.hpp"
#include "solver/step_scratch.hpp"

namespace cycloid::solver {

struct Statistics;

/// The stages of a step, in the order in which `step.cpp` calls them. Each reads and writes what
/// its comment in stages/*.cpp says, and nothing else; docs/architecture.md has the table.

template <int D>
bool move_boxes(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                StepScratch<D>& scratch);
template <int D>
void cut_candidates(const Workers& workers, StepScratch<D>& scratch);
/// @param shapes  More than any slot.
template <int D>
void merge_candidates(std::uint32_t shapes, Workers& workers, StepScratch<D>& scratch);
template <int D>
void wake_candidates(StepScratch<D>& scratch);
template <int D>
void lay_candidates_to_rest(PairCache<D>& cache);
template <int D>
bool find_pairs(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                StepScratch<D>& scratch);
template <int D>
void collide_pairs(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                   StepScratch<D>& scratch);
template <int D>
void wake_islands(const StepContext<D>& context, const WorldState<D>& state,
                  StepScratch<D>& scratch);
template <int D>
void color(const WorldState<D>& state, Workers& workers, StepScratch<D>& scratch);
/// Lists constraints colour after colour, and those of kColorsMax as overflow.
void sort_by_color(const Colors& colors, Coloring& coloring);
template <int D>
void divide_into_lots(const StepContext<D>& context, const WorldState<D>& state,
                      StepScratch<D>& scratch);
template <int D>
void part_flying(const StepContext<D>& context, const WorldState<D>& state,
                 StepScratch<D>& scratch);
template <int D>
void prepare_bodies(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                    StepScratch<D>& scratch);
/// The part of prepare_bodies that depends on the length of a substep, of all but who flies.
template <int D>
void dampen_bodies(const StepContext<D>& context, const WorldState<D>& state,
                   StepScratch<D>& scratch);
template <int D>
void prepare_joints(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                    StepScratch<D>& scratch);
template <int D>
void prepare_pins(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                  StepScratch<D>& scratch);
template <int D, int W>
void join_loaded_lots(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                      StepScratch<D>& scratch);
template <int D, int W>
Lot lay_out_contacts(Workers& workers, StepScratch<D>& scratch);
/// Gives a lot the memory for blocks that belongs to whoever has taken that seat.
template <int D, int W>
void seat_lot(int seat, const Workers& workers, const StepScratch<D>& scratch, Lot& lot);
template <int D, int W>
void prepare_contacts(const StepContext<D>& context, const WorldState<D>& state, Lot& lot,
                      Workers& workers, StepScratch<D>& scratch);

template <int D>
void integrate_velocities(const StepContext<D>& context, const Lot& lot, Workers& workers,
                          StepScratch<D>& scratch);
template <int D, int W>
void evaluate_contacts(Lot& lot, Workers& workers, StepScratch<D>& scratch);
template <int D, int W>
void bounce_contacts(const StepContext<D>& context, const Lot& lot, Workers& workers,
                     StepScratch<D>& scratch);
template <int D>
void evaluate_joints(const StepContext<D>& context, const WorldState<D>& state, Wide time_s,
                     Workers& workers, StepScratch<D>& scratch);
template <int D>
void factor_trees(const StepContext<D>& context, StepScratch<D>& scratch);
template <int D>
void solve_trees(const StepContext<D>& context, Sweep sweep, StepScratch<D>& scratch);
/// What contacts are looked at for load, as prepare_contacts completes them.
template <int D>
LoadBounds load_bounds(const StepContext<D>& context);
template <int D, int W>
void find_loaded(const StepContext<D>& context, Workers& workers, StepScratch<D>& scratch);
template <int D, int W>
void group_islands(const StepContext<D>& context, Workers& workers, StepScratch<D>& scratch);
/// Leaves to the sweeps what is no load yet, but a blow: wanted islands of contacts alone whose
/// bodies move beside one another, that come down on ground, or touch none. Their contacts are
/// rigid: so they stop what comes down, and overlap leaves them as it does springs. Solved at once,
/// a blow would stay in the impulses that the next substep starts from, and heaps of unequal masses
/// would throw their lighter bodies about (docs/stability.md).
///
/// Reads islands, motions and blocks; writes which islands land, and so are not wanted, and which
/// lanes of blocks. Serial, in the order of the slots and of the colouring. @returns whether any is
/// still wanted.
/// @pre islands are found, and blocks hold no landing lanes of another tick.
template <int D, int W>
bool find_landing(StepScratch<D>& scratch);
template <int D, int W>
void prepare_islands(const StepContext<D>& context, Workers& workers, StepScratch<D>& scratch);
template <int D, int W>
StepContext<D> choose_substeps(const StepContext<D>& context, const WorldState<D>& state,
                               StepScratch<D>& scratch);
/// From those of substeps of one length to those of another, `scale` times as long: what holds
/// bodies up is a force. Of what islands at once hold alone.
template <int D, int W>
void rescale_impulses(float scale, StepScratch<D>& scratch);
template <int D>
void watch_islands(StepScratch<D>& scratch);
template <int D, int W>
void weigh_guesses(const StepContext<D>& context, const Lot& lot, Workers& workers,
                   StepScratch<D>& scratch);
template <int D, int W>
void solve_islands(const StepContext<D>& context, const Lot& lot, Workers& workers,
                   StepScratch<D>& scratch);
template <int D>
void correct_islands(const StepContext<D>& context, StepScratch<D>& scratch);
template <int D, int W>
void warm_start_constraints(const StepContext<D>& context, const Lot& lot, Workers& workers,
                            StepScratch<D>& scratch);
template <int D, int W>
void solve_constraints(const StepContext<D>& context, Sweep sweep, const Lot& lot, Workers& workers,
                       StepScratch<D>& scratch);
template <int D>
void integrate_positions(const StepContext<D>& context, const WorldState<D>& state, const Lot& lot,
                         Workers& workers, StepScratch<D>& scratch);
template <int D>
void fly_bodies(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                StepScratch<D>& scratch);

template <int D, int W>
void solve_pseudo_velocities(const StepContext<D>& context, const Lot& lot, Workers& workers,
                             StepScratch<D>& scratch);
template <int D, int W>
void correct_positions(const StepContext<D>& context, const WorldState<D>& state, Wide time_s,
                       const Lot& lot, Workers& workers, StepScratch<D>& scratch);
template <int D, int W>
void project_positions(const StepContext<D>& context, const WorldState<D>& state, Wide time_s,
                       Lot& lot, Workers& workers, StepScratch<D>& scratch);

template <int D, int W>
void store_impulses(const Lot& lot, Workers& workers, StepScratch<D>& scratch);
template <int D>
void store_pins(Workers& workers, StepScratch<D>& scratch);
template <int D>
void list_fast_bodies(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                      StepScratch<D>& scratch);
template <int D>
void list_meetings(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                   StepScratch<D>& scratch);
template <int D>
void spread_stops(const StepContext<D>& context, const WorldState<D>& state,
                  StepScratch<D>& scratch);
template <int D>
void stop_fast_bodies(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                      StepScratch<D>& scratch);
/// The first body that would leave the bounds, or a fault with field kFaultNone.
template <int D>
Fault find_fault(const WorldState<D>& state, Workers& workers, const StepScratch<D>& scratch);
template <int D>
void finalize(Workers& workers, StepScratch<D>& scratch, WorldState<D>& state);
template <int D>
void rest_islands(const StepContext<D>& context, Workers& workers, StepScratch<D>& scratch,
                  WorldState<D>& state);
template <int D>
Statistics count_work(const WorldState<D>& state, Workers& workers, const StepScratch<D>& scratch);

/// Ranges of this many bodies, joints or islands go to one thread at a time; of pairs, kPairGrain;
/// blocks go colour by colour (by_color.hpp).
inline constexpr int kBodyGrain = 256;
inline constexpr int kJointGrain = 32;
inline constexpr int kIslandGrain = 16;
/// Of what is only looked at, copied or cleared, so many.
inline constexpr int kLookGrain = 1024;

/// Runs `run(index)` for every constraint: for_each_range_by_color.
template <class Run>
void for_each_by_color(const Coloring& coloring, Workers& workers, Run&& run) {
  for_each_range_by_color(coloring.colors, coloring.overflow, workers, [&](Range range) {
    for (int i = range.begin; i < range.end; ++i) run(i);
  });
}

/// What a kernel of pins works on. @pre the blocks of the range share no body that moves.
template <int D, int W>
PinRange<D, W> pin_range(StepScratch<D>& scratch, Range range) {
  PinBlock<D, W>* blocks = std::get<PinBlocks<D, W>>(scratch.pins.blocks).blocks.data();
  return {blocks + range.begin, blocks + range.end, scratch.motions.data()};
}

/// The colours of the blocks of pins; none where there are no pins.
template <int D>
std::span<const Range> colors_of(const Pins<D>& pins) {
  std::span<const Range> colors;
  with_blocks(pins, [&]<int W>(const PinBlocks<D, W>& blocks) { colors = blocks.colors; });
  return colors;
}

/// The joints colour after colour: `on_pins` for ranges of blocks of pins, `on_row` for every other
/// row; inside a colour in parallel, as for_each_by_color.
template <int D, class OnPins, class OnRow>
void for_each_joint_by_color(Workers& workers, StepScratch<D>& scratch, OnPins&& on_pins,
                             OnRow&& on_row) {
  if (scratch.joint_rows.empty()) return;
  const Coloring& single = scratch.single_rows;
  const std::span<const Range> of_pins = colors_of(scratch.pins);
  const auto pins_of = [&](std::size_t color) {
    return of_pins.empty() ? Range{} : of_pins[color];
  };
  const auto run_pins = [&](Range blocks) {
    with_blocks(scratch.pins,
                [&]<int W>(PinBlocks<D, W>&) { on_pins(pin_range<D, W>(scratch, blocks)); });
  };
  const auto run_row = [&](int i) {
    const int place = single.order[static_cast<std::size_t>(i)];
    on_row(scratch.joint_rows[static_cast<std::size_t>(place)]);
  };
  const auto run_rows = [&](Range rows) {
    for (int i = rows.begin; i < rows.end; ++i) run_row(i);
  };
  auto run_by_color = [&](Member& member) {
    ColorOrder order(member);
    for (std::size_t color = 0; color < single.colors.size(); ++color) {
      order.begin_color(is_shared(pins_of(color)) || is_shared(single.colors[color]));
      run_part(member, pins_of(color), run_pins);
      run_part(member, single.colors[color], run_rows);
    }
    run_overflow(member, single.overflow, order, run_row);
  };
  if (is_any_shared(of_pins, workers) || is_any_shared(single.colors, workers))
    return workers.together(run_by_color);
  Member alone;
  run_by_color(alone);
}

/// What blocks of contacts are filled from. @pre prepare_bodies.
template <int D>
ContactInputs<D> contact_inputs(const StepContext<D>& context, const WorldState<D>& state,
                                const StepScratch<D>& scratch) {
  return {scratch.live.data(), scratch.contacts.data(), scratch.masses.data(),
          static_cast<std::uint32_t>(state.bodies.size()), context.tuning.warm_starting};
}

/// What a kernel of contacts works on. @pre the blocks of the range share no body that moves.
template <int D, int W>
BlockRange<D, W> block_range(const Lot& lot, StepScratch<D>& scratch, Range range) {
  ContactBlock<D, W>* blocks = std::get<ContactBlocks<D, W>>(scratch.contact_blocks).blocks.data();
  return {blocks + (range.begin - lot.blocks_before), blocks + (range.end - lot.blocks_before),
          scratch.motions.data(), lot.poses, scratch.slides_far};
}

/// The colours of a lot's blocks.
template <int D, int W>
std::span<const Range> colors_of(const Lot& lot, const ContactBlocks<D, W>& contacts) {
  return std::span(contacts.colors)
      .subspan(static_cast<std::size_t>(lot.colors.begin),
               static_cast<std::size_t>(lot.colors.end - lot.colors.begin));
}

/// Runs `run(BlockRange)` for the contacts of a lot: for_each_range_by_color.
template <int D, int W, class Run>
void for_each_block_range(const Lot& lot, Workers& workers, StepScratch<D>& scratch, Run&& run) {
  const auto& contacts = std::get<ContactBlocks<D, W>>(scratch.contact_blocks);
  for_each_range_by_color(colors_of(lot, contacts), lot.overflow, workers,
                          [&](Range range) { run(block_range<D, W>(lot, scratch, range)); });
}

/// Runs `run(BlockRange)` for all blocks of a lot at once, whatever their colour:
/// for_each_part_of_colors.
template <int D, int W, class Run>
void for_all_blocks(const Lot& lot, Workers& workers, StepScratch<D>& scratch, Run&& run) {
  const auto& contacts = std::get<ContactBlocks<D, W>>(scratch.contact_blocks);
  for_each_part_of_colors(colors_of(lot, contacts), lot.overflow, workers,
                          [&](Range range) { run(block_range<D, W>(lot, scratch, range)); });
}

/// The places in moving_bodies of who takes part in substeps: all but who flies.
template <int D>
Range in_substeps(const StepScratch<D>& scratch) {
  return {0, static_cast<int>(scratch.moving_bodies.size()) - scratch.flying};
}

/// Runs `run(range)` for ranges of the places of a lot's bodies in moving_bodies.
template <class Run>
void for_each_body_range(const Lot& lot, Workers& workers, Run&& run) {
  workers.parallel_for(lot.bodies.end - lot.bodies.begin, kBodyGrain, [&](Range range) {
    run(Range{lot.bodies.begin + range.begin, lot.bodies.begin + range.end});
  });
}

}  // namespace cycloid::solver
