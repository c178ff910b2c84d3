#include "solver/constraints/contact_lanes.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// The masses of bodies whose inertia has turned, and what their contacts' rows make of them. Lane
/// by lane, so that a contact does not see which others share its block.
template <int D, int W>
static void follow_inertia(const StepScratch<D>& scratch, ContactBlock<D, W>& block) {
  float turned[kLaneCount<W>] = {};
  bool any = false;
  for (int lane = 0; lane < kLaneCount<W>; ++lane) {
    const std::uint32_t a = block.body_a[lane];
    const std::uint32_t b = block.body_b[lane];
    if (scratch.inertia_turned[a] == 0 && scratch.inertia_turned[b] == 0) continue;
    set_mass(block.mass_a, lane, scratch.masses[a]);
    set_mass(block.mass_b, lane, scratch.masses[b]);
    turned[lane] = 1.0f;
    any = true;
  }
  if (any) ContactKernels<D, W>::weigh(turned, block);
}

/// Normal, arms and separation of pairs of balls at the present poses, and effective masses of what
/// spins fast: wherever positions have moved.
///
/// Reads motions and masses; writes blocks, each its own, so any split into ranges gives the same
/// bits. Says that positions have moved: the sweep that comes next places the arms.
template <int D, int W>
void evaluate_contacts(Lot& lot, Workers& workers, StepScratch<D>& scratch) {
  ++lot.poses;
  constexpr bool kInertiaTurns = Dim<D>::kSpin > 1;
  if (!lot.follows && !kInertiaTurns) return;
  for_all_blocks<D, W>(lot, workers, scratch, [&](const BlockRange<D, W>& blocks) {
    if (lot.follows) ContactKernels<D, W>::follow(blocks);
    if (!kInertiaTurns) return;
    for (ContactBlock<D, W>* block = blocks.begin; block != blocks.end; ++block)
      if (block->turns) follow_inertia(scratch, *block);
  });
}

template <int D, int W>
struct InstantiateEvaluate {
  decltype(&evaluate_contacts<D, W>) evaluate = &evaluate_contacts<D, W>;
};
template struct AtEveryWidth<InstantiateEvaluate>;

}  // namespace cycloid::solver
