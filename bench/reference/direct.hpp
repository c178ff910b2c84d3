#pragma once

#include <vector>

#include "bench/reference/problem.hpp"

namespace cycloid::reference {

/// A solution to working precision.
struct DirectResult {
  std::vector<double> lambda;   ///< Impulses (N s).
  std::vector<double> w;        ///< Velocities after them, A lambda + b (m/s).
  double residual = 0.0;        ///< Residual::relative: the natural map over the size of impulses.
  int rank = 0;                 ///< Of A over the active rows: w is 0 and lower < upper.
  bool rank_deficient = false;  ///< Fewer than the active rows: the impulses are not unique.
  bool converged = false;       ///< residual <= 1e-10.
  int pivots = 0;               ///< Of Lemke's method, over all attempts.
};

/// Solves the problem, with friction coupled to its normals, by Lemke's method with one friction
/// direction each way and one multiplier per friction row (Stewart and Trinkle 1996, in the plane),
/// after free rows are eliminated. The basis found is solved once more as linear equations; of many
/// solutions it gives the one of least norm over diag(A), as far as that one keeps the bounds.
/// Always returns: converged is false where no solution was found in bounded time, where free rows
/// contradict each other, and where a normal may pull (lower < 0), which this does not treat.
/// lambda is then the best found.
DirectResult solve_direct(const Mlcp& problem);

}  // namespace cycloid::reference
