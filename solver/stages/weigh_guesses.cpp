#include <algorithm>

#include "solver/constraints/contact_block.hpp"
#include "solver/constraints/joint_solve.hpp"
#include "solver/constraints/single_lanes.hpp"
#include "solver/mass.hpp"
#include "solver/stages/island_rest.hpp"
#include "solver/stages/island_rows.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// Whether an island's guess is to be weighed: the sweeps have it, and the warm start has set one
/// of its joints going.
template <int D>
static bool is_wild(const StepContext<D>& context, const StepScratch<D>& scratch,
                    const typename IslandSolver<D>::Island& island) {
  const bool is_swept = island.weighed || (island.taken && island.products_left <= 0);
  return is_swept && any_joint_misses(context, scratch, island, kIsWild);
}

/// Into `guess`, by slot, what the warm start has added to the velocities for what islands hold:
/// M^-1 J^T lambda, by the kernels that did so, of bodies at rest.
template <int D, int W>
static void find_guess(const Lot& lot, Workers& workers, StepScratch<D>& scratch) {
  std::vector<Motion<D>>& guess = scratch.islands_solved.guess;
  std::fill(guess.begin(), guess.end(), Motion<D>{});
  for_each_joint_by_color(
      workers, scratch,
      [&]<int P>(PinRange<D, P> pins) {
        pins.motions = guess.data();
        PinKernels<D, P>::warm_start_equalities(pins);
      },
      [&](const JointRow<D>& row) {
        if (!is_held(row)) return;
        Motion<D> a = guess[row.body_a];
        Motion<D> b = guess[row.body_b];
        apply(row, impulse_of_equalities(row), a, b);
        write_back<D>(row, a, b, guess);
      });
  for_each_block_range<D, W>(lot, workers, scratch, [&](BlockRange<D, W> blocks) {
    blocks.motions = guess.data();
    ContactKernels<D, W>::warm_start(blocks);
  });
}

/// Work of an impulse, felt as `linear` and `angular`, on a body that moves: p . v, J.
template <int D>
static Wide work_on(const Motion<D>& motion, const Vec<D>& linear, const Spin<D>& angular) {
  return dot(widened(linear), widened(motion.velocity)) +
         dot(widened(angular), widened(motion.spin));
}

/// What the impulses of a contact do on the body of one side.
template <int D, int W>
static Wide work_of_contact(const ContactBlock<D, W>& block, int lane, bool on_a,
                            const Motion<D>& motion) {
  Wide work = 0.0;
  for (std::uint32_t p = 0; p < block.point_count; ++p) {
    const auto& point = block.points[p];
    const Vec<D> at_start = lane_of(point.r_a, lane);
    const Vec<D> arm =
        on_a ? at_start + lane_of(block.slide_a, lane)
             : (at_start - lane_of(block.between, lane)) + lane_of(block.slide_b, lane);
    Vec<D> push = lane_of(point.normal_impulse, lane) * lane_of(block.normal, lane);
    for (int t = 0; t < Dim<D>::kTangents; ++t)
      push += lane_of(point.tangent_impulse[t], lane) * lane_of(tangent_of(block, t), lane);
    if (on_a) push = -push;
    work += work_on<D>(motion, push, moment(arm, push));
  }
  return work;
}

/// The same of the equalities of a joint.
template <int D>
static Wide work_of_joint(const JointRow<D>& row, bool on_a, const Motion<D>& motion) {
  const PairImpulse<D> sum = impulse_of_equalities(row);
  return on_a ? work_on<D>(motion, sum.linear_a, sum.angular_a)
              : work_on<D>(motion, sum.linear_b, sum.angular_b);
}
template <int D, int W>
static Wide work_of_pin(const PinBlock<D, W>& block, int lane, bool on_a, const Motion<D>& motion) {
  Wide work = 0.0;
  for (int i = 0; i < equalities_of<D>(block.form); ++i) {
    const float impulse = lane_of(block.impulse[i], lane);
    Vec<D> linear = Vec<D>::zero();
    if (i < D) linear = (on_a ? -impulse : impulse) * lane_of(block.direction[i], lane);
    const auto& angular = on_a ? block.angular_a[i] : block.angular_b[i];
    work += work_on<D>(motion, linear, impulse * lane_of(angular, lane));
  }
  return work;
}

/// Calls on_contact(block, lane), on_row(row) or on_pin(block, lane) with what a pair is held by.
template <int D, int W, class OnContact, class OnRow, class OnPin>
static void visit_held(const HeldPair& pair, StepScratch<D>& scratch, OnContact&& on_contact,
                       OnRow&& on_row, OnPin&& on_pin) {
  const auto place = static_cast<std::size_t>(pair.place);
  if (pair.lane >= 0)
    return on_contact(std::get<ContactBlocks<D, W>>(scratch.contact_blocks).blocks[place],
                      pair.lane);
  with_any_blocks(scratch.pins, [&](auto& pins) {
    constexpr int kWidth = std::remove_cvref_t<decltype(pins)>::kWidth;
    const int at = scratch.pins.lane_of[place];
    if (at < 0)
      on_row(scratch.joint_rows[place]);
    else
      on_pin(pins.blocks[static_cast<std::size_t>(at / kWidth)], at % kWidth);
  });
}

/// What a pair's impulses do on the one of its bodies that has no mass, and so is in no sum over
/// bodies, but moves: the ground that somebody rides on.
template <int D, int W>
static Wide work_on_massless(const HeldPair& pair, StepScratch<D>& scratch) {
  const bool on_a = !pair.a_moves;
  if (!on_a && pair.b_moves) return 0.0;
  const Motion<D>& motion = scratch.motions[on_a ? pair.a : pair.b];
  if (!is_moving(motion)) return 0.0;
  Wide work = 0.0;
  visit_held<D, W>(
      pair, scratch,
      [&](const auto& block, int lane) { work = work_of_contact(block, lane, on_a, motion); },
      [&](const JointRow<D>& row) { work = work_of_joint(row, on_a, motion); },
      [&](const auto& block, int lane) { work = work_of_pin(block, lane, on_a, motion); });
  return work;
}

/// Whether any body is such ground.
template <int D>
static bool any_massless_moves(const StepScratch<D>& scratch) {
  for (std::size_t slot = 0; slot < scratch.masses.size(); ++slot)
    if (scratch.masses[slot].inverse_mass == 0.0f && is_moving(scratch.motions[slot])) return true;
  return false;
}

/// How much of an island's guess is worth having, from 0 to 1: with so much of it the energy is
/// least. E(s) = 1/2 (v + (s - 1) dv)^T M (v + (s - 1) dv) with v after the warm start and dv what
/// it added, v relative to what the guess pushes against; so s = 1 - p . v / p . dv, p = M dv.
template <int D, int W>
static Wide share_of_guess(std::size_t island, bool ground_moves, StepScratch<D>& scratch) {
  const IslandSolver<D>& solver = scratch.islands_solved;
  Wide work = 0.0;
  Wide energy = 0.0;
  for (const std::uint32_t slot : solver.slots_of.of(island)) {
    const Motion<D>& guess = solver.guess[slot];
    const BodyMass<D>& mass = scratch.masses[slot];
    const Vec<D> linear = (1.0f / mass.inverse_mass) * guess.velocity;
    const Spin<D> angular = inverse(mass.inverse_inertia) * guess.spin;
    work += work_on<D>(scratch.motions[slot], linear, angular);
    energy += work_on<D>(guess, linear, angular);
  }
  if (!ground_moves) return share_worth_having(work, energy);
  for (const std::uint32_t place : solver.held_of.of(island))
    work += work_on_massless<D, W>(solver.held[place], scratch);
  return share_worth_having(work, energy);
}

template <int D, int W>
static void scale_lane(float share, int lane, ContactBlock<D, W>& block) {
  for (std::uint32_t p = 0; p < block.point_count; ++p) {
    block.points[p].normal_impulse.raw[lane] *= share;
    for (auto& impulse : block.points[p].tangent_impulse) impulse.raw[lane] *= share;
  }
  for (int i = 0; i < Dim<D>::kSpin && block.rolls; ++i)
    block.extra->rolling_impulse[i].raw[lane] *= share;
}

template <int D, int W>
static void scale_lane(float share, int lane, PinBlock<D, W>& block) {
  for (auto& impulse : block.impulse) impulse.raw[lane] *= share;
}

/// Takes the rest of an island's guess back, from velocities and from impulses.
template <int D, int W>
static void keep_share(float share, std::size_t island, StepScratch<D>& scratch) {
  const IslandSolver<D>& solver = scratch.islands_solved;
  for (const std::uint32_t slot : solver.slots_of.of(island)) {
    scratch.motions[slot].velocity += (share - 1.0f) * solver.guess[slot].velocity;
    scratch.motions[slot].spin += (share - 1.0f) * solver.guess[slot].spin;
  }
  const auto scale = [&](auto& block, int lane) { scale_lane(share, lane, block); };
  const auto scale_row = [&](JointRow<D>& row) {
    for (float& impulse : row.impulse) impulse *= share;
  };
  for (const std::uint32_t place : solver.held_of.of(island))
    visit_held<D, W>(solver.held[place], scratch, scale, scale_row, scale);
}

/// Takes back what is not worth having of the guess of islands that the sweeps have, where that
/// sets joints going: it may be of a substep that solved the island at once, of a blow that is
/// over, or of a stress in what lies jammed.
///
/// Reads which pins and joint rows are wild, and masses; writes velocities and impulses of what the
/// island holds. The guess of all islands colour after colour (for_each_by_color), then serially
/// island by island; no row is of two.
template <int D, int W>
void weigh_guesses(const StepContext<D>& context, const Lot& lot, Workers& workers,
                   StepScratch<D>& scratch) {
  IslandSolver<D>& solver = scratch.islands_solved;
  Tally wild;
  workers.parallel_for(static_cast<int>(solver.islands.size()), kIslandGrain, [&](Range range) {
    for (int i = range.begin; i < range.end; ++i) {
      auto& island = solver.islands[static_cast<std::size_t>(i)];
      island.wild = is_wild(context, scratch, island);
      if (island.wild) wild.add(1);
    }
  });
  if (wild.sum() == 0) return;
  sort_by_island(scratch.masses.size(), solver);
  find_guess<D, W>(lot, workers, scratch);
  const bool ground_moves = any_massless_moves(scratch);
  for (std::size_t i = 0; i < solver.islands.size(); ++i) {
    if (!solver.islands[i].wild) continue;
    const Wide share = share_of_guess<D, W>(i, ground_moves, scratch);
    if (share < 1.0) keep_share<D, W>(static_cast<float>(share), i, scratch);
  }
}

template <int D, int W>
struct InstantiateWeighing {
  decltype(&weigh_guesses<D, W>) weigh = &weigh_guesses<D, W>;
};
template struct AtEveryWidth<InstantiateWeighing>;

}  // namespace cycloid::solver
