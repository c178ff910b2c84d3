#pragma once

#include "solver/constraints/contact_kernels.hpp"
#include "solver/constraints/pin_kernels.hpp"
#include "solver/stages/pin_rows.hpp"
#include "solver/step_scratch.hpp"

namespace cycloid::solver {

/// What an island may miss before it is solved. The impulses of a solve have stopped what moved;
/// as the next warm start they would set it going the other way, so what was just solved is held to
/// twenty times less. So is what sways, to which a solve does no such thing: a stack of thirty that
/// may miss 0.1 mm/s leans until its boxes move at 17 mm/s before it is caught, over and over.
/// Overlap may be left half a millimetre beyond the slop.
inline constexpr RestBounds kRest{4.0e-4f, 2.0e-5f, 1.0e-2f};
/// The same of joints, m/s or rad/s; and what one may miss before its island's guess is looked at
/// for its worth where it is left to the sweeps. Swings of what is solved well miss as much.
inline constexpr JointBounds kJointBounds{kRest.misses, kRest.stirs, 1.0f};

/// One of the bounds on what a joint misses, and what of a block of pins tells which do.
struct JointBound {
  float JointBounds::*bound;
  LaneBits PinRest::*lanes;
};
inline constexpr JointBound kMisses{&JointBounds::misses, &PinRest::misses};
inline constexpr JointBound kStirs{&JointBounds::stirs, &PinRest::stirs};
inline constexpr JointBound kIsWild{&JointBounds::is_wild, &PinRest::is_wild};

/// Whether a rigid row of a joint misses more than the bound, m/s or rad/s.
template <int D>
bool misses(const StepContext<D>& context, const StepScratch<D>& scratch, const JointRow<D>& joint,
            float bound) {
  const Motion<D>& a = scratch.motions[joint.body_a];
  const Motion<D>& b = scratch.motions[joint.body_b];
  for (int r = 0; r < joint.rows.count; ++r) {
    const Row<D>& row = joint.rows.rows[static_cast<std::size_t>(r)];
    if (abs(row_speed(row, a, b) + context.joint.bias_rate * row.error) > bound) return true;
  }
  return false;
}

/// Whether a joint of an island misses more than one of the bounds. @pre pins were looked at.
template <int D>
bool any_joint_misses(const StepContext<D>& context, const StepScratch<D>& scratch,
                      const typename IslandSolver<D>::Island& island, const JointBound& bound) {
  bool any = false;
  for_each_joint(
      scratch.pins, scratch.islands_solved, island.joints, [&](const auto* block, int at, int) {
        if (any) return;
        any = block != nullptr
                  ? (block->rest.*bound.lanes >> at & 1u) != 0
                  : misses(context, scratch, scratch.joint_rows[static_cast<std::size_t>(at)],
                           kJointBounds.*bound.bound);
      });
  return any;
}

}  // namespace cycloid::solver
