#pragma once

#include "solver/constraints/contact_fill.hpp"
#include "solver/constraints/contact_kernels.hpp"
#include "solver/constraints/contact_lanes.hpp"
#include "solver/constraints/contact_position.hpp"
#include "solver/constraints/contact_rest.hpp"
#include "solver/constraints/contact_round.hpp"
#include "solver/constraints/restitution.hpp"

namespace cycloid::solver {

/// The text of the kernels, for the files that compile them and no others. A function that is
/// called here is a template on W or always inlined, so that those compiled for one instruction set
/// have names of their own.

/// Velocities of both bodies; also their poses, and from them slides, gaps and the masses of what
/// slid far, where positions have moved since.
template <int D, int W>
[[gnu::always_inline]] inline void gather_pair(const BlockRange<D, W>& range,
                                               ContactBlock<D, W>& block, MotionLanes<D, W>& a,
                                               MotionLanes<D, W>& b) {
  if (block.placed == range.poses) {
    gather_quads<kVelocityQuads<D>>(range.motions, block.body_a, a);
    gather_quads<kVelocityQuads<D>>(range.motions, block.body_b, b);
    return;
  }
  gather_quads<kPoseQuads<D>>(range.motions, block.body_a, a);
  gather_quads<kPoseQuads<D>>(range.motions, block.body_b, b);
  place(block, a, b);
  if (range.slides_far) weigh_where_slid(block);
  block.placed = range.poses;
}

/// gather_pair for what only blocks do that bounce: where it would weigh lanes anew, which must not
/// show whether one of their neighbours bounces, it is left to the sweep that comes next.
template <int D, int W>
[[gnu::always_inline]] inline void gather_to_bounce(const BlockRange<D, W>& range,
                                                    ContactBlock<D, W>& block, MotionLanes<D, W>& a,
                                                    MotionLanes<D, W>& b) {
  if (!range.slides_far) return gather_pair(range, block, a, b);
  a = gather<D, W>(range.motions, block.body_a);
  b = gather<D, W>(range.motions, block.body_b);
  place(block, a, b);
}

template <int D, int W>
[[gnu::always_inline]] inline void scatter_pair(const BlockRange<D, W>& range,
                                                const ContactBlock<D, W>& block,
                                                MotionLanes<D, W>& a, MotionLanes<D, W>& b) {
  scatter(a, block.moves_a, block.body_a, range.motions);
  scatter(b, block.moves_b, block.body_b, range.motions);
}

/// Unused lanes keep their zeros.
template <int D, int W>
[[gnu::always_inline]] inline void share_points(ContactBlock<D, W>& block) {
  using L = Lanes<W>;
  const auto used = block.points[0].normal_mass > L(0.0f);
  const L sum = block.mass_a.inverse_mass + block.mass_b.inverse_mass;
  block.share_b = select(used, block.mass_b.inverse_mass / select(used, sum, L(1.0f)), L(0.0f));
}

template <int D, int W>
void ContactKernels<D, W>::fill(const ContactInputs<D>& in, const int* places, int count,
                                ContactBlock<D, W>& block) {
  fill_block(in, places, count, block);
}

template <int D, int W>
bool ContactKernels<D, W>::any_loaded(const LoadBounds& bounds, const ContactInputs<D>& in,
                                      int begin, int end) {
  bool any = false;
  for (int i = begin; i < end && !any; i += kLaneCount<W>)
    any = any_loaded_from<D, W>(bounds, in, i, end);
  return any;
}

template <int D, int W>
void ContactKernels<D, W>::complete(const LoadBounds& bounds, const BlockRange<D, W>& range) {
  for (ContactBlock<D, W>* block = range.begin; block != range.end; ++block) {
    share_points(*block);
    block->friction = sqrt(block->friction);
    set_tangents(*block);
    set_first_masses(Lanes<W>(1.0f), *block);
    if (bounds.asked) find_load(bounds, *block);
  }
}

template <int D, int W>
void ContactKernels<D, W>::follow(const BlockRange<D, W>& range) {
  for (ContactBlock<D, W>* block = range.begin; block != range.end; ++block)
    if (block->follows) follow_round(*block, range.motions);
}

template <int D, int W>
void ContactKernels<D, W>::weigh(const float (&wanted)[kLaneCount<W>], ContactBlock<D, W>& block) {
  set_first_masses(Lanes<W>::load(wanted), block);
}

template <int D, int W>
void ContactKernels<D, W>::forget_bounces(const BlockRange<D, W>& range) {
  for (ContactBlock<D, W>* block = range.begin; block != range.end; ++block)
    for (std::uint32_t i = 0; i < block->point_count && block->bounces; ++i)
      block->extra->bounce_impulse[i] = Lanes<W>(0.0f);
}

template <int D, int W>
void ContactKernels<D, W>::bounce(const StepContext<D>& context, const BlockRange<D, W>& range) {
  for (ContactBlock<D, W>* block = range.begin; block != range.end; ++block) {
    block->bounced = false;
    if (!block->bounces) continue;
    MotionLanes<D, W> a;
    MotionLanes<D, W> b;
    gather_to_bounce(range, *block, a, b);
    block->bounced = bounce_points(context, *block, a, b);
    if (block->bounced) scatter_pair(range, *block, a, b);
  }
}

template <int D, int W>
void ContactKernels<D, W>::note_pushes(const BlockRange<D, W>& range) {
  for (ContactBlock<D, W>* block = range.begin; block != range.end; ++block)
    for (std::uint32_t i = 0; i < block->point_count; ++i)
      block->pushed |= lanes_above_zero(block->points[i].normal_impulse);
}

template <int D, int W>
void ContactKernels<D, W>::warm_start(const BlockRange<D, W>& range) {
  for (ContactBlock<D, W>* block = range.begin; block != range.end; ++block) {
    MotionLanes<D, W> a;
    MotionLanes<D, W> b;
    gather_pair(range, *block, a, b);
    if constexpr (kRowsAlong<D>)
      warm_start_along(*block, a, b);
    else
      warm_start_points(*block, a, b);
    if (block->rolls) turn_pair(block->extra->rolling_impulse, *block, a, b);
    scatter_pair(range, *block, a, b);
  }
}

/// What a sweep has of a block at hand: the motions of its bodies.
template <int D, int W>
struct SweptMotions {
  MotionLanes<D, W> a;
  MotionLanes<D, W> b;
  SoftnessLanes<W> soft;
};

/// The rows of plain blocks, one after the other in each block.
/// @param each  As of sweep_plain.
template <Sweep kSweep, int D, int W, class Each>
[[gnu::always_inline]] inline void sweep_rows(const StepContext<D>& context, const Each& each) {
  using Block = ContactBlock<D, W>;
  using Motions = SweptMotions<D, W>;
  std::uint32_t points = 0;
  each([&](Block & block, Motions&) __attribute__((always_inline)) {
    points = points < block.point_count ? block.point_count : points;
  });
  for (std::uint32_t i = 0; i < points; ++i) {
    const std::uint32_t p = point_in_turn(context, kSweep, i, points);
    each([&](Block & block, Motions & m) __attribute__((always_inline)) {
      if (p < block.point_count)
        solve_normal(context, kSweep, block, m.soft, block.points[p], m.a, m.b);
    });
  }
  for (std::uint32_t i = 0; i < points; ++i)
    each([&](Block & block, Motions & m) __attribute__((always_inline)) {
      if (block.rubs && i < block.point_count) solve_friction(context, block, i, m.a, m.b);
    });
}

/// Blocks of the plain rows: each point's normal, then each point's friction. In turn: each row
/// waits for the one before it in its own block, and blocks of one colour share no body that moves,
/// so the rows of one fill the time that those of the other wait.
/// @param each  Calls what it is given for each of the blocks and its motions.
template <Sweep kSweep, int D, int W, class Each>
[[gnu::always_inline]] inline void sweep_plain(const StepContext<D>& context,
                                               const BlockRange<D, W>& range, const Each& each) {
  using Block = ContactBlock<D, W>;
  using Motions = SweptMotions<D, W>;
  each([&](Block & block, Motions & m) __attribute__((always_inline)) {
    gather_pair(range, block, m.a, m.b);
    if (kSweep == Sweep::kBiased) m.soft = softness_of(context, block);
  });
  if constexpr (kRowsAlong<D>) {
    each([&](Block & block, Motions & m) __attribute__((always_inline)) {
      solve_normals_along(context, kSweep, block, m.soft, m.a, m.b);
    });
    each([&](Block & block, Motions & m) __attribute__((always_inline)) {
      if (block.rubs) solve_frictions_along(context, block, m.a, m.b);
    });
  } else {
    sweep_rows<kSweep, D, W>(context, each);
  }
  each([&](Block & block, Motions & m)
           __attribute__((always_inline)) { scatter_pair(range, block, m.a, m.b); });
}

template <Sweep kSweep, int D, int W>
[[gnu::always_inline]] inline void sweep_one(const StepContext<D>& context,
                                             const BlockRange<D, W>& range,
                                             ContactBlock<D, W>& block) {
  SweptMotions<D, W> motions;
  sweep_plain<kSweep>(
      context, range, [&](const auto& act) __attribute__((always_inline)) { act(block, motions); });
}

/// What stands in an array passes through memory in every row; but in space the rows of two blocks
/// have more numbers than there are registers, and more text than the caches of a core like.
template <Sweep kSweep, int D, int W>
[[gnu::always_inline]] inline void sweep_two(const StepContext<D>& context,
                                             const BlockRange<D, W>& range,
                                             ContactBlock<D, W>* blocks) {
  if constexpr (kVelocityQuads<D> == 1) {
    SweptMotions<D, W> first;
    SweptMotions<D, W> second;
    sweep_plain<kSweep>(
        context, range, [&](const auto& act) __attribute__((always_inline)) {
          act(blocks[0], first);
          act(blocks[1], second);
        });
  } else {
    SweptMotions<D, W> both[2];
    sweep_plain<kSweep>(
        context, range, [&](const auto& act) __attribute__((always_inline)) {
          for (int k = 0; k < 2; ++k) act(blocks[k], both[k]);
        });
  }
}

/// Every other block. Apart, because its calls would keep the motions of all blocks in memory.
template <int D, int W>
[[gnu::noinline]] void sweep_any(const StepContext<D>& context, Sweep kind,
                                 const BlockRange<D, W>& range, ContactBlock<D, W>& block) {
  MotionLanes<D, W> a;
  MotionLanes<D, W> b;
  gather_pair(range, block, a, b);
  solve_block(context, kind, block, a, b);
  scatter_pair(range, block, a, b);
}

/// Blocks of which some lanes are settled.
template <int D, int W>
[[gnu::noinline]] void sweep_partly(const StepContext<D>& context, const BlockRange<D, W>& range,
                                    ContactBlock<D, W>& block) {
  MotionLanes<D, W> a;
  MotionLanes<D, W> b;
  gather_pair(range, block, a, b);
  sweep_unsettled(context, block, a, b);
  scatter(a, block.moves_a & ~block.settled, block.body_a, range.motions);
  scatter(b, block.moves_b & ~block.settled, block.body_b, range.motions);
}

template <int D, int W>
void ContactKernels<D, W>::look_for_rest(const StepContext<D>& context, const RestBounds& bounds,
                                         const BlockRange<D, W>& range) {
  for (ContactBlock<D, W>* block = range.begin; block != range.end; ++block) {
    if (block->taken == 0) continue;
    MotionLanes<D, W> a;
    MotionLanes<D, W> b;
    gather_pair(range, *block, a, b);
    find_rest(context, bounds, a, b, *block);
  }
}

template <Sweep kSweep, int D, int W>
void sweep_blocks(const StepContext<D>& context, const BlockRange<D, W>& range) {
  const ContactBlockRows together = context.tuning.contact_block;
  const bool apart = together == ContactBlockRows::kNone || together >= ContactBlockRows::kIsland;
  const bool plain = kSweep != Sweep::kPseudo && apart;
  const auto is_plain = [&](const ContactBlock<D, W>* block) {
    return block != range.end && plain && !block->rolls &&
           (kSweep != Sweep::kBiased || block->settled == 0);
  };
  for (ContactBlock<D, W>* block = range.begin; block != range.end; ++block) {
    if (is_plain(block)) {
      if (is_plain(block + 1)) {
        sweep_two<kSweep>(context, range, block);
        ++block;
      } else {
        sweep_one<kSweep>(context, range, *block);
      }
    } else if (kSweep != Sweep::kBiased || block->settled == 0) {
      sweep_any(context, kSweep, range, *block);
    } else if (block->settled != kAllLanes<W>) {
      sweep_partly(context, range, *block);
    }
  }
}

template <int D, int W>
void ContactKernels<D, W>::sweep(const StepContext<D>& context, Sweep kind,
                                 const BlockRange<D, W>& range) {
  switch (kind) {
    case Sweep::kBiased:
      return sweep_blocks<Sweep::kBiased>(context, range);
    case Sweep::kRelax:
      return sweep_blocks<Sweep::kRelax>(context, range);
    case Sweep::kPseudo:
      return sweep_blocks<Sweep::kPseudo>(context, range);
  }
}

template <int D, int W>
void ContactKernels<D, W>::correct(const StepContext<D>& context, const BlockRange<D, W>& range) {
  for (ContactBlock<D, W>* block = range.begin; block != range.end; ++block)
    correct_contact(context, *block, range.motions);
}

template <int D, int W>
void ContactKernels<D, W>::project(const StepContext<D>& context, const Motion<D>* before,
                                   const BlockRange<D, W>& range) {
  for (ContactBlock<D, W>* block = range.begin; block != range.end; ++block)
    project_contact(context, *block, before, range.motions);
}

template <int D, int W>
void ContactKernels<D, W>::rub(const StepContext<D>& context, const BlockRange<D, W>& range) {
  for (ContactBlock<D, W>* block = range.begin; block != range.end; ++block)
    rub_projected_contact(context, *block, range.motions);
}

}  // namespace cycloid::solver
