#include "solver/constraints/joint_solve.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// Runs `act(row, a, b)` on the two bodies of a joint and writes back those that move.
template <int D, class Act>
static void with_bodies(JointRow<D>& row, std::span<Motion<D>> motions, Act&& act) {
  Motion<D> a = motions[row.body_a];
  Motion<D> b = motions[row.body_b];
  act(row, a, b);
  write_back(row, a, b, motions);
}

/// v += M^-1 J^T lambda with the impulses of the substep before: the solution of a world at rest is
/// found again at once.
///
/// Reads the accumulated impulses; writes velocities, which contacts have pushed, and the impulses
/// of joints whose guess would turn a body too far (kGuessTurns_rad). Colour after colour
/// (for_each_by_color).
template <int D, int W>
void warm_start_constraints(const StepContext<D>& context, const Lot& lot, Workers& workers,
                            StepScratch<D>& scratch) {
  const std::span<Motion<D>> motions = scratch.motions;
  for_each_joint_by_color(
      workers, scratch,
      [&]<int P>(const PinRange<D, P>& pins) {
        PinKernels<D, P>::warm_start(context.guess_spin_max, pins);
      },
      [&](JointRow<D>& joint) {
        with_bodies<D>(joint, motions, [&](JointRow<D>& row, Motion<D>& a, Motion<D>& b) {
          warm_start(context.guess_spin_max, row, a, b);
        });
      });
  for_each_block_range<D, W>(lot, workers, scratch, [&](const BlockRange<D, W>& blocks) {
    // Those of the first substep are the last tick's.
    if (!context.is_first) ContactKernels<D, W>::note_pushes(blocks);
    ContactKernels<D, W>::warm_start(blocks);
  });
}

/// One sweep of sequential impulses: joints, then contacts, each colour after colour.
///
/// Reads masses, arms and deltas; writes velocities and accumulated impulses. Inside a colour no
/// two constraints share a body that moves, so neither lanes nor threads change a bit; the order of
/// the colours is that of the ids.
template <int D, int W>
void solve_constraints(const StepContext<D>& context, Sweep sweep, const Lot& lot, Workers& workers,
                       StepScratch<D>& scratch) {
  const std::span<Motion<D>> motions = scratch.motions;
  solve_trees(context, sweep, scratch);
  for_each_joint_by_color(
      workers, scratch,
      [&]<int P>(const PinRange<D, P>& pins) { PinKernels<D, P>::sweep(context, sweep, pins); },
      [&](JointRow<D>& joint) {
        with_bodies<D>(joint, motions, [&](JointRow<D>& row, Motion<D>& a, Motion<D>& b) {
          solve(context, sweep, row, a, b);
        });
      });
  for_each_block_range<D, W>(lot, workers, scratch, [&](const BlockRange<D, W>& blocks) {
    ContactKernels<D, W>::sweep(context, sweep, blocks);
  });
}

/// A row that cannot act keeps the zero it began with, unless another lane makes the block solve
/// it: then it may become -0. Adding +0 makes the two zeros one, so that lanes do not show in the
/// sign.
static float without_sign_of_zero(float impulse) {
  return impulse + 0.0f;
}

template <int D, int W>
static void store_block(const ContactBlock<D, W>& block, std::vector<Contact<D>>& contacts) {
  for (int lane = 0; lane < kLaneCount<W>; ++lane) {
    const std::uint32_t index = block.contact[lane];
    if (index == kNone) continue;
    Contact<D>& contact = contacts[index];
    if ((block.pushed >> lane & 1u) != 0) contact.touching = 1;
    for (std::uint32_t p = 0; p < contact.point_count; ++p) {
      contact.points[p].normal_impulse =
          without_sign_of_zero(block.points[p].normal_impulse.raw[lane]);
      for (int t = 0; t < Dim<D>::kTangents; ++t)
        contact.points[p].tangent_impulse[t] =
            without_sign_of_zero(block.points[p].tangent_impulse[t].raw[lane]);
    }
    for (int i = 0; i < Dim<D>::kSpin; ++i)
      contact.rolling_impulse[i] =
          block.rolls ? without_sign_of_zero(block.extra->rolling_impulse[i].raw[lane]) : 0.0f;
  }
}

/// Reads the blocks; writes the impulses of the new contacts, each of its own, for the next tick's
/// warm start, and that those touch which have pushed.
template <int D, int W>
void store_impulses(const Lot& lot, Workers& workers, StepScratch<D>& scratch) {
  for_all_blocks<D, W>(lot, workers, scratch, [&](const BlockRange<D, W>& blocks) {
    ContactKernels<D, W>::note_pushes(blocks);
    for (const ContactBlock<D, W>* block = blocks.begin; block != blocks.end; ++block)
      store_block(*block, scratch.contacts);
  });
}

template <int D, int W>
struct InstantiateSolving {
  decltype(&warm_start_constraints<D, W>) warm_start = &warm_start_constraints<D, W>;
  decltype(&solve_constraints<D, W>) solve = &solve_constraints<D, W>;
  decltype(&store_impulses<D, W>) store = &store_impulses<D, W>;
};
template struct AtEveryWidth<InstantiateSolving>;

}  // namespace cycloid::solver
