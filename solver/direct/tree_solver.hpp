#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "solver/constraints/block.hpp"
#include "solver/dim.hpp"
#include "solver/motion.hpp"

namespace cycloid::solver {

/// The equality rows of one joint, solved together: Cdot = j_a [v_a; w_a] + j_b [v_b; w_b].
template <int D>
struct JointBlock {
  static constexpr int kFreedoms = Dim<D>::kFreedoms;
  std::uint32_t body_a = 0;
  std::uint32_t body_b = 0;
  int rows = 0;                          ///< 0 to kFreedoms; 0: no part of any tree.
  float j_a[kFreedoms][kFreedoms] = {};  ///< [row][freedom], linear freedoms first.
  float j_b[kFreedoms][kFreedoms] = {};
  float compliance = 0.0f;  ///< >= 0, added to every row's diagonal; 0 is rigid.
};

/// Solves J (v + M^-1 J^T lambda) + compliance lambda = wanted for all joints of a forest at once,
/// in O(n), exactly but for rounding at any mass ratio.
///
/// From the leaves to the root each body's mobility W (what an impulse does to its velocity, all
/// that hangs on it included) is found from that of its children:
///   W = M^-1;  for each joint c on it but the one to its parent, in index order:
///   K_c = compliance + J_child W_child J_child^T,  G_c = J_c W J_c^T + K_c,
///   W -= W J_c^T G_c^-1 J_c W.
/// A joint to a body without mass has K_c = compliance alone. Mobilities need no inverse of a mass,
/// so bodies that cannot turn are nothing special, and float32 suffices: with a tip 1e5 times as
/// heavy as the links of its chain one solve leaves 1e-3 of the joint velocity (tests), where the
/// factors of A = J M^-1 J^T have no digit left of the tip. Source: Baraff, "Linear-Time Dynamics
/// using Lagrange Multipliers" (SIGGRAPH 1996), with the eliminations written in mobilities, as
/// Featherstone's articulated bodies are in inertias.
template <int D>
class TreeSolver {
 public:
  using Block = JointBlock<D>;
  static constexpr int kFreedoms = Dim<D>::kFreedoms;

  /// Sorts the joints into a forest: in index order, each joint that does not close a loop. Bodies
  /// without mass are ground and close none. A tree's root is the body of its lowest joint to the
  /// ground, or its lowest slot. A function of indices alone.
  void analyse(std::span<const Block> joints, std::span<const BodyMass<D>> masses);
  /// False for a joint that closes a loop, has no rows or moves no body.
  bool in_tree(int joint) const { return in_tree_[static_cast<std::size_t>(joint)] != 0; }

  /// @pre analysed for these joints; Jacobians and masses may have changed since.
  void factor(std::span<const Block> joints, std::span<const BodyMass<D>> masses);

  /// @param wanted  [kFreedoms x joints] the change of Cdot of each row that is wanted.
  /// @param lambda  the same shape; impulses, 0 for joints that are in no tree.
  void solve(std::span<const Block> joints, std::span<const BodyMass<D>> masses,
             std::span<const float> wanted, std::span<float> lambda);

  /// Block eliminations of the last factor: linear in the joints.
  int operations() const { return operations_; }

 private:
  using Vector = float[kFreedoms];
  using Matrix = float[kFreedoms][kFreedoms];

  static constexpr std::uint32_t kNobody = 0xffffffffu;

  /// A joint as seen from the body that eliminates it.
  struct Link {
    int joint;
    std::uint32_t child;  ///< kNobody where the other body is ground.
  };
  struct Node {
    std::uint32_t body;
    int parent_joint;  ///< -1 at a root.
    int first_link;
    int link_count;
    Matrix mobility;
    Vector free_velocity;  ///< Of the body under its links alone, without the parent's impulse.
  };
  struct LinkFactor {
    Matrix response;  ///< W J^T before the link, [freedom][row].
    BlockFactor<kFreedoms> g;
  };

  void choose_joints(std::span<const Block> joints, std::span<const BodyMass<D>> masses);
  void grow_tree(std::span<const Block> joints, std::span<const BodyMass<D>> masses,
                 std::uint32_t root);
  std::uint32_t root_of(std::uint32_t body);
  void run_links(std::span<const Block> joints, std::span<const float> wanted, Node& node,
                 Vector& velocity, std::span<float> lambda);
  void back_substitute(std::span<const Block> joints, const Node& node, std::span<float> lambda);

  std::vector<std::uint8_t> in_tree_;
  std::vector<std::uint32_t> union_;
  std::vector<std::vector<int>> joints_of_;
  std::vector<std::uint8_t> placed_;
  std::vector<int> node_of_;
  std::vector<Node> nodes_;  ///< Roots before leaves.
  std::vector<Link> links_;
  std::vector<LinkFactor> factors_;  ///< Of links_.
  int operations_ = 0;
};

}  // namespace cycloid::solver
