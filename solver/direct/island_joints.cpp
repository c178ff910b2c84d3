#include <algorithm>

#include "solver/direct/island_parts.hpp"

namespace cycloid::solver {

/// The most that a body is taken to turn in a substep, rad: beyond it the second order tells
/// little, and what a jam spins for a moment would throw all that it is jointed to.
static constexpr Wide kGuessedTurn_rad = 0.1;
/// As fast as joints that are apart may move any body by closing, m/s, ...
static constexpr Wide kMoved = 0.5;
/// ... or this share of the speed at which the worst of them would close by itself.
static constexpr Wide kMovedShare = 0.12;

/// Joints that would close more slowly, m/s or rad/s, are let be until they have more to close: of
/// 60 Hz it is the hundredth part of a millimetre, for which a solve is a tenth of a substep.
static constexpr Wide kLetBe = 1.0e-3;

/// The spin of a node before the first guess, at most kGuessedTurn_rad in a substep.
template <int D>
static Vec<Dim<D>::kSpin, Wide> spin_before(const Motion<D>& motion,
                                            const Vec<Dim<D>::kFreedoms, Wide>& guess, Wide h) {
  Vec<Dim<D>::kSpin, Wide> spin;
  Wide square = 0.0;
  for (int i = 0; i < Dim<D>::kSpin; ++i) {
    spin[i] = static_cast<Wide>(motion.spin[i]) - guess[D + i];
    square += spin[i] * spin[i];
  }
  const Wide most = kGuessedTurn_rad / h;
  if (!(square > most * most)) return spin;
  const Wide scale = most / root(square);
  for (int i = 0; i < Dim<D>::kSpin; ++i) spin[i] *= scale;
  return spin;
}

/// Adds to what the points of joints miss by how fast they part because their bodies turn: a step
/// moves them along tangents, so that a chain that swings would part by h^2 w^2 r / 2 in each one,
///   C(t + h) - C(t) = h Cdot + h^2/2 (w_b x (w_b x r_b) - w_a x (w_a x r_a)) + O(h^3).
/// A bias takes that back only once it is there, and along rows that have turned since.
/// Source: the end of the step is what is constrained, with directions of its begin, as in SHAKE
/// (Ryckaert, Ciccotti, Berendsen 1977); of its iteration this is the first guess.
/// @pre `momentum_` has the velocities that the first guess is of: its spins are of no motion.
template <int D>
void IslandSolver<D>::foresee_turns(const Island& island, std::span<const Motion<D>> motions,
                                    Wide h) {
  for (const IslandRows<D>& group : joints_of(island)) {
    Vec<D, Wide> parting = Vec<D, Wide>::zero();
    const auto add = [&](int node, const Vec<D, Wide>& arm, Wide scale) {
      if (node < 0) return;
      const auto at = static_cast<std::size_t>(node);
      const auto spin = spin_before<D>(motions[body_of[at]], momentum_[at], h);
      const Vec<D, Wide> towards = centripetal(spin, arm);
      for (int i = 0; i < D; ++i) parting[i] += scale * towards[i];
    };
    add(group.node_a, group.arm_a, -0.5 * h);
    add(group.node_b, group.arm_b, 0.5 * h);
    IslandRow<D>* row = first_row(group);
    for (int r = 0; r < group.points; ++r) row[r].missing += parting[r];
    for (int r = group.points; r < group.count; ++r)
      for (int i = 0; i < D; ++i) row[r].missing += row[r].b[i] * parting[i];
  }
}

/// The speed at which the worst of the joints would close by itself, m/s or rad/s; and whether that
/// is worth it.
template <int D>
Wide IslandSolver<D>::closing_speed(Island& island) const {
  Wide greatest_square = 0.0;
  for (const IslandRows<D>& group : joints_of(island)) {
    const IslandRow<D>* row = first_row(group);
    Wide square = 0.0;
    for (int r = 0; r < group.count; ++r) square += row[r].closing * row[r].closing;
    greatest_square = std::max(greatest_square, square);
  }
  const Wide fastest = root(greatest_square);
  island.closes = fastest >= kLetBe;
  return fastest;
}

/// Has the joints miss what closes them, too, as far as that moves no body fast: the links of a
/// chain that is all but straight have to go a long way aside for a little of its length, and what
/// they are thrown with stays in the world as energy. How fast it would is known once it is solved;
/// so what is missed is solved beside it, and the sum of the two is the solution.
/// @pre the matrix is factored.
template <int D>
void IslandSolver<D>::solve_and_close(const Island& island, std::span<const Motion<D>> motions,
                                      Wide fastest) {
  load_both(island, motions);
  matrix.solve_lower({island.steps.begin, island.contact_steps.begin}, both_);
  copy(island, both_, kept_both_);
  for (const IslandRows<D>& group : contacts_of(island)) {
    const IslandRow<D>* row = first_row(group);
    push_rows<D, WidePair>(group, row, both_, [](const IslandRow<D>& of) {
      return WidePair(of.holds ? -of.stiffness * of.missing : 0.0, 0.0);
    });
  }
  matrix.solve_lower(island.contact_steps, both_);
  matrix.solve_upper(island.steps, both_);
  for (int n = island.nodes.begin; n < island.nodes.end; ++n)
    for (int i = 0; i < kFreedoms; ++i)
      correction[static_cast<std::size_t>(n)][i] = both_[static_cast<std::size_t>(n)][i].raw[1];
  const Wide share = share_of_correction(island, std::max(kMoved, kMovedShare * fastest));
  for (int n = island.nodes.begin; n < island.nodes.end; ++n) {
    const auto node = static_cast<std::size_t>(n);
    for (int i = 0; i < kFreedoms; ++i) {
      solution_[node][i] = both_[node][i].raw[0] + share * both_[node][i].raw[1];
      kept_[node][i] = kept_both_[node][i].raw[0] + share * kept_both_[node][i].raw[1];
    }
  }
  for (const IslandRows<D>& group : joints_of(island))
    for (IslandRow<D>& row : rows_of(group)) row.missing += share * row.closing;
}

/// -J^T W missing of joints and tensions, and -J^T W closing beside it.
template <int D>
void IslandSolver<D>::load_both(const Island& island, std::span<const Motion<D>> motions) {
  set_zero(island, both_);
  for (const IslandTension<D>& tension : tensions_of(island)) {
    const Spin<D, Wide> pull = pull_of(tension, motions);
    for (int i = 0; i < Dim<D>::kSpin; ++i)
      both_[static_cast<std::size_t>(tension.node)][D + i] -= WidePair(pull[i], 0.0);
  }
  for (const IslandRows<D>& group : joints_of(island)) {
    const IslandRow<D>* row = first_row(group);
    push_rows<D, WidePair>(group, row, both_, [](const IslandRow<D>& of) {
      return -of.stiffness * WidePair(of.missing, of.closing);
    });
  }
}

template void IslandSolver<2>::foresee_turns(const Island&, std::span<const Motion<2>>, Wide);
template void IslandSolver<3>::foresee_turns(const Island&, std::span<const Motion<3>>, Wide);
template Wide IslandSolver<2>::closing_speed(Island&) const;
template Wide IslandSolver<3>::closing_speed(Island&) const;
template void IslandSolver<2>::solve_and_close(const Island&, std::span<const Motion<2>>, Wide);
template void IslandSolver<3>::solve_and_close(const Island&, std::span<const Motion<3>>, Wide);

}  // namespace cycloid::solver
