#include <algorithm>

#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// A blow crosses this many contacts against the order of a sweep, and any number along it.
static constexpr int kBounceSweeps = 4;

/// Collisions of this substep, two bodies at a time, before anything is held: e = 1 keeps energy.
///
/// Reads masses, arms, deltas and velocities with this substep's gravity in them; writes velocities
/// and bounce impulses. Colour after colour (for_each_by_color). Nothing where no material bounces.
template <int D, int W>
void bounce_contacts(const StepContext<D>& context, const Lot& lot, Workers& workers,
                     StepScratch<D>& scratch) {
  if (!lot.bounces) return;
  for_all_blocks<D, W>(lot, workers, scratch, [](const BlockRange<D, W>& blocks) {
    ContactKernels<D, W>::forget_bounces(blocks);
  });
  for (int sweep = 0; sweep < kBounceSweeps; ++sweep) {
    Tally bounces;
    for_each_block_range<D, W>(lot, workers, scratch, [&](const BlockRange<D, W>& blocks) {
      ContactKernels<D, W>::bounce(context, blocks);
      if (std::any_of(blocks.begin, blocks.end, [](const auto& block) { return block.bounced; }))
        bounces.add(1);
    });
    // Where nothing has bounced, the next sweep would see the same velocities.
    if (bounces.sum() == 0) return;
  }
}

template <int D, int W>
struct InstantiateBounce {
  decltype(&bounce_contacts<D, W>) bounce = &bounce_contacts<D, W>;
};
template struct AtEveryWidth<InstantiateBounce>;

}  // namespace cycloid::solver
