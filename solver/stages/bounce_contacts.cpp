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
  static constexpr auto kBounce = &bounce_contacts<D, W>;
};
template struct InstantiateBounce<2, 1>;
template struct InstantiateBounce<2, 4>;
template struct InstantiateBounce<2, 8>;
template struct InstantiateBounce<2, 16>;
template struct InstantiateBounce<2, kAvx2Lanes>;
template struct InstantiateBounce<2, kAvx512Lanes>;
template struct InstantiateBounce<3, 1>;
template struct InstantiateBounce<3, 4>;
template struct InstantiateBounce<3, 8>;
template struct InstantiateBounce<3, 16>;
template struct InstantiateBounce<3, kAvx2Lanes>;
template struct InstantiateBounce<3, kAvx512Lanes>;

}  // namespace cycloid::solver
