#include "solver/constraints/contact.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// Normal, arms and separation of pairs of balls at the present poses: wherever positions have
/// moved.
///
/// Reads motions; writes blocks, each its own, so any split into ranges gives the same bits.
template <int D, int W>
void evaluate_contacts(Workers& workers, StepScratch<D>& scratch) {
  auto& blocks = std::get<ContactBlocks<D, W>>(scratch.contact_blocks).blocks;
  const std::span<const Motion<D>> motions = scratch.motions;
  workers.parallel_for(static_cast<int>(blocks.size()), kBlockGrain, [&](Range range) {
    for (auto i = static_cast<std::size_t>(range.begin); i < static_cast<std::size_t>(range.end);
         ++i)
      if (blocks[i].follows) follow_round(blocks[i], motions);
  });
}

template <int D, int W>
struct Instantiate {
  static constexpr auto kEvaluate = &evaluate_contacts<D, W>;
};
template struct Instantiate<2, 1>;
template struct Instantiate<2, 4>;
template struct Instantiate<2, 8>;
template struct Instantiate<2, 16>;
template struct Instantiate<3, 1>;
template struct Instantiate<3, 4>;
template struct Instantiate<3, 8>;
template struct Instantiate<3, 16>;

}  // namespace cycloid::solver
