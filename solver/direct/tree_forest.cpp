#include <algorithm>

#include "solver/direct/tree_solver.hpp"
#include "solver/union_find.hpp"

namespace cycloid::solver {

template <int D>
static bool moves(std::span<const BodyMass<D>> masses, std::uint32_t slot) {
  return slot < masses.size() && masses[slot].inverse_mass > 0.0f;
}

template <int D>
void TreeSolver<D>::find_forest(std::span<const JointBlock<D>> joints,
                                std::span<const BodyMass<D>> masses) {
  in_tree_.assign(joints.size(), 0);
  tree_.resize(masses.size());
  for (std::uint32_t slot = 0; slot < masses.size(); ++slot) tree_[slot] = slot;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const bool moves_a = moves(masses, joints[i].body_a);
    const bool moves_b = moves(masses, joints[i].body_b);
    in_tree_[i] = moves_a || moves_b;
    if (!moves_a || !moves_b) continue;
    const std::uint32_t tree_a = root_of(tree_, joints[i].body_a);
    const std::uint32_t tree_b = root_of(tree_, joints[i].body_b);
    in_tree_[i] = tree_a != tree_b;
    tree_[std::max(tree_a, tree_b)] = std::min(tree_a, tree_b);
  }
  for (std::uint32_t slot = 0; slot < masses.size(); ++slot) tree_[slot] = root_of(tree_, slot);
}

template <int D>
void TreeSolver<D>::list_neighbors(std::span<const JointBlock<D>> joints,
                                   std::span<const BodyMass<D>> masses) {
  // Counts, then sums up to the end of each slot's list, then fills the lists from their ends.
  first_neighbor_.assign(masses.size() + 1, 0);
  for (std::size_t i = 0; i < joints.size(); ++i)
    for (const std::uint32_t slot : {joints[i].body_a, joints[i].body_b})
      if (in_tree_[i] && moves(masses, slot)) ++first_neighbor_[slot];
  for (std::size_t slot = 1; slot < first_neighbor_.size(); ++slot)
    first_neighbor_[slot] += first_neighbor_[slot - 1];
  neighbors_.resize(first_neighbor_.back());
  for (std::size_t i = joints.size(); i-- > 0;)
    for (const std::uint32_t slot : {joints[i].body_a, joints[i].body_b})
      if (in_tree_[i] && moves(masses, slot))
        neighbors_[--first_neighbor_[slot]] = static_cast<std::uint32_t>(i);
}

template <int D>
void TreeSolver<D>::choose_roots(std::span<const JointBlock<D>> joints,
                                 std::span<const BodyMass<D>> masses) {
  root_joint_.assign(masses.size(), kNone);
  root_body_.assign(masses.size(), kNone);
  for (std::uint32_t slot = 0; slot < masses.size(); ++slot) {
    if (first_neighbor_[slot] == first_neighbor_[slot + 1]) continue;
    std::uint32_t& root = root_body_[tree_[slot]];
    if (root == kNone || masses[slot].inverse_mass < masses[root].inverse_mass) root = slot;
  }
  for (std::size_t i = joints.size(); i-- > 0;) {
    const bool moves_a = moves(masses, joints[i].body_a);
    if (!in_tree_[i] || moves_a == moves(masses, joints[i].body_b)) continue;
    const std::uint32_t slot = moves_a ? joints[i].body_a : joints[i].body_b;
    root_joint_[tree_[slot]] = static_cast<std::uint32_t>(i);
    root_body_[tree_[slot]] = slot;
  }
}

/// Appends the steps of one tree from its root to its leaves, siblings from the last joint to the
/// first, so that the reverse goes from the leaves to the root and siblings in index order.
template <int D>
void TreeSolver<D>::walk(Edge root, std::span<const JointBlock<D>> joints,
                         std::span<const BodyMass<D>> masses) {
  stack_.assign(1, root);
  while (!stack_.empty()) {
    const Edge edge = stack_.back();
    stack_.pop_back();
    Step& step = steps_.emplace_back();
    step.joint = edge.joint;
    step.child = edge.child == kNone ? kNone : node_of_[edge.child];
    step.parent = edge.parent == kNone ? kNone : node_of_[edge.parent];
    if (edge.child == kNone) continue;
    for (std::uint32_t n = first_neighbor_[edge.child]; n < first_neighbor_[edge.child + 1]; ++n) {
      const std::uint32_t joint = neighbors_[n];
      if (joint == edge.joint) continue;
      const JointBlock<D>& block = joints[joint];
      const std::uint32_t other = block.body_a == edge.child ? block.body_b : block.body_a;
      stack_.push_back({joint, moves(masses, other) ? other : kNone, edge.child});
    }
  }
}

template <int D>
void TreeSolver<D>::analyse(std::span<const JointBlock<D>> joints,
                            std::span<const BodyMass<D>> masses) {
  find_forest(joints, masses);
  list_neighbors(joints, masses);
  choose_roots(joints, masses);
  node_of_.assign(masses.size(), kNone);
  slot_of_.clear();
  for (std::uint32_t slot = 0; slot < masses.size(); ++slot) {
    if (first_neighbor_[slot] == first_neighbor_[slot + 1]) continue;
    node_of_[slot] = static_cast<std::uint32_t>(slot_of_.size());
    slot_of_.push_back(slot);
  }
  nodes_.resize(slot_of_.size());
  steps_.clear();
  for (std::uint32_t slot = 0; slot < masses.size(); ++slot)
    if (root_body_[slot] != kNone)
      walk({root_joint_[slot], root_body_[slot], kNone}, joints, masses);
  std::reverse(steps_.begin(), steps_.end());
}

template void TreeSolver<2>::analyse(std::span<const JointBlock<2>>, std::span<const BodyMass<2>>);
template void TreeSolver<3>::analyse(std::span<const JointBlock<3>>, std::span<const BodyMass<3>>);

}  // namespace cycloid::solver
