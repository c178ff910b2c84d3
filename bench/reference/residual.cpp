#include "bench/reference/residual.hpp"

#include <cmath>

namespace cycloid::reference {

/// A_ii, or what stands for it in a row that no impulse moves.
static double diagonal_of(const Mlcp& problem, int row) {
  if (problem.at(row, row) > 0.0) return problem.at(row, row);
  double largest = 0.0;
  for (int j = 0; j < problem.n; ++j) largest = std::max(largest, problem.at(j, j));
  return largest > 0.0 ? largest : 1.0;
}

static double velocity_of(const Mlcp& problem, const std::vector<double>& lambda, int row) {
  double w = problem.b[row];
  for (int j = 0; j < problem.n; ++j) w += problem.at(row, j) * lambda[j];
  return w;
}

/// Work against the bound that a row with this velocity has to be at.
static double work(double lambda, double w, const Bounds& bounds) {
  const double bound = w > 0.0 ? bounds.lower : bounds.upper;
  const double away = std::isfinite(bound) ? lambda - bound : lambda;
  return std::abs(away * w);
}

/// |difference| / |exact| of two norms that may be 0.
static double ratio(double difference, double exact) {
  if (difference == 0.0) return 0.0;
  return exact > 0.0 ? difference / exact : kInfinity;
}

double natural_map(const Mlcp& problem, const std::vector<double>& lambda, int row) {
  const Bounds bounds = bounds_of(problem, lambda, row);
  const double w = velocity_of(problem, lambda, row);
  const double solved = lambda[row] - w / diagonal_of(problem, row);
  return lambda[row] - std::clamp(solved, bounds.lower, bounds.upper);
}

Residual residual_of(const Mlcp& problem, const std::vector<double>& lambda) {
  Residual residual;
  for (int i = 0; i < problem.n; ++i) {
    const Bounds bounds = bounds_of(problem, lambda, i);
    const double w = velocity_of(problem, lambda, i);
    residual.natural_map =
        std::max(residual.natural_map, std::abs(natural_map(problem, lambda, i)));
    residual.complementarity = std::max(residual.complementarity, work(lambda[i], w, bounds));
    residual.outside =
        std::max({residual.outside, bounds.lower - lambda[i], lambda[i] - bounds.upper});
    residual.impulse_scale = std::max({residual.impulse_scale, std::abs(lambda[i]),
                                       std::abs(problem.b[i]) / diagonal_of(problem, i)});
  }
  residual.relative = ratio(residual.natural_map, residual.impulse_scale);
  return residual;
}

ImpulseError impulse_error(const std::vector<double>& lambda, const std::vector<double>& exact) {
  double largest = 0.0;
  for (const double value : exact) largest = std::max(largest, std::abs(value));
  ImpulseError error{0.0, 0.0};
  double difference_squared = 0.0;
  double exact_squared = 0.0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const double difference = std::abs(lambda[i] - exact[i]);
    const bool is_zero = std::abs(exact[i]) <= 1e-12 * largest;
    error.max = std::max(error.max, ratio(difference, is_zero ? largest : std::abs(exact[i])));
    difference_squared += difference * difference;
    exact_squared += exact[i] * exact[i];
  }
  error.l2 = ratio(std::sqrt(difference_squared), std::sqrt(exact_squared));
  return error;
}

double wrench_error(const std::vector<double>& jacobian, int dof, const std::vector<double>& lambda,
                    const std::vector<double>& exact) {
  double difference_squared = 0.0;
  double exact_squared = 0.0;
  for (int d = 0; d < dof; ++d) {
    double difference = 0.0;
    double wrench = 0.0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
      const double entry = jacobian[i * static_cast<std::size_t>(dof) + d];
      difference += entry * (lambda[i] - exact[i]);
      wrench += entry * exact[i];
    }
    difference_squared += difference * difference;
    exact_squared += wrench * wrench;
  }
  return ratio(std::sqrt(difference_squared), std::sqrt(exact_squared));
}

double velocity_error(const Mlcp& problem, const std::vector<double>& lambda,
                      const std::vector<double>& exact) {
  double difference_squared = 0.0;
  double exact_squared = 0.0;
  for (int i = 0; i < problem.n; ++i)
    for (int j = 0; j < problem.n; ++j) {
      difference_squared += (lambda[i] - exact[i]) * problem.at(i, j) * (lambda[j] - exact[j]);
      exact_squared += exact[i] * problem.at(i, j) * exact[j];
    }
  return ratio(std::sqrt(std::max(difference_squared, 0.0)),
               std::sqrt(std::max(exact_squared, 0.0)));
}

}  // namespace cycloid::reference
