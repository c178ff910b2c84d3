#include "bench/reference/direct.hpp"

#include <Eigen/Dense>
#include <cmath>

#include "bench/reference/lemke.hpp"
#include "bench/reference/projected_gauss_seidel.hpp"
#include "bench/reference/residual.hpp"

namespace cycloid::reference {

using Eigen::MatrixXd;
using Eigen::VectorXd;

static constexpr double kConverged = 1e-10;
static constexpr double kRank = 1e-10;   ///< Pivots below this times the largest are 0.
static constexpr double kActive = 1e-8;  ///< Velocities below this, of order 1, are 0.
static constexpr int kFallbackSweeps = 20000;

/// The same problem in units in which A has a unit diagonal and b is of order 1: impulses are
/// divided by `impulse`, velocities multiplied by `velocity`, row by row.
struct Scaled {
  Mlcp problem;
  std::vector<double> impulse;
};

static Scaled scale(const Mlcp& problem) {
  Scaled scaled{problem, std::vector<double>(problem.n, 1.0)};
  std::vector<double> root(problem.n, 1.0);
  double size = 0.0;
  for (int i = 0; i < problem.n; ++i) {
    if (problem.at(i, i) > 0.0) root[i] = 1.0 / std::sqrt(problem.at(i, i));
    size = std::max(size, std::abs(problem.b[i]) * root[i]);
  }
  if (size == 0.0) size = 1.0;
  Mlcp& result = scaled.problem;
  for (int i = 0; i < problem.n; ++i) {
    for (int j = 0; j < problem.n; ++j)
      result.a[static_cast<std::size_t>(i) * problem.n + j] *= root[i] * root[j];
    result.b[i] *= root[i] / size;
    scaled.impulse[i] = root[i] * size;
    result.lower[i] /= scaled.impulse[i];
    result.upper[i] /= scaled.impulse[i];
    if (problem.normal_of[i] >= 0) result.friction[i] *= root[problem.normal_of[i]] / root[i];
  }
  return scaled;
}

static MatrixXd matrix_of(const Mlcp& problem) {
  return Eigen::Map<const Eigen::Matrix<double, -1, -1, Eigen::RowMajor>>(problem.a.data(),
                                                                          problem.n, problem.n);
}

static bool is_free(const Mlcp& problem, int row) {
  return problem.normal_of[row] < 0 && problem.lower[row] == -kInfinity &&
         problem.upper[row] == kInfinity;
}

/// True where the bounds leave no choice. A friction row's do where mu is 0.
static bool is_fixed(const Mlcp& problem, int row) {
  return problem.normal_of[row] < 0 ? problem.lower[row] == problem.upper[row]
                                    : !(problem.friction[row] > 0.0);
}

/// lambda = c z + c0 in the rows that are not free, with z >= 0 complementary to
/// c^T w + coupling z + constant.
struct Variables {
  MatrixXd c;
  VectorXd c0;
  MatrixXd coupling;
  VectorXd constant;
};

static int variables_of(const Mlcp& problem, int row) {
  if (is_free(problem, row) || is_fixed(problem, row)) return 0;
  if (problem.normal_of[row] >= 0) return 3;
  return std::isfinite(problem.lower[row]) && std::isfinite(problem.upper[row]) ? 2 : 1;
}

/// A row with constant bounds: z counts from the finite one, and where both are, a multiplier
/// stands for what holds the row at the upper one.
static void add_bounded(const Mlcp& problem, int row, int at, int count, Variables& variables) {
  const bool from_lower = std::isfinite(problem.lower[row]);
  variables.c0[row] = from_lower ? problem.lower[row] : problem.upper[row];
  if (count == 0) return;
  variables.c(row, at) = from_lower ? 1.0 : -1.0;
  if (count == 1) return;
  variables.coupling(at, at + 1) = 1.0;
  variables.coupling(at + 1, at) = -1.0;
  variables.constant[at + 1] = problem.upper[row] - problem.lower[row];
}

/// A friction row: an impulse each way, and the speed of sliding as the multiplier that is
/// complementary to what the cone leaves. `normal_at` is the variable of the normal, -1 where its
/// impulse is constant.
static void add_friction(const Mlcp& problem, int row, int at, int normal_at,
                         Variables& variables) {
  const double friction = problem.friction[row];
  variables.c(row, at) = 1.0;
  variables.c(row, at + 1) = -1.0;
  for (const int way : {at, at + 1}) {
    variables.coupling(way, at + 2) = 1.0;
    variables.coupling(at + 2, way) = -1.0;
  }
  if (normal_at >= 0) variables.coupling(at + 2, normal_at) = friction;
  variables.constant[at + 2] = friction * problem.lower[problem.normal_of[row]];
}

static Variables variables_of(const Mlcp& problem) {
  std::vector<int> first(problem.n + 1, 0);
  for (int i = 0; i < problem.n; ++i) first[i + 1] = first[i] + variables_of(problem, i);
  const int m = first[problem.n];
  Variables variables{MatrixXd::Zero(problem.n, m), VectorXd::Zero(problem.n), MatrixXd::Zero(m, m),
                      VectorXd::Zero(m)};
  for (int i = 0; i < problem.n; ++i) {
    const int count = first[i + 1] - first[i];
    const int normal = problem.normal_of[i];
    if (is_free(problem, i)) continue;
    if (normal < 0) {
      add_bounded(problem, i, first[i], count, variables);
    } else if (count > 0) {
      const int normal_at = first[normal + 1] > first[normal] ? first[normal] : -1;
      add_friction(problem, i, first[i], normal_at, variables);
    }
  }
  return variables;
}

/// The free rows solved for: lambda_free = gain lambda + offset makes their w 0, with columns of
/// free rows in `gain` 0 and rows of others 0. Of least norm where they are redundant.
struct Elimination {
  MatrixXd gain;
  VectorXd offset;
};

static Elimination eliminate_free(const Mlcp& problem, const MatrixXd& a, const VectorXd& b) {
  Elimination elimination{MatrixXd::Zero(problem.n, problem.n), VectorXd::Zero(problem.n)};
  std::vector<int> free;
  for (int i = 0; i < problem.n; ++i)
    if (is_free(problem, i)) free.push_back(i);
  if (free.empty()) return elimination;
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> factors;
  factors.setThreshold(kRank);
  factors.compute(a(free, free));
  MatrixXd others = a(free, Eigen::all);
  for (const int row : free) others.col(row).setZero();
  elimination.gain(free, Eigen::all) = -factors.solve(others);
  elimination.offset(free) = -factors.solve(b(free));
  return elimination;
}

/// One attempt: what Lemke's method comes to, as impulses of the scaled problem. The covering
/// vector rises by `covering_slope` from the first row to the last.
static std::vector<double> attempt(const Mlcp& problem, double covering_slope, int& pivots) {
  const MatrixXd a = matrix_of(problem);
  const VectorXd b = Eigen::Map<const VectorXd>(problem.b.data(), problem.n);
  const Variables variables = variables_of(problem);
  const Elimination free = eliminate_free(problem, a, b);
  const MatrixXd reduced = a + a * free.gain;
  const VectorXd reduced_b = b + a * free.offset;
  const MatrixXd matrix = variables.c.transpose() * reduced * variables.c + variables.coupling;
  const VectorXd q =
      variables.c.transpose() * (reduced * variables.c0 + reduced_b) + variables.constant;
  const int m = static_cast<int>(q.size());
  VectorXd covering(m);
  for (int i = 0; i < m; ++i) covering[i] = 1.0 + covering_slope * (i + 1) / m;
  const LemkeResult result = solve_lemke(matrix, q, covering, 100 + 20 * m);
  pivots += result.pivots;
  VectorXd lambda = variables.c * result.z + variables.c0;
  lambda += (free.gain * lambda + free.offset).eval();
  return std::vector<double>(lambda.data(), lambda.data() + problem.n);
}

/// What each row does in a solution, and with it the equations that remain.
struct States {
  std::vector<int> active;  ///< Rows whose w is 0, and whose bounds leave a choice.
  MatrixXd reduced;         ///< lambda = reduced * lambda_active + fixed.
  VectorXd fixed;
};

static States states_of(const Mlcp& problem, const std::vector<double>& lambda) {
  const std::vector<double> w = velocities(problem, lambda);
  States states{{}, {}, VectorXd::Zero(problem.n)};
  std::vector<int> place(problem.n, -1);
  for (int i = 0; i < problem.n; ++i)
    if (std::abs(w[i]) <= kActive && !is_fixed(problem, i)) {
      place[i] = static_cast<int>(states.active.size());
      states.active.push_back(i);
    }
  states.reduced = MatrixXd::Zero(problem.n, static_cast<int>(states.active.size()));
  for (int i = 0; i < problem.n; ++i) {
    const int normal = problem.normal_of[i];
    if (place[i] >= 0) {
      states.reduced(i, place[i]) = 1.0;
    } else if (normal >= 0 && place[normal] >= 0) {
      states.reduced(i, place[normal]) = w[i] > 0.0 ? -problem.friction[i] : problem.friction[i];
    } else {
      const Bounds bounds = bounds_of(problem, lambda, i);
      const double bound = w[i] > 0.0 ? bounds.lower : bounds.upper;
      states.fixed[i] = std::isfinite(bound) ? bound : lambda[i];
    }
  }
  return states;
}

/// Solves the active rows as equations with the other rows held at their bounds, in the least
/// norm. What comes back may break the bounds of active rows; the caller compares residuals.
static std::vector<double> polished(const Mlcp& problem, const std::vector<double>& lambda) {
  const States states = states_of(problem, lambda);
  if (states.active.empty())
    return std::vector<double>(states.fixed.data(), states.fixed.data() + problem.n);
  const MatrixXd a = matrix_of(problem);
  const VectorXd b = Eigen::Map<const VectorXd>(problem.b.data(), problem.n);
  const MatrixXd rows = a(states.active, Eigen::all);
  const VectorXd right = -(rows * states.fixed + b(states.active));
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> factors;
  factors.setThreshold(kRank);
  factors.compute(rows * states.reduced);
  VectorXd active = factors.solve(right);
  active += factors.solve(right - rows * (states.reduced * active));
  const VectorXd result = states.reduced * active + states.fixed;
  return std::vector<double>(result.data(), result.data() + problem.n);
}

/// The polished impulses where they solve the problem no worse than needed, else the given ones.
static std::vector<double> better_of(const Mlcp& problem, const std::vector<double>& lambda) {
  const std::vector<double> candidate = polished(problem, lambda);
  const double before = residual_of(problem, lambda).relative;
  const double after = residual_of(problem, candidate).relative;
  return after <= std::max(before, 0.01 * kConverged) ? candidate : lambda;
}

static int rank_of(const Mlcp& problem, const std::vector<int>& rows) {
  if (rows.empty()) return 0;
  Eigen::ColPivHouseholderQR<MatrixXd> factors;
  factors.setThreshold(kRank);
  factors.compute(matrix_of(problem)(rows, rows));
  return static_cast<int>(factors.rank());
}

static bool is_supported(const Mlcp& problem) {
  for (int i = 0; i < problem.n; ++i)
    if (problem.normal_of[i] >= 0 && !(problem.lower[problem.normal_of[i]] >= 0.0)) return false;
  return true;
}

/// Impulses of the scaled problem: Lemke's method from several directions, then, because rounding
/// may still have led all of them into a ray, sweeps and the equations that they point to.
static std::vector<double> solve_scaled(const Mlcp& problem, int& pivots) {
  std::vector<double> best(problem.n, 0.0);
  double best_residual = residual_of(problem, best).relative;
  const auto consider = [&](const std::vector<double>& lambda) {
    const std::vector<double> candidate = better_of(problem, lambda);
    const double residual = residual_of(problem, candidate).relative;
    if (!(residual < best_residual)) return;
    best = candidate;
    best_residual = residual;
  };
  for (const double slope : {0.0, 1.0, -0.5, 3.0}) {
    if (best_residual <= kConverged) return best;
    consider(attempt(problem, slope, pivots));
  }
  if (best_residual <= kConverged) return best;
  PgsOptions options;
  options.sweeps = kFallbackSweeps;
  consider(projected_gauss_seidel(problem, options, std::vector<double>(problem.n, 0.0),
                                  [](int, const std::vector<double>&) { return true; }));
  return best;
}

DirectResult solve_direct(const Mlcp& problem) {
  DirectResult result;
  const Scaled scaled = scale(problem);
  result.lambda.assign(problem.n, 0.0);
  if (is_supported(problem)) result.lambda = solve_scaled(scaled.problem, result.pivots);
  const std::vector<int> active = states_of(scaled.problem, result.lambda).active;
  result.rank = rank_of(scaled.problem, active);
  result.rank_deficient = result.rank < static_cast<int>(active.size());
  for (int i = 0; i < problem.n; ++i) result.lambda[i] *= scaled.impulse[i];
  result.w = velocities(problem, result.lambda);
  result.residual = residual_of(problem, result.lambda).relative;
  result.converged = is_supported(problem) && result.residual <= kConverged;
  return result;
}

}  // namespace cycloid::reference
