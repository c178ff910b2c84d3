#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace cycloid::reference {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A mixed linear complementarity problem: find impulses `lambda` (N s, or N m s for angular rows)
/// so that the velocities after them, w = A lambda + b (m/s or rad/s), obey per row:
/// lower <= lambda <= upper, with w == 0 inside, w >= 0 at lower and w <= 0 at upper.
/// Friction rows (normal_of >= 0) have the bounds -+ friction * lambda of their normal, as it is in
/// the same solution, not as it was before it.
/// Preconditions: all vectors have n entries (a: n * n), a is symmetric and positive semidefinite,
/// lower <= upper, a normal has lower >= 0 and is no friction row. Bounds of friction rows are not
/// read. Source: Baraff 1994, "Fast contact force computation for nonpenetrating rigid bodies".
struct Mlcp {
  int n = 0;
  std::vector<double> a;         ///< J M^-1 J^T, row-major, 1/kg for linear rows.
  std::vector<double> b;         ///< J v before the impulses.
  std::vector<double> lower;     ///< -kInfinity where there is none.
  std::vector<double> upper;     ///< kInfinity where there is none.
  std::vector<int> normal_of;    ///< The row whose impulse bounds this friction row, or -1.
  std::vector<double> friction;  ///< Coefficient, 0 in rows that are no friction rows.

  double at(int row, int column) const { return a[static_cast<std::size_t>(row) * n + column]; }
};

/// What one row may take.
struct Bounds {
  double lower;
  double upper;
};

/// The bounds of a row under these impulses. A normal below 0 (which no solution has) bounds its
/// friction at 0.
template <class Real>
Bounds bounds_of(const Mlcp& problem, const std::vector<Real>& lambda, int row) {
  const int normal = problem.normal_of[row];
  if (normal < 0) return {problem.lower[row], problem.upper[row]};
  const double bound = problem.friction[row] * std::max<double>(lambda[normal], 0.0);
  return {-bound, bound};
}

/// w = A lambda + b, summed in ascending columns.
inline std::vector<double> velocities(const Mlcp& problem, const std::vector<double>& lambda) {
  std::vector<double> w = problem.b;
  for (int i = 0; i < problem.n; ++i)
    for (int j = 0; j < problem.n; ++j) w[i] += problem.at(i, j) * lambda[j];
  return w;
}

/// A problem together with the bodies it came from, which are needed where the impulses are not
/// unique but what they do is.
struct Assembled {
  Mlcp problem;
  int dof = 0;
  std::vector<double> jacobian;      ///< n x dof, row-major.
  std::vector<double> inverse_mass;  ///< dof entries, 1/kg or 1/(kg m^2): M is diagonal.
  std::vector<double> velocity;      ///< dof entries, before the impulses.
};

/// Rows of contacts without friction (0 <= lambda) over these bodies; the caller may then change
/// bounds and make rows friction rows. Preconditions: jacobian has n * dof entries.
inline Assembled assemble(int n, const std::vector<double>& jacobian,
                          const std::vector<double>& inverse_mass,
                          const std::vector<double>& velocity) {
  const int dof = static_cast<int>(inverse_mass.size());
  Assembled result{{}, dof, jacobian, inverse_mass, velocity};
  Mlcp& problem = result.problem;
  problem.n = n;
  problem.a.assign(static_cast<std::size_t>(n) * n, 0.0);
  problem.b.assign(n, 0.0);
  problem.lower.assign(n, 0.0);
  problem.upper.assign(n, kInfinity);
  problem.normal_of.assign(n, -1);
  problem.friction.assign(n, 0.0);
  for (int i = 0; i < n; ++i)
    for (int d = 0; d < dof; ++d) {
      const double entry = jacobian[static_cast<std::size_t>(i) * dof + d];
      problem.b[i] += entry * velocity[d];
      for (int j = 0; j < n; ++j)
        problem.a[static_cast<std::size_t>(i) * n + j] +=
            entry * inverse_mass[d] * jacobian[static_cast<std::size_t>(j) * dof + d];
    }
  return result;
}

/// Velocities of the bodies after these impulses: v + M^-1 J^T lambda.
inline std::vector<double> body_velocities(const Assembled& assembled,
                                           const std::vector<double>& lambda) {
  std::vector<double> velocity = assembled.velocity;
  for (int i = 0; i < assembled.problem.n; ++i)
    for (int d = 0; d < assembled.dof; ++d)
      velocity[d] += assembled.inverse_mass[d] *
                     assembled.jacobian[static_cast<std::size_t>(i) * assembled.dof + d] *
                     lambda[i];
  return velocity;
}

}  // namespace cycloid::reference
