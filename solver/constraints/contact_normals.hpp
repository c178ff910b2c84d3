#pragma once

#include <cstdint>

#include "solver/constraints/block.hpp"

namespace cycloid::solver {

/// The normal rows of a manifold as one problem: w = K x + d >= 0, x >= 0, x . w = 0. A row that
/// does not exist has K = 1 on the diagonal, 0 beside it, and d = 0.
template <int N, class L>
struct NormalProblem {
  L k[N][N];
  L d[N];
};

/// max |min(x, w / K_ii)|: how far x >= 0 is from solving it, N s. 0 at solutions and only there.
template <int N, class L>
L normal_residual(const NormalProblem<N, L>& p, int count, const L (&x)[N]) {
  const L zero(0.0f);
  L worst = zero;
  for (int i = 0; i < count; ++i) {
    L w = p.d[i];
    for (int j = 0; j < count; ++j) w = w + p.k[i][j] * x[j];
    const L off = min(x[i], w / select(p.k[i][i] > zero, p.k[i][i], L(1.0f)));
    worst = max(worst, max(off, -off));
  }
  return worst;
}

/// x of the rows in `pushing`, 0 elsewhere: (1 + e) K x = -d on the diagonal, and twice refined
/// with K itself. Four points in one plane give K rank 3, two at one place rank 1: e makes x
/// unique - the one of least sum of K_ii x_i^2, which spreads the load evenly - and the refinement
/// takes out of w what e has put in: what is left is e^3, not e.
template <int N, class L>
void solve_pushing(const NormalProblem<N, L>& p, int count, std::uint32_t pushing, L (&x)[N]) {
  constexpr float kRidge = 1.0e-5f;
  constexpr int kRefinements = 2;
  int rows[N];
  int size = 0;
  for (int i = 0; i < count; ++i) {
    x[i] = L(0.0f);
    if ((pushing >> i & 1u) != 0) rows[size++] = i;
  }
  L k[N][N];
  for (int i = 0; i < size; ++i) {
    for (int j = 0; j < i; ++j) k[i][j] = p.k[rows[i]][rows[j]];
    k[i][i] = L(1.0f + kRidge) * p.k[rows[i]][rows[i]];
  }
  BlockFactor<N, L> factor;
  factor.factor(k, size);
  for (int pass = 0; pass <= kRefinements; ++pass) {
    L left[N];
    for (int i = 0; i < size; ++i) {
      left[i] = -p.d[rows[i]];
      for (int j = 0; j < size; ++j) left[i] = left[i] - p.k[rows[i]][rows[j]] * x[rows[j]];
    }
    factor.solve(left, size);
    for (int i = 0; i < size; ++i) x[rows[i]] = x[rows[i]] + left[i];
  }
}

/// Solves it by trying which rows push, the largest sets first, and taking the first whose solution
/// leaves a residual of at most 1e-5 of the impulses' size. That ends, takes the same steps in
/// every lane, and does not depend on where it starts; pivoting would branch by lane, and sweeps
/// inside the block leave the rate of Gauss-Seidel. `usable` is 0 where no set is so good; the
/// caller then solves the rows one after the other. Source: total enumeration (Murty, "Linear
/// Complementarity, Linear and Nonlinear Programming", 1988); the residual is the natural map.
/// @param count  rows that some lane has; more change nothing.
template <int N, int W>
void solve_normals(const NormalProblem<N, Lanes<W>>& p, int count, Lanes<W> (&x)[N],
                   Lanes<W>& usable) {
  using L = Lanes<W>;
  constexpr float kResidualMax = 1.0e-5f;
  // Which of four rows push, a bit per row: by falling size, then by rising first row. Cut to fewer
  // rows the order is that of fewer rows, so rows that do not exist change no bit.
  static constexpr std::uint32_t kPushing[15] = {0b1111, 0b0111, 0b1011, 0b1101, 0b1110,
                                                 0b0011, 0b0101, 0b1001, 0b0110, 0b1010,
                                                 0b1100, 0b0001, 0b0010, 0b0100, 0b1000};
  const L zero(0.0f);
  const L one(1.0f);
  L most = zero;
  for (int i = 0; i < count; ++i) {
    x[i] = zero;
    const L size = p.d[i] / select(p.k[i][i] > zero, p.k[i][i], one);
    most = max(most, max(size, -size));
  }
  most = L(kResidualMax) * most;
  usable = zero;
  const auto take_if_good = [&](const L(&found)[N]) {
    const L good = select(normal_residual(p, count, found) > most, zero, one);
    const auto takes = good > usable;
    for (int i = 0; i < count; ++i) x[i] = select(takes, found[i], x[i]);
    usable = max(usable, good);
  };
  for (const std::uint32_t pushing : kPushing) {
    if (pushing >> count != 0) continue;
    L found[N];
    solve_pushing(p, count, pushing, found);
    for (int i = 0; i < count; ++i) found[i] = max(found[i], zero);
    take_if_good(found);
    if (all_above_zero(usable)) return;  // No later set would be taken in any lane.
  }
  L none[N];
  for (int i = 0; i < count; ++i) none[i] = zero;
  take_if_good(none);
}

}  // namespace cycloid::solver
