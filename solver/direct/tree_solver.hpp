#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "solver/dim.hpp"
#include "solver/direct/dense.hpp"
#include "solver/motion.hpp"

namespace cycloid::solver {

/// Equality rows of one joint, all solved together. Jacobian rows: Cdot = J_a [v_a; w_a] + J_b
/// [v_b; w_b], velocities in the world frame, m/s and rad/s.
template <int D>
struct JointBlock {
  static constexpr int kFreedoms = D + Dim<D>::kSpin;
  std::uint32_t body_a;  ///< Slot; a slot that has no mass record is ground.
  std::uint32_t body_b;
  int rows;                         ///< 1..kFreedoms
  float j_a[kFreedoms][kFreedoms];  ///< [row][freedom], linear then angular.
  float j_b[kFreedoms][kFreedoms];
  float softness[kFreedoms];  ///< >= 0, compliance of the row: 1/kg or 1/(kg m^2); 0 is rigid.
};

/// Solves the equality rows of joints whose graph is a forest, all at once and in O(joints).
///
/// It factors the sparse system [[M, -J^T], [-J, -S]] over body and joint nodes from the leaves of
/// each tree to its root, which fills in nothing. The blocks that arise at bodies are their masses
/// plus what hangs below them (articulated inertias). So the mass of a heavy body at the end of a
/// light chain is added to the masses of the links, where J M^-1 J^T adds its inverse to theirs and
/// loses it to rounding.
///
/// A joint to ground is the root of its tree. Further ones end in leaves whose block is 0; those
/// get a compliance of `kSupport` of their own diagonal, and the refinement of `solve` takes its
/// effect out again. Trees without ground are rooted at their heaviest body: with 1e5 kg at the end
/// of 10 links of 1 kg, impulses then err by 1e-6, and by 8e-5 with the root at the other end,
/// before refinement.
///
/// Source: Baraff, "Linear-Time Dynamics using Lagrange Multipliers" (SIGGRAPH 1996).
template <int D>
class TreeSolver {
 public:
  static constexpr int kFreedoms = JointBlock<D>::kFreedoms;

  /// Sorts the joints into a forest: in index order, a joint that would close a loop, or that has
  /// no moving body, is left out. `masses` is by body slot; bodies of inverse mass 0 are ground,
  /// through which no loop closes. The forest depends on indices and on which bodies move; the
  /// root of a tree without ground also on the masses. Keeps its memory from call to call.
  void analyse(std::span<const JointBlock<D>> joints, std::span<const BodyMass<D>> masses);

  /// Whether `analyse` took the joint of this index into a tree.
  bool in_tree(int joint) const { return in_tree_[static_cast<std::size_t>(joint)] != 0; }

  /// Factors the current Jacobians, softness and masses of the joints that `analyse` saw, which
  /// must join the same bodies. An angular freedom whose inverse inertia is 0 does not move.
  /// Rows that depend on others of their tree get a tiny compliance instead of a zero pivot.
  void factor(std::span<const JointBlock<D>> joints, std::span<const BodyMass<D>> masses);

  /// Impulses `lambda` [N s, N m s] with J M^-1 J^T lambda + S lambda = rhs for all tree joints at
  /// once; `rhs` is the wanted change of J v. Both hold kFreedoms floats per joint; what is not a
  /// row of a tree joint is neither read nor, in `lambda`, left other than 0. Precondition:
  /// `factor`.
  ///
  /// v + M^-1 J^T lambda misses the goal by the rounding of lambda, which is 6e-8 times the mass
  /// ratio: 1e-2 of g h for 1e5 kg on links of 1 kg. `velocity_change` does not have this error;
  /// nor does a second solve for what the first one missed.
  void solve(std::span<const float> rhs, std::span<float> lambda);

  /// M^-1 J^T lambda of the last solve for this freedom (linear, then angular) of a body slot, m/s
  /// or rad/s. It fulfils the rows better than one computed from the rounded impulses.
  float velocity_change(std::uint32_t body, int freedom) const;

  /// Blocks handled by all calls so far: a measure of work that is the same on every machine.
  std::uint64_t operations() const { return operations_; }

 private:
  struct BodyNode {
    float mass[kFreedoms][kFreedoms];
    float articulated[kFreedoms][kFreedoms];  ///< Mass and what hangs below.
    float least[kFreedoms];                   ///< Pivots of `mass`: bounds of the articulated ones.
    SmallFactor<kFreedoms> factor;
    float residual[kFreedoms];  ///< Momentum that is still missing, N s.
    float load[kFreedoms];
    float change[kFreedoms];
    float velocity[kFreedoms];
  };
  /// One elimination: the child body, then the joint between it and its parent.
  struct Step {
    std::uint32_t joint;   ///< kNone at a root body.
    std::uint32_t child;   ///< Node; kNone where it is ground.
    std::uint32_t parent;  ///< Node; kNone where it is ground.
    int rows;
    float child_rows[kFreedoms][kFreedoms];  ///< Jacobian rows: [row][freedom].
    float parent_rows[kFreedoms][kFreedoms];
    float softness[kFreedoms];
    float scale[kFreedoms];  ///< Diagonal of J M^-1 J^T.
    SmallFactor<kFreedoms> factor;
    float residual[kFreedoms];  ///< Velocity that is still missing, m/s.
    float load[kFreedoms];
    float change[kFreedoms];
    float impulse[kFreedoms];
  };
  /// A joint and the slots it joins.
  struct Edge {
    std::uint32_t joint;
    std::uint32_t child;
    std::uint32_t parent;
  };

  void find_forest(std::span<const JointBlock<D>> joints, std::span<const BodyMass<D>> masses);
  void list_neighbors(std::span<const JointBlock<D>> joints, std::span<const BodyMass<D>> masses);
  void choose_roots(std::span<const JointBlock<D>> joints, std::span<const BodyMass<D>> masses);
  void walk(Edge root, std::span<const JointBlock<D>> joints, std::span<const BodyMass<D>> masses);
  void load_joint(Step& step, const JointBlock<D>& joint, std::span<const BodyMass<D>> masses);
  void eliminate(Step& step);
  void substitute();
  void update_residuals(std::span<const float> rhs);

  std::vector<std::uint8_t> in_tree_;          ///< By joint.
  std::vector<std::uint32_t> tree_;            ///< By slot: union-find, then the lowest slot.
  std::vector<std::uint32_t> first_neighbor_;  ///< By slot, into `neighbors_`.
  std::vector<std::uint32_t> neighbors_;       ///< Tree joints of each slot, in index order.
  std::vector<std::uint32_t> root_joint_;      ///< By lowest slot of the tree.
  std::vector<std::uint32_t> root_body_;       ///< By lowest slot of the tree.
  std::vector<std::uint32_t> node_of_;         ///< By slot.
  std::vector<std::uint32_t> slot_of_;         ///< By node.
  std::vector<Edge> stack_;
  std::vector<BodyNode> nodes_;
  std::vector<Step> steps_;  ///< From the leaves to the roots.
  std::uint64_t operations_ = 0;
};

}  // namespace cycloid::solver
