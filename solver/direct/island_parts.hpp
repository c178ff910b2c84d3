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
template <int D, class T>
[[gnu::always_inline]] inline void push(const IslandRows<D>& group, const IslandRow<D>& row,
                                        T impulse, std::span<Vec<Dim<D>::kFreedoms, T>> momentum) {
  if (group.node_a >= 0)
    for (int i = 0; i < Dim<D>::kFreedoms; ++i)
      momentum[static_cast<std::size_t>(group.node_a)][i] += row.a[i] * impulse;
  if (group.node_b >= 0)
    for (int i = 0; i < Dim<D>::kFreedoms; ++i)
      momentum[static_cast<std::size_t>(group.node_b)][i] += row.b[i] * impulse;
}

/// Speed of the point of a node at `arm`, m/s.
template <int D>
[[gnu::always_inline]] inline Vec<D, Wide> speed_of_point(
    const Vec<Dim<D>::kFreedoms, Wide>& velocity, const Vec<D, Wide>& arm) {
  Spin<D, Wide> spin;
  for (int i = 0; i < Dim<D>::kSpin; ++i) spin[i] = velocity[D + i];
  Vec<D, Wide> speed = spin_cross(spin, arm);
  for (int i = 0; i < D; ++i) speed[i] += velocity[i];
  return speed;
}

/// How fast the point of b leaves that of a at these velocities by node, m/s.
template <int D>
[[gnu::always_inline]] inline Vec<D, Wide> speed_apart(
    const IslandRows<D>& group, std::span<const Vec<Dim<D>::kFreedoms, Wide>> velocity) {
  Vec<D, Wide> speed = Vec<D, Wide>::zero();
  if (group.node_b >= 0)
    speed = speed_of_point<D>(velocity[static_cast<std::size_t>(group.node_b)], group.arm_b);
  if (group.node_a >= 0)
    speed -= speed_of_point<D>(velocity[static_cast<std::size_t>(group.node_a)], group.arm_a);
  return speed;
}

/// r x f of numbers of which those of f may be pairs.
template <class T>
[[gnu::always_inline]] inline Vec<1, T> moment_at(const Vec<2, Wide>& r, const Vec<2, T>& f) {
  return {{r[0] * f[1] - r[1] * f[0]}};
}
template <class T>
[[gnu::always_inline]] inline Vec<3, T> moment_at(const Vec<3, Wide>& r, const Vec<3, T>& f) {
  return {{r[1] * f[2] - r[2] * f[1], r[2] * f[0] - r[0] * f[2], r[0] * f[1] - r[1] * f[0]}};
}

/// Pushes the points of a group apart: momentum += J^T impulse.
template <int D, class T>
[[gnu::always_inline]] inline void push_apart(const IslandRows<D>& group, const Vec<D, T>& impulse,
                                              std::span<Vec<Dim<D>::kFreedoms, T>> momentum) {
  if (group.node_a >= 0) {
    Vec<Dim<D>::kFreedoms, T>& of_a = momentum[static_cast<std::size_t>(group.node_a)];
    const Spin<D, T> turn = moment_at(group.arm_a, impulse);
    for (int i = 0; i < D; ++i) of_a[i] -= impulse[i];
    for (int i = 0; i < Dim<D>::kSpin; ++i) of_a[D + i] -= turn[i];
  }
  if (group.node_b >= 0) {
    Vec<Dim<D>::kFreedoms, T>& of_b = momentum[static_cast<std::size_t>(group.node_b)];
    const Spin<D, T> turn = moment_at(group.arm_b, impulse);
    for (int i = 0; i < D; ++i) of_b[i] += impulse[i];
    for (int i = 0; i < Dim<D>::kSpin; ++i) of_b[D + i] += turn[i];
  }
}

template <int D>
[[gnu::always_inline]] inline Vec<D, Wide> direction_of(const IslandRow<D>& row) {
  Vec<D, Wide> direction;
  for (int i = 0; i < D; ++i) direction[i] = row.b[i];
  return direction;
}

/// Calls act(row, Cdot) for each row of a group at these velocities by node. Rows may be const.
template <int D, class Row, class Act>
[[gnu::always_inline]] inline void for_each_speed(
    const IslandRows<D>& group, Row* row, std::span<const Vec<Dim<D>::kFreedoms, Wide>> velocity,
    Act&& act) {
  if (group.points > 0) {
    const Vec<D, Wide> speed = speed_apart(group, velocity);
    for (int r = 0; r < group.points; ++r)
      act(row[r], group.is_contact ? dot(direction_of<D>(row[r]), speed) : speed[r]);
  }
  for (int r = group.points; r < group.count; ++r) act(row[r], along<D>(group, row[r], velocity));
}

/// Pushes along one row: momentum += J^T impulse. @pre it is no row of a joint's point.
template <int D>
[[gnu::always_inline]] inline void push_row(const IslandRows<D>& group, const IslandRow<D>* row,
                                            int r, Wide impulse,
                                            std::span<Vec<Dim<D>::kFreedoms, Wide>> momentum) {
  if (r < group.points)
    push_apart<D, Wide>(group, impulse * direction_of<D>(row[r]), momentum);
  else
    push<D, Wide>(group, row[r], impulse, momentum);
}

/// Pushes along all rows of a group by impulse_of(row): one number, or of joints a pair of them.
template <int D, class T, class ImpulseOf>
[[gnu::always_inline]] inline void push_rows(const IslandRows<D>& group, const IslandRow<D>* row,
                                             std::span<Vec<Dim<D>::kFreedoms, T>> momentum,
                                             ImpulseOf&& impulse_of) {
  if (group.points > 0) {
    Vec<D, T> impulse = Vec<D, T>::zero();
    for (int r = 0; r < group.points; ++r) {
      const T along_row = impulse_of(row[r]);
      if (!group.is_contact)
        impulse[r] = along_row;
      else
        for (int i = 0; i < D; ++i) impulse[i] += row[r].b[i] * along_row;
    }
    push_apart<D, T>(group, impulse, momentum);
  }
  for (int r = group.points; r < group.count; ++r)
    push<D, T>(group, row[r], impulse_of(row[r]), momentum);
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
