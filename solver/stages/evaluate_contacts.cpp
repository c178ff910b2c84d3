#include "solver/constraints/contact_lanes.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// The masses of bodies whose inertia has turned, and what their contacts' rows make of them. Lane
/// by lane, so that a contact does not see which others share its block.
template <int D, int W>
static void follow_inertia(const StepScratch<D>& scratch, ContactBlock<D, W>& block) {
  Lanes<W> turned(0.0f);
  bool any = false;
  for (int lane = 0; lane < W; ++lane) {
    const std::uint32_t a = block.body_a[static_cast<std::size_t>(lane)];
    const std::uint32_t b = block.body_b[static_cast<std::size_t>(lane)];
    if (scratch.inertia_turned[a] == 0 && scratch.inertia_turned[b] == 0) continue;
    set_mass(block.mass_a, lane, scratch.masses[a]);
    set_mass(block.mass_b, lane, scratch.masses[b]);
    set_lane(turned, lane, 1.0f);
    any = true;
  }
  if (any) set_effective_masses(turned, block);
}

/// Normal, arms and separation of pairs of balls at the present poses, and effective masses of what
/// spins fast: wherever positions have moved.
///
/// Reads motions and masses; writes blocks, each its own, so any split into ranges gives the same
/// bits.
template <int D, int W>
void evaluate_contacts(Workers& workers, StepScratch<D>& scratch) {
  auto& blocks = std::get<ContactBlocks<D, W>>(scratch.contact_blocks).blocks;
  const std::span<const Motion<D>> motions = scratch.motions;
  workers.parallel_for(static_cast<int>(blocks.size()), kBlockGrain, [&](Range range) {
    for (auto i = static_cast<std::size_t>(range.begin); i < static_cast<std::size_t>(range.end);
         ++i) {
      if (blocks[i].follows) follow_round(blocks[i], motions);
      if (blocks[i].turns) follow_inertia(scratch, blocks[i]);
    }
  });
}

template <int D, int W>
struct InstantiateEvaluate {
  static constexpr auto kEvaluate = &evaluate_contacts<D, W>;
};
template struct InstantiateEvaluate<2, 1>;
template struct InstantiateEvaluate<2, 4>;
template struct InstantiateEvaluate<2, 8>;
template struct InstantiateEvaluate<2, 16>;
template struct InstantiateEvaluate<3, 1>;
template struct InstantiateEvaluate<3, 4>;
template struct InstantiateEvaluate<3, 8>;
template struct InstantiateEvaluate<3, 16>;

}  // namespace cycloid::solver
