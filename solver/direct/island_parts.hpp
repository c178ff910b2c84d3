#pragma once

#include "solver/direct/island_solver.hpp"

namespace cycloid::solver {

// What the parts of the island solver share: island_solver.cpp, island_step.cpp, island_joints.cpp.

/// M^-1 p of one node.
template <int D>
Vec<Dim<D>::kFreedoms, Wide> answer_to(const Vec<Dim<D>::kFreedoms, Wide>& momentum,
                                       const BodyMass<D>& mass) {
  constexpr int kSpin = Dim<D>::kSpin;
  Vec<Dim<D>::kFreedoms, Wide> velocity;
  for (int i = 0; i < D; ++i) velocity[i] = static_cast<Wide>(mass.inverse_mass) * momentum[i];
  for (int i = 0; i < kSpin; ++i) {
    velocity[D + i] = 0.0;
    for (int j = 0; j < kSpin; ++j)
      velocity[D + i] += static_cast<Wide>(mass.inverse_inertia.m[i * kSpin + j]) * momentum[D + j];
  }
  return velocity;
}

/// Cdot of a row at these velocities by node.
template <int D>
[[gnu::always_inline]] inline Wide along(const IslandRows<D>& group, const IslandRow<D>& row,
                                         std::span<const Vec<Dim<D>::kFreedoms, Wide>> velocity) {
  Wide sum = 0.0;
  if (group.node_a >= 0)
    for (int i = 0; i < Dim<D>::kFreedoms; ++i)
      sum += row.a[i] * velocity[static_cast<std::size_t>(group.node_a)][i];
  if (group.node_b >= 0)
    for (int i = 0; i < Dim<D>::kFreedoms; ++i)
      sum += row.b[i] * velocity[static_cast<std::size_t>(group.node_b)][i];
  return sum;
}

/// momentum += J^T impulse.
template <int D>
[[gnu::always_inline]] inline void push(const IslandRows<D>& group, const IslandRow<D>& row,
                                        Wide impulse,
                                        std::span<Vec<Dim<D>::kFreedoms, Wide>> momentum) {
  if (group.node_a >= 0)
    for (int i = 0; i < Dim<D>::kFreedoms; ++i)
      momentum[static_cast<std::size_t>(group.node_a)][i] += impulse * row.a[i];
  if (group.node_b >= 0)
    for (int i = 0; i < Dim<D>::kFreedoms; ++i)
      momentum[static_cast<std::size_t>(group.node_b)][i] += impulse * row.b[i];
}

/// w x (w x r): how the speed of a point at r changes as its body turns.
template <class L>
Vec<2, L> centripetal(const Vec<1, L>& spin, const Vec<2, L>& r) {
  const L square = spin[0] * spin[0];
  return {{-square * r[0], -square * r[1]}};
}
template <class L>
Vec<3, L> centripetal(const Vec<3, L>& spin, const Vec<3, L>& r) {
  const L along = spin[0] * r[0] + spin[1] * r[1] + spin[2] * r[2];
  const L square = spin[0] * spin[0] + spin[1] * spin[1] + spin[2] * spin[2];
  Vec<3, L> change;
  for (int i = 0; i < 3; ++i) change[i] = along * spin[i] - square * r[i];
  return change;
}

/// Of the changed impulses, whose length friction bounds.
template <int D>
Wide square_of_tangents(const IslandRows<D>& group, const IslandRow<D>* row) {
  Wide square = 0.0;
  for (int t = 1; t < group.count; ++t) {
    const Wide tangent = row[t].impulse + row[t].change;
    square += tangent * tangent;
  }
  return square;
}

}  // namespace cycloid::solver
