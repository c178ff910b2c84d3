#include "solver/stages/stages.hpp"

namespace cycloid::solver {

template <int D>
static void exchange_velocities(std::vector<Motion<D>>& a, std::vector<Motion<D>>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::swap(a[i].velocity, b[i].velocity);
    std::swap(a[i].spin, b[i].spin);
  }
}

/// Normal impulses change places with those of the pseudo-velocities, which start at 0.
template <int D, int W>
static void exchange_impulses(std::vector<ContactBlock<D, W>>& blocks) {
  for (ContactBlock<D, W>& block : blocks)
    for (std::uint32_t p = 0; p < block.point_count; ++p)
      std::swap(block.points[p].normal_impulse, block.extra->saved_impulse[p]);
}

template <int D>
static void forget_impulses(std::vector<JointRow<D>>& rows) {
  for (JointRow<D>& row : rows) {
    for (float& impulse : row.impulse) impulse = 0.0f;
    row.lower_impulse = 0.0f;
    row.upper_impulse = 0.0f;
    forget_cone_impulse(row);
  }
}

/// Overlap and joint errors leave through velocities that start at zero, move the bodies in this
/// substep alone and are forgotten: Baumgarte's correction without its energy.
///
/// Reads rows and deltas; leaves the pseudo-velocities in saved_motions for integrate_positions,
/// and velocities and impulses as they were. Colour after colour (solve_constraints). Source:
/// Catto, "Understanding Constraints" (GDC 2014), pseudo-velocities.
template <int D, int W>
void solve_pseudo_velocities(const StepContext<D>& context, const Lot& lot, Workers& workers,
                             StepScratch<D>& scratch) {
  auto& blocks = std::get<ContactBlocks<D, W>>(scratch.contact_blocks).blocks;
  scratch.saved_motions.assign(scratch.motions.size(), Motion<D>{});
  scratch.saved_rows = scratch.joint_rows;
  for (ContactBlock<D, W>& block : blocks)
    for (Lanes<W>& impulse : block.extra->saved_impulse) impulse = Lanes<W>(0.0f);
  exchange_velocities(scratch.motions, scratch.saved_motions);
  exchange_impulses(blocks);
  forget_impulses(scratch.joint_rows);
  for (std::uint32_t sweep = 0; sweep < context.tuning.position_sweeps; ++sweep)
    solve_constraints<D, W>(context, Sweep::kPseudo, lot, workers, scratch);
  exchange_velocities(scratch.motions, scratch.saved_motions);
  exchange_impulses(blocks);
  scratch.joint_rows.swap(scratch.saved_rows);
}

template <int D, int W>
struct InstantiatePseudo {
  decltype(&solve_pseudo_velocities<D, W>) solve = &solve_pseudo_velocities<D, W>;
};
template struct AtEveryWidth<InstantiatePseudo>;

}  // namespace cycloid::solver
