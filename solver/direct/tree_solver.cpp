#include "solver/direct/tree_solver.hpp"

namespace cycloid::solver {

template <int D>
static bool moves(const BodyMass<D>& mass) {
  return mass.inverse_mass > 0.0f;
}

/// The rows of a joint on one of its bodies.
template <int D>
static const auto& jacobian_of(const JointBlock<D>& joint, std::uint32_t body) {
  return joint.body_a == body ? joint.j_a : joint.j_b;
}

template <int D>
std::uint32_t TreeSolver<D>::root_of(std::uint32_t body) {
  while (union_[body] != body) {
    union_[body] = union_[union_[body]];
    body = union_[body];
  }
  return body;
}

template <int D>
void TreeSolver<D>::choose_joints(std::span<const Block> joints,
                                  std::span<const BodyMass<D>> masses) {
  const std::size_t bodies = masses.size();
  union_.resize(bodies);
  for (std::uint32_t i = 0; i < bodies; ++i) union_[i] = i;
  in_tree_.assign(joints.size(), 0);
  joints_of_.resize(bodies);
  for (auto& list : joints_of_) list.clear();
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const Block& joint = joints[j];
    const bool a_moves = moves(masses[joint.body_a]);
    const bool b_moves = moves(masses[joint.body_b]);
    if (joint.rows == 0 || (!a_moves && !b_moves)) continue;
    if (a_moves && b_moves) {
      const std::uint32_t a = root_of(joint.body_a);
      const std::uint32_t b = root_of(joint.body_b);
      if (a == b) continue;
      union_[a < b ? b : a] = a < b ? a : b;
    }
    in_tree_[j] = 1;
    if (a_moves) joints_of_[joint.body_a].push_back(static_cast<int>(j));
    if (b_moves) joints_of_[joint.body_b].push_back(static_cast<int>(j));
  }
}

template <int D>
void TreeSolver<D>::grow_tree(std::span<const Block> joints, std::span<const BodyMass<D>> masses,
                              std::uint32_t root) {
  const std::size_t first = nodes_.size();
  nodes_.push_back({root, -1, 0, 0, {}, {}});
  placed_[root] = 1;
  for (std::size_t n = first; n < nodes_.size(); ++n) {
    const std::uint32_t body = nodes_[n].body;
    node_of_[body] = static_cast<int>(n);
    nodes_[n].first_link = static_cast<int>(links_.size());
    for (const int j : joints_of_[body]) {
      if (j == nodes_[n].parent_joint) continue;
      const Block& joint = joints[static_cast<std::size_t>(j)];
      const std::uint32_t other = joint.body_a == body ? joint.body_b : joint.body_a;
      const bool has_child = moves(masses[other]);
      links_.push_back({j, has_child ? other : kNobody});
      if (!has_child) continue;
      placed_[other] = 1;
      nodes_.push_back({other, j, 0, 0, {}, {}});
    }
    nodes_[n].link_count = static_cast<int>(links_.size()) - nodes_[n].first_link;
  }
}

template <int D>
void TreeSolver<D>::analyse(std::span<const Block> joints, std::span<const BodyMass<D>> masses) {
  choose_joints(joints, masses);
  placed_.assign(masses.size(), 0);
  node_of_.assign(masses.size(), -1);
  nodes_.clear();
  links_.clear();
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (in_tree_[j] == 0) continue;
    const Block& joint = joints[j];
    const bool a_moves = moves(masses[joint.body_a]);
    if (a_moves && moves(masses[joint.body_b])) continue;
    const std::uint32_t body = a_moves ? joint.body_a : joint.body_b;
    if (placed_[body] == 0) grow_tree(joints, masses, body);
  }
  for (std::uint32_t body = 0; body < masses.size(); ++body)
    if (placed_[body] == 0 && !joints_of_[body].empty()) grow_tree(joints, masses, body);
  factors_.resize(links_.size());
}

template <int D>
static void set_inverse_mass(const BodyMass<D>& mass,
                             float (&w)[Dim<D>::kFreedoms][Dim<D>::kFreedoms]) {
  constexpr int kSpin = Dim<D>::kSpin;
  for (auto& row : w)
    for (float& value : row) value = 0.0f;
  for (int i = 0; i < D; ++i) w[i][i] = mass.inverse_mass;
  for (int i = 0; i < kSpin; ++i)
    for (int k = 0; k < kSpin; ++k) w[D + i][D + k] = mass.inverse_inertia.m[i * kSpin + k];
}

template <int D>
void TreeSolver<D>::factor(std::span<const Block> joints, std::span<const BodyMass<D>> masses) {
  operations_ = 0;
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    Node& node = nodes_[n];
    Matrix& w = node.mobility;
    set_inverse_mass<D>(masses[node.body], w);
    for (int l = node.first_link; l < node.first_link + node.link_count; ++l) {
      const Link& link = links_[static_cast<std::size_t>(l)];
      const Block& joint = joints[static_cast<std::size_t>(link.joint)];
      LinkFactor& factor = factors_[static_cast<std::size_t>(l)];
      const auto& j = jacobian_of(joint, node.body);
      Matrix g = {};
      if (link.child != kNobody) {
        const Matrix& below = nodes_[static_cast<std::size_t>(node_of_[link.child])].mobility;
        const auto& j_child = jacobian_of(joint, link.child);
        for (int r = 0; r < joint.rows; ++r) {
          Vector moved = {};
          for (int i = 0; i < kFreedoms; ++i)
            for (int k = 0; k < kFreedoms; ++k) moved[i] += below[i][k] * j_child[r][k];
          for (int s = 0; s < joint.rows; ++s)
            for (int i = 0; i < kFreedoms; ++i) g[s][r] += j_child[s][i] * moved[i];
        }
      }
      for (int r = 0; r < joint.rows; ++r) {
        for (int i = 0; i < kFreedoms; ++i) {
          factor.response[i][r] = 0.0f;
          for (int k = 0; k < kFreedoms; ++k) factor.response[i][r] += w[i][k] * j[r][k];
        }
        g[r][r] += joint.compliance;
      }
      for (int s = 0; s < joint.rows; ++s)
        for (int r = 0; r < joint.rows; ++r)
          for (int i = 0; i < kFreedoms; ++i) g[s][r] += j[s][i] * factor.response[i][r];
      factor.g.factor(g, joint.rows);
      for (int i = 0; i < kFreedoms; ++i) {
        Vector weights = {};
        for (int r = 0; r < joint.rows; ++r) weights[r] = factor.response[i][r];
        factor.g.solve(weights, joint.rows);
        for (int k = 0; k < kFreedoms; ++k)
          for (int r = 0; r < joint.rows; ++r) w[i][k] -= weights[r] * factor.response[k][r];
      }
      ++operations_;
    }
  }
}

/// mu_c = G_c^-1 (wanted_c - J_child u_child - J_c x),  x += W J_c^T mu_c, link by link.
template <int D>
void TreeSolver<D>::run_links(std::span<const Block> joints, std::span<const float> wanted,
                              Node& node, Vector& velocity, std::span<float> lambda) {
  for (int l = node.first_link; l < node.first_link + node.link_count; ++l) {
    const Link& link = links_[static_cast<std::size_t>(l)];
    const Block& joint = joints[static_cast<std::size_t>(link.joint)];
    const LinkFactor& factor = factors_[static_cast<std::size_t>(l)];
    const auto& j = jacobian_of(joint, node.body);
    Vector mu = {};
    for (int r = 0; r < joint.rows; ++r) {
      mu[r] = wanted[static_cast<std::size_t>(link.joint * kFreedoms + r)];
      for (int i = 0; i < kFreedoms; ++i) mu[r] -= j[r][i] * velocity[i];
      if (link.child == kNobody) continue;
      const auto& j_child = jacobian_of(joint, link.child);
      const Node& child = nodes_[static_cast<std::size_t>(node_of_[link.child])];
      for (int i = 0; i < kFreedoms; ++i) mu[r] -= j_child[r][i] * child.free_velocity[i];
    }
    factor.g.solve(mu, joint.rows);
    for (int i = 0; i < kFreedoms; ++i)
      for (int r = 0; r < joint.rows; ++r) velocity[i] += factor.response[i][r] * mu[r];
    for (int r = 0; r < joint.rows; ++r)
      lambda[static_cast<std::size_t>(link.joint * kFreedoms + r)] = mu[r];
  }
}

/// The links after one push back on it: lambda_c = mu_c - G_c^-1 (W J_c^T)^T sum of J^T lambda of
/// those after c.
template <int D>
void TreeSolver<D>::back_substitute(std::span<const Block> joints, const Node& node,
                                    std::span<float> lambda) {
  Vector pushed = {};
  for (int l = node.first_link + node.link_count - 1; l >= node.first_link; --l) {
    const Link& link = links_[static_cast<std::size_t>(l)];
    const Block& joint = joints[static_cast<std::size_t>(link.joint)];
    const LinkFactor& factor = factors_[static_cast<std::size_t>(l)];
    const auto& j = jacobian_of(joint, node.body);
    Vector reaction = {};
    for (int r = 0; r < joint.rows; ++r)
      for (int i = 0; i < kFreedoms; ++i) reaction[r] += factor.response[i][r] * pushed[i];
    factor.g.solve(reaction, joint.rows);
    for (int r = 0; r < joint.rows; ++r) {
      float& impulse = lambda[static_cast<std::size_t>(link.joint * kFreedoms + r)];
      impulse -= reaction[r];
      for (int i = 0; i < kFreedoms; ++i) pushed[i] += j[r][i] * impulse;
    }
  }
}

template <int D>
void TreeSolver<D>::solve(std::span<const Block> joints, std::span<const BodyMass<D>> masses,
                          std::span<const float> wanted, std::span<float> lambda) {
  for (float& impulse : lambda) impulse = 0.0f;
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    for (float& value : nodes_[n].free_velocity) value = 0.0f;
    run_links(joints, wanted, nodes_[n], nodes_[n].free_velocity, lambda);
  }
  for (Node& node : nodes_) {
    Vector velocity = {};
    if (node.parent_joint >= 0) {
      const Block& joint = joints[static_cast<std::size_t>(node.parent_joint)];
      const auto& j = jacobian_of(joint, node.body);
      Vector push = {};
      for (int r = 0; r < joint.rows; ++r)
        for (int i = 0; i < kFreedoms; ++i)
          push[i] += j[r][i] * lambda[static_cast<std::size_t>(node.parent_joint * kFreedoms + r)];
      Matrix inverse_mass;
      set_inverse_mass<D>(masses[node.body], inverse_mass);
      for (int i = 0; i < kFreedoms; ++i)
        for (int k = 0; k < kFreedoms; ++k) velocity[i] += inverse_mass[i][k] * push[k];
    }
    run_links(joints, wanted, node, velocity, lambda);
    back_substitute(joints, node, lambda);
  }
}

template class TreeSolver<2>;
template class TreeSolver<3>;

}  // namespace cycloid::solver
