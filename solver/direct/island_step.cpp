#include <algorithm>

#include "solver/direct/island_parts.hpp"

namespace cycloid::solver {

/// Mass of one freedom or pair of freedoms; where there is no inertia, 1 on the diagonal.
template <int D>
static void set_mass(const BodyMass<D>& mass, SquareBlock<Dim<D>::kFreedoms>& block) {
  constexpr int kSpin = Dim<D>::kSpin;
  for (int i = 0; i < D; ++i) block.at(i, i) = 1.0 / static_cast<Wide>(mass.inverse_mass);
  const float* inverse = mass.inverse_inertia.m;
  if constexpr (kSpin == 1) {
    block.at(D, D) = inverse[0] > 0.0f ? 1.0 / static_cast<Wide>(inverse[0]) : 1.0;
  } else {
    Wide m[9];
    for (int i = 0; i < 9; ++i) m[i] = static_cast<Wide>(inverse[i]);
    Wide cofactor[3][3];
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        cofactor[i][j] = m[3 * ((i + 1) % 3) + (j + 1) % 3] * m[3 * ((i + 2) % 3) + (j + 2) % 3] -
                         m[3 * ((i + 1) % 3) + (j + 2) % 3] * m[3 * ((i + 2) % 3) + (j + 1) % 3];
    const Wide determinant = m[0] * cofactor[0][0] + m[1] * cofactor[0][1] + m[2] * cofactor[0][2];
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        block.at(D + i, D + j) = determinant > 0.0
                                     ? 0.5 * (cofactor[i][j] + cofactor[j][i]) / determinant
                                 : i == j ? 1.0
                                          : 0.0;
  }
}

/// block += scale p q^T.
template <int N>
static void add_outer(Wide scale, const Wide (&p)[N], const Wide (&q)[N], SquareBlock<N>& block) {
  for (int i = 0; i < N; ++i) {
    const Wide scaled = scale * p[i];
    for (int j = 0; j < N; ++j) block.at(i, j) += scaled * q[j];
  }
}
/// block += scale p p^T, of which only the lower triangle is read.
template <int N>
static void add_square(Wide scale, const Wide (&p)[N], SquareBlock<N>& block) {
  for (int i = 0; i < N; ++i) {
    const Wide scaled = scale * p[i];
    for (int j = 0; j <= i; ++j) block.at(i, j) += scaled * p[j];
  }
}

/// Columns of the matrix [r]x: r x v = [r]x v. In the plane r x v is a number.
static Wide cross_column(const Vec<2, Wide>& r, int, int j) {
  return j == 0 ? -r[1] : r[0];
}
static Wide cross_column(const Vec<3, Wide>& r, int i, int j) {
  constexpr int kOther[3][3] = {{-1, 2, 1}, {2, -1, 0}, {1, 0, -1}};
  if (i == j) return 0.0;
  const Wide entry = r[kOther[i][j]];
  return (j - i + 3) % 3 == 1 ? -entry : entry;
}

/// block += scale P^T P of what a point does in all directions, P = (I, -[p]x); only the lower
/// triangle is read.
template <int D>
static void add_point_square(Wide scale, const Vec<D, Wide>& p,
                             SquareBlock<Dim<D>::kFreedoms>& block) {
  constexpr int kSpin = Dim<D>::kSpin;
  const Wide square = scale * dot(p, p);
  for (int i = 0; i < D; ++i) block.at(i, i) += scale;
  for (int i = 0; i < kSpin; ++i) {
    for (int j = 0; j < D; ++j) block.at(D + i, j) += scale * cross_column(p, i, j);
    block.at(D + i, D + i) += square;
    if constexpr (kSpin == 3)
      for (int j = 0; j <= i; ++j) block.at(D + i, D + j) -= scale * p[i] * p[j];
  }
}

/// block += scale P^T Q of what a point does in all directions: P = (I, -[p]x), Q = (I, -[q]x).
/// The directions of a point that sticks are orthonormal, so their squares add up to this.
template <int D>
static void add_point(Wide scale, const Vec<D, Wide>& p, const Vec<D, Wide>& q,
                      SquareBlock<Dim<D>::kFreedoms>& block) {
  constexpr int kSpin = Dim<D>::kSpin;
  const Wide product = scale * dot(p, q);
  for (int i = 0; i < D; ++i) block.at(i, i) += scale;
  for (int i = 0; i < kSpin; ++i) {
    for (int j = 0; j < D; ++j) {
      block.at(D + i, j) += scale * cross_column(p, i, j);
      block.at(j, D + i) += scale * cross_column(q, i, j);
    }
    block.at(D + i, D + i) += product;
    if constexpr (kSpin == 3)
      for (int j = 0; j < kSpin; ++j) block.at(D + i, D + j) -= scale * q[i] * p[j];
  }
}

/// In the plane there is one axis, and it is across.
static Wide across(const Vec<2>&, int, int) {
  return 1.0;
}
static Wide across(const Vec<3>& along, int i, int j) {
  return (i == j ? 1.0 : 0.0) - static_cast<Wide>(along[i]) * static_cast<Wide>(along[j]);
}

/// M + J^T W J of the joints, which hold always, factored up to the bodies that touch something;
/// what is left for these is kept.
template <int D>
void IslandSolver<D>::assemble_joints(const Island& island, std::span<const BodyMass<D>> masses) {
  matrix.clear(island.steps);
  for (int n = island.nodes.begin; n < island.nodes.end; ++n)
    set_mass<D>(masses[body_of[static_cast<std::size_t>(n)]], matrix.diagonal(n));
  for (const IslandTension<D>& tension : tensions_of(island)) {
    for (int i = 0; i < Dim<D>::kSpin; ++i)
      for (int j = 0; j < Dim<D>::kSpin; ++j)
        matrix.diagonal(tension.node).at(D + i, D + j) +=
            static_cast<Wide>(tension.stiffness) * across(tension.along, i, j);
  }
  for (const IslandRows<D>& group : joints_of(island)) {
    const IslandRow<D>* row = first_row(group);
    if (group.points > 0) assemble_point(group, row->stiffness);
    for (int r = group.points; r < group.count; ++r) assemble_row(group, row[r]);
  }
  matrix.factor({island.steps.begin, island.contact_steps.begin});
  matrix.keep(island.contact_steps);
}

/// A row of a point with all that it does to both nodes.
template <int D>
static IslandRow<D> written_out(const IslandRows<D>& group, const IslandRow<D>& row) {
  IslandRow<D> whole = row;
  const Spin<D, Wide> turn_a = moment(group.arm_a, direction_of<D>(row));
  const Spin<D, Wide> turn_b = moment(group.arm_b, direction_of<D>(row));
  for (int i = 0; i < D; ++i) whole.a[i] = -row.b[i];
  for (int i = 0; i < Dim<D>::kSpin; ++i) {
    whole.a[D + i] = -turn_a[i];
    whole.b[D + i] = turn_b[i];
  }
  return whole;
}

/// Adds J^T W J of the contacts that hold and factors what `assemble_joints` has left.
/// @pre the blocks are as that has kept them.
template <int D>
void IslandSolver<D>::assemble_contacts(const Island& island) {
  for (const IslandRows<D>& group : contacts_of(island)) {
    const IslandRow<D>* row = first_row(group);
    if (group.count > 1 && row[1].holds) {
      assemble_point(group, row[0].stiffness);
      continue;
    }
    for (int r = 0; r < group.count; ++r)
      if (row[r].holds) assemble_row(group, r < group.points ? written_out(group, row[r]) : row[r]);
  }
  matrix.factor(island.contact_steps);
}

/// The torque, as an impulse, by which a tension answers to how its body turns now.
template <int D>
Spin<D, Wide> IslandSolver<D>::pull_of(const IslandTension<D>& tension,
                                       std::span<const Motion<D>> motions) const {
  const auto node = static_cast<std::size_t>(tension.node);
  const Motion<D>& motion = motions[body_of[node]];
  Spin<D, Wide> pull = Spin<D, Wide>::zero();
  for (int i = 0; i < Dim<D>::kSpin; ++i)
    for (int j = 0; j < Dim<D>::kSpin; ++j)
      pull[i] += static_cast<Wide>(tension.stiffness) * across(tension.along, i, j) *
                 (static_cast<Wide>(motion.spin[j]) + change[node][D + j]);
  return pull;
}

/// -J^T W missing of joints and tensions, brought forward to the bodies that touch something.
/// @pre assemble_joints.
template <int D>
void IslandSolver<D>::load_joints(const Island& island, std::span<const Motion<D>> motions) {
  set_zero(island, solution_);
  for (const IslandTension<D>& tension : tensions_of(island)) {
    const Spin<D, Wide> pull = pull_of(tension, motions);
    for (int i = 0; i < Dim<D>::kSpin; ++i)
      solution_[static_cast<std::size_t>(tension.node)][D + i] -= pull[i];
  }
  for (const IslandRows<D>& group : joints_of(island)) {
    const IslandRow<D>* row = first_row(group);
    push_rows<D, Wide>(group, row, solution_,
                       [](const IslandRow<D>& of) { return -of.stiffness * of.missing; });
  }
  matrix.solve_lower({island.steps.begin, island.contact_steps.begin}, solution_);
  copy(island, solution_, kept_);
}

/// Solves for the bodies that touch something, with the contacts that hold. @pre load_joints.
template <int D>
void IslandSolver<D>::solve_contacts(const Island& island) {
  copy(island, kept_, solution_);
  for (const IslandRows<D>& group : contacts_of(island)) {
    const IslandRow<D>* row = first_row(group);
    if (row->holds)  // Else no tangent does.
      push_rows<D, Wide>(group, row, solution_, [](const IslandRow<D>& of) {
        return of.holds ? -of.stiffness * of.missing : 0.0;
      });
  }
  matrix.solve(island.contact_steps, solution_);
}

/// Adds J^T W J of a contact point that sticks: all its rows at once.
template <int D>
void IslandSolver<D>::assemble_point(const IslandRows<D>& group, Wide stiffness) {
  const int a = group.node_a;
  const int b = group.node_b;
  if (a >= 0) add_point_square<D>(stiffness, group.arm_a, matrix.diagonal(a));
  if (b >= 0) add_point_square<D>(stiffness, group.arm_b, matrix.diagonal(b));
  if (group.pair < 0) return;
  if (a > b)
    add_point<D>(-stiffness, group.arm_a, group.arm_b, matrix.beside(group.pair));
  else
    add_point<D>(-stiffness, group.arm_b, group.arm_a, matrix.beside(group.pair));
}

/// Adds J^T W J of one row.
template <int D>
void IslandSolver<D>::assemble_row(const IslandRows<D>& group, const IslandRow<D>& row) {
  if (group.node_a >= 0) add_square(row.stiffness, row.a, matrix.diagonal(group.node_a));
  if (group.node_b >= 0) add_square(row.stiffness, row.b, matrix.diagonal(group.node_b));
  if (group.pair < 0) return;
  if (group.node_a > group.node_b)
    add_outer(row.stiffness, row.a, row.b, matrix.beside(group.pair));
  else
    add_outer(row.stiffness, row.b, row.a, matrix.beside(group.pair));
}

/// Holds the new impulses to their bounds. @returns whether any was outside; then the solution is
/// that of the bounded ones.
template <int D>
bool IslandSolver<D>::hold_to_bounds(const Island& island, std::span<const BodyMass<D>> masses) {
  set_zero(island, momentum_);
  bool bounded = false;
  for (const IslandRows<D>& group : contacts_of(island)) {
    IslandRow<D>* row = first_row(group);
    const Wide normal = std::max(row[0].impulse + row[0].change, 0.0);
    const Wide bound = group.friction * normal;
    const Wide square = square_of_tangents(group, row);
    Wide scale = 1.0;
    if (square > bound * bound) {
      const Wide length = root(square);  // 0 of what is too small for a float.
      scale = length > 0.0 ? bound / length : 0.0;
    }
    for (int r = 0; r < group.count; ++r) {
      const Wide wanted = row[r].impulse + row[r].change;
      const Wide more = (r == 0 ? normal : scale * wanted) - wanted;
      if (more == 0.0) continue;
      bounded = true;
      row[r].change += more;
      push_row<D>(group, row, r, more, momentum_);
    }
  }
  if (!bounded) return false;
  for (int n = island.nodes.begin; n < island.nodes.end; ++n) {
    const auto node = static_cast<std::size_t>(n);
    const Vector more = answer_to<D>(momentum_[node], masses[body_of[node]]);
    for (int i = 0; i < kFreedoms; ++i) solution_[node][i] += more[i];
  }
  for (const IslandRows<D>& group : groups_of(island)) {
    IslandRow<D>* row = first_row(group);
    for_each_speed<D>(group, row, solution_,
                      [](IslandRow<D>& of, Wide speed) { of.answer = speed; });
  }
  return true;
}

/// How far along the changes the work that is left is least: from 0 to 1.
template <int D>
Wide IslandSolver<D>::best_step(const Island& island) const {
  Wide slope = 0.0;
  Wide curve = 0.0;
  for (const IslandRows<D>& group : groups_of(island)) {
    for (const IslandRow<D>& row : rows_of(group)) {
      if (row.change == 0.0) continue;
      slope += row.change * row.missing;
      curve += row.change * row.answer;
    }
  }
  if (!(slope < 0.0)) return 0.0;
  return curve > -slope ? -slope / curve : 1.0;
}

/// Bounds the changes and goes as far with them as helps. @returns how far.
template <int D>
Wide IslandSolver<D>::take(const Island& island, std::span<const BodyMass<D>> masses) {
  const Wide step = hold_to_bounds(island, masses) ? best_step(island) : 1.0;
  if (step == 0.0) return step;
  for (int n = island.nodes.begin; n < island.nodes.end; ++n)
    for (int i = 0; i < kFreedoms; ++i)
      change[static_cast<std::size_t>(n)][i] += step * solution_[static_cast<std::size_t>(n)][i];
  for (const IslandRows<D>& group : groups_of(island)) {
    for (IslandRow<D>& row : rows_of(group)) {
      row.impulse += step * row.change;
      row.missing += step * row.answer;
    }
  }
  return step;
}

template Spin<2, Wide> IslandSolver<2>::pull_of(const IslandTension<2>&,
                                                std::span<const Motion<2>>) const;
template Spin<3, Wide> IslandSolver<3>::pull_of(const IslandTension<3>&,
                                                std::span<const Motion<3>>) const;
template void IslandSolver<2>::assemble_joints(const Island&, std::span<const BodyMass<2>>);
template void IslandSolver<2>::assemble_contacts(const Island&);
template void IslandSolver<2>::load_joints(const Island&, std::span<const Motion<2>>);
template void IslandSolver<2>::solve_contacts(const Island&);
template Wide IslandSolver<2>::take(const Island&, std::span<const BodyMass<2>>);
template void IslandSolver<3>::assemble_joints(const Island&, std::span<const BodyMass<3>>);
template void IslandSolver<3>::assemble_contacts(const Island&);
template void IslandSolver<3>::load_joints(const Island&, std::span<const Motion<3>>);
template void IslandSolver<3>::solve_contacts(const Island&);
template Wide IslandSolver<3>::take(const Island&, std::span<const BodyMass<3>>);

}  // namespace cycloid::solver
