#include "solver/direct/tree_solver.hpp"

#include <algorithm>

namespace cycloid::solver {

/// Compliance of a row that nothing below the joint yields to, relative to the diagonal of
/// J M^-1 J^T. Ground then weighs 1e5 links: less lets go of the load, more drowns the links.
static constexpr float kSupport = 1e-5f;
/// Where what is below yields less than this, relative to the same diagonal, it is `kSupport`.
static constexpr float kYields = 1e-6f;
/// Least pivot of a row relative to the same diagonal: what rounding leaves of a redundant row.
static constexpr float kLeastPivot = 1e-6f;
/// Solves with what the ones before missed. A chain between two grounds misses its rows by 2e-3 of
/// the wanted change without, by 1e-5 with one and by 1e-7 with two, and a joint tension by 4e-3,
/// 2e-5 and 1e-6 (10 to 160 links, one of which up to 1e5 times as heavy).
static constexpr int kRefinements = 2;

/// Inverse mass matrix of a body, element (row, column).
template <int D>
static float inverse_mass_element(const BodyMass<D>& mass, int row, int column) {
  if (row < D || column < D) return row == column ? mass.inverse_mass : 0.0f;
  return mass.inverse_inertia.m[(row - D) * Dim<D>::kSpin + column - D];
}

/// Mass matrix of a body from its inverse. A freedom that does not move gets mass 1 on the
/// diagonal; its Jacobian columns are cleared in `load_joint`.
template <int D, int N>
static void mass_matrix(const BodyMass<D>& mass, float (&matrix)[N][N]) {
  float inverse[N][N];
  float floor[N];
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < N; ++j) inverse[i][j] = inverse_mass_element<D>(mass, i, j);
    floor[i] = 1e-6f * inverse[i][i];
  }
  SmallFactor<N> factor;
  factor_small(inverse, floor, N, factor);
  float columns[N][N] = {};
  for (int i = 0; i < N; ++i) {
    columns[i][i] = 1.0f;
    solve_small(factor, N, columns[i]);
  }
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j) matrix[i][j] = 0.5f * (columns[i][j] + columns[j][i]);
  for (int i = 0; i < N; ++i)
    if (!(inverse[i][i] > 0.0f)) matrix[i][i] = 1.0f;
}

template <int D>
void TreeSolver<D>::load_joint(Step& step, const JointBlock<D>& joint,
                               std::span<const BodyMass<D>> masses) {
  const std::uint32_t child_slot = step.child == kNone ? kNone : slot_of_[step.child];
  const bool child_is_a =
      joint.body_a == child_slot || (step.child == kNone && joint.body_b == slot_of_[step.parent]);
  step.rows = joint.rows;
  for (int row = 0; row < joint.rows; ++row) {
    step.softness[row] = joint.softness[row];
    step.scale[row] = 0.0f;
    for (const bool child : {true, false}) {
      const std::uint32_t node = child ? step.child : step.parent;
      float(&to)[kFreedoms] = child ? step.child_rows[row] : step.parent_rows[row];
      const float(&from)[kFreedoms] = child == child_is_a ? joint.j_a[row] : joint.j_b[row];
      for (int i = 0; i < kFreedoms; ++i) {
        const bool free =
            node != kNone && inverse_mass_element<D>(masses[slot_of_[node]], i, i) > 0.0f;
        to[i] = free ? from[i] : 0.0f;
      }
      for (int i = 0; node != kNone && i < kFreedoms; ++i)
        for (int j = 0; j < kFreedoms; ++j)
          step.scale[row] += to[i] * inverse_mass_element<D>(masses[slot_of_[node]], i, j) * to[j];
    }
  }
}

template <int D>
void TreeSolver<D>::eliminate(Step& step) {
  if (step.child != kNone) {
    BodyNode& child = nodes_[step.child];
    factor_small(child.articulated, child.least, kFreedoms, child.factor);
    ++operations_;
  }
  if (step.joint == kNone) return;
  float pivot[kFreedoms][kFreedoms] = {};
  float least[kFreedoms];
  for (int row = 0; row < step.rows; ++row) pivot[row][row] = step.softness[row];
  if (step.child != kNone)
    add_gram(nodes_[step.child].factor, kFreedoms, step.child_rows, step.rows, pivot);
  for (int row = 0; row < step.rows; ++row) {
    if (pivot[row][row] < kYields * step.scale[row]) pivot[row][row] += kSupport * step.scale[row];
    least[row] = kLeastPivot * step.scale[row];
  }
  factor_small(pivot, least, step.rows, step.factor);
  ++operations_;
  if (step.parent == kNone) return;
  float columns[kFreedoms][kFreedoms];
  for (int row = 0; row < step.rows; ++row)
    for (int i = 0; i < kFreedoms; ++i) columns[i][row] = step.parent_rows[row][i];
  add_gram(step.factor, step.rows, columns, kFreedoms, nodes_[step.parent].articulated);
  ++operations_;
}

template <int D>
void TreeSolver<D>::factor(std::span<const JointBlock<D>> joints,
                           std::span<const BodyMass<D>> masses) {
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    BodyNode& node = nodes_[n];
    mass_matrix<D>(masses[slot_of_[n]], node.mass);
    const float none[kFreedoms] = {};
    factor_small(node.mass, none, kFreedoms, node.factor);
    // What hangs below only adds, so it cannot lower a pivot; rounding can.
    for (int i = 0; i < kFreedoms; ++i) {
      node.least[i] = node.factor.inverse_pivot[i] > 0.0f ? 1.0f / node.factor.inverse_pivot[i] : 0;
      for (int j = 0; j < kFreedoms; ++j) node.articulated[i][j] = node.mass[i][j];
    }
    ++operations_;
  }
  for (Step& step : steps_) {
    if (step.joint != kNone) load_joint(step, joints[step.joint], masses);
    eliminate(step);
  }
}

/// Solves with the residuals as right-hand sides, into `change` of nodes and steps.
template <int D>
void TreeSolver<D>::substitute() {
  for (BodyNode& node : nodes_) std::copy_n(node.residual, kFreedoms, node.load);
  for (Step& step : steps_) {
    ++operations_;
    if (step.joint == kNone) continue;
    std::copy_n(step.residual, step.rows, step.load);
    if (step.child != kNone) {
      BodyNode& child = nodes_[step.child];
      std::copy_n(child.load, kFreedoms, child.change);
      solve_small(child.factor, kFreedoms, child.change);
      subtract_product(step.child_rows, step.rows, child.change, step.load);
    }
    if (step.parent == kNone) continue;
    std::copy_n(step.load, step.rows, step.change);
    solve_small(step.factor, step.rows, step.change);
    add_transposed_product(step.parent_rows, step.rows, step.change, nodes_[step.parent].load);
  }
  for (std::size_t s = steps_.size(); s-- > 0;) {
    Step& step = steps_[s];
    ++operations_;
    if (step.joint != kNone) {
      std::copy_n(step.load, step.rows, step.change);
      if (step.parent != kNone)
        subtract_product(step.parent_rows, step.rows, nodes_[step.parent].change, step.change);
      solve_small(step.factor, step.rows, step.change);
    }
    if (step.child == kNone) continue;
    BodyNode& child = nodes_[step.child];
    if (step.joint != kNone)
      add_transposed_product(step.child_rows, step.rows, step.change, child.load);
    std::copy_n(child.load, kFreedoms, child.change);
    solve_small(child.factor, kFreedoms, child.change);
  }
}

/// Adds the changes to velocities and impulses and finds what the rows and momenta still miss.
template <int D>
void TreeSolver<D>::update_residuals(std::span<const float> rhs) {
  for (BodyNode& node : nodes_) {
    for (int i = 0; i < kFreedoms; ++i) node.velocity[i] += node.change[i];
    for (int i = 0; i < kFreedoms; ++i) {
      node.residual[i] = 0.0f;
      for (int j = 0; j < kFreedoms; ++j) node.residual[i] -= node.mass[i][j] * node.velocity[j];
    }
  }
  for (Step& step : steps_) {
    ++operations_;
    if (step.joint == kNone) continue;
    for (int row = 0; row < step.rows; ++row) {
      step.impulse[row] += step.change[row];
      step.residual[row] =
          rhs[step.joint * std::size_t{kFreedoms} + static_cast<std::size_t>(row)] -
          step.softness[row] * step.impulse[row];
    }
    if (step.child != kNone) {
      BodyNode& child = nodes_[step.child];
      subtract_product(step.child_rows, step.rows, child.velocity, step.residual);
      add_transposed_product(step.child_rows, step.rows, step.impulse, child.residual);
    }
    if (step.parent != kNone) {
      BodyNode& parent = nodes_[step.parent];
      subtract_product(step.parent_rows, step.rows, parent.velocity, step.residual);
      add_transposed_product(step.parent_rows, step.rows, step.impulse, parent.residual);
    }
  }
}

template <int D>
void TreeSolver<D>::solve(std::span<const float> rhs, std::span<float> lambda) {
  std::fill(lambda.begin(), lambda.end(), 0.0f);
  for (BodyNode& node : nodes_) {
    std::fill_n(node.velocity, kFreedoms, 0.0f);
    std::fill_n(node.change, kFreedoms, 0.0f);
  }
  for (Step& step : steps_) {
    std::fill_n(step.impulse, kFreedoms, 0.0f);
    std::fill_n(step.change, kFreedoms, 0.0f);
  }
  for (int i = 0; i <= kRefinements; ++i) {
    update_residuals(rhs);
    substitute();
  }
  update_residuals(rhs);
  for (const Step& step : steps_)
    if (step.joint != kNone)
      std::copy_n(step.impulse, step.rows, &lambda[step.joint * std::size_t{kFreedoms}]);
}

template <int D>
float TreeSolver<D>::velocity_change(std::uint32_t body, int freedom) const {
  if (body >= node_of_.size() || node_of_[body] == kNone) return 0.0f;
  return nodes_[node_of_[body]].velocity[freedom];
}

template void TreeSolver<2>::factor(std::span<const JointBlock<2>>, std::span<const BodyMass<2>>);
template void TreeSolver<2>::solve(std::span<const float>, std::span<float>);
template float TreeSolver<2>::velocity_change(std::uint32_t, int) const;
template void TreeSolver<3>::factor(std::span<const JointBlock<3>>, std::span<const BodyMass<3>>);
template void TreeSolver<3>::solve(std::span<const float>, std::span<float>);
template float TreeSolver<3>::velocity_change(std::uint32_t, int) const;

}  // namespace cycloid::solver
