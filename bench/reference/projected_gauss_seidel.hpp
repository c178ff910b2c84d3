#pragma once

#include <algorithm>
#include <vector>

#include "bench/reference/problem.hpp"

namespace cycloid::reference {

/// How to sweep over the rows.
struct PgsOptions {
  int sweeps = 10;              ///< At most so many.
  double sor = 1.0;             ///< Over-relaxation: the step is this times the exact one; 0..2.
  bool reverse = false;         ///< Last row first.
  bool alternate = false;       ///< Every second sweep in the opposite direction.
  std::vector<int> order = {};  ///< A permutation of the rows, or empty for 0..n-1.
  /// Clamps each increment to the bounds instead of the sum: the mistake that Catto's talk warns
  /// of, because an overshoot can then never be taken back. Only to be shown.
  bool incremental_clamp = false;
};

/// One row: lambda -= sor * w / A_ii, clamped. Rows with A_ii == 0 cannot be moved and are left.
template <class Real>
void solve_row(const Mlcp& problem, const PgsOptions& options, int row, std::vector<Real>& lambda) {
  const Real diagonal = static_cast<Real>(problem.at(row, row));
  if (!(diagonal > Real(0))) return;
  Real w = static_cast<Real>(problem.b[row]);
  for (int j = 0; j < problem.n; ++j) w += static_cast<Real>(problem.at(row, j)) * lambda[j];
  const Real increment = -static_cast<Real>(options.sor) * w / diagonal;
  const Bounds bounds = bounds_of(problem, lambda, row);
  const Real lower = static_cast<Real>(bounds.lower);
  const Real upper = static_cast<Real>(bounds.upper);
  if (options.incremental_clamp)
    lambda[row] += std::clamp(increment, lower, upper);
  else
    lambda[row] = std::clamp(lambda[row] + increment, lower, upper);
}

/// Projected Gauss-Seidel on the explicit matrix, in the arithmetic of `Real`, from `lambda`:
/// sequential impulses (Catto 2005) up to rounding. After each sweep calls
/// after_sweep(sweep, lambda), with sweep from 1, which returns false to stop.
/// Returns the last impulses. Preconditions: lambda has n entries.
template <class Real, class AfterSweep>
std::vector<Real> projected_gauss_seidel(const Mlcp& problem, const PgsOptions& options,
                                         std::vector<Real> lambda, AfterSweep&& after_sweep) {
  for (int sweep = 1; sweep <= options.sweeps; ++sweep) {
    const bool backward = options.reverse != (options.alternate && sweep % 2 == 0);
    for (int k = 0; k < problem.n; ++k) {
      const int place = backward ? problem.n - 1 - k : k;
      const int row = options.order.empty() ? place : options.order[place];
      solve_row(problem, options, row, lambda);
    }
    if (!after_sweep(sweep, lambda)) break;
  }
  return lambda;
}

/// The impulses after each sweep, from zero: entry k is after sweep k + 1.
template <class Real>
std::vector<std::vector<Real>> pgs_history(const Mlcp& problem, const PgsOptions& options) {
  std::vector<std::vector<Real>> history;
  projected_gauss_seidel(problem, options, std::vector<Real>(problem.n, Real(0)),
                         [&](int, const std::vector<Real>& lambda) {
                           history.push_back(lambda);
                           return true;
                         });
  return history;
}

}  // namespace cycloid::reference
