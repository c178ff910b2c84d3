#include <cmath>

#include "bench/experiments/reports.hpp"
#include "bench/experiments/worlds.hpp"

namespace cycloid::experiments {

using namespace solver;

static int sweeps_of(const std::vector<double>& masses, Order order) {
  World<2> world = stack_of_balls(masses, velocities_only(1, order));
  return sweeps_to(world, exact_impulses(masses), 0.05, 1300);
}

/// Counts of a stack with n = 1, 2, ... balls, the top one of mass `top`.
static Curve check_heights(Report& report, double top, Order order,
                           const std::vector<int>& counts) {
  const std::string name = order == Order::kId ? "bottom-up" : "top-down";
  Curve curve{name, {}};
  for (std::size_t n = 1; n <= counts.size(); ++n) {
    std::vector<double> masses(n, 1.0);
    masses.back() = top;
    const int sweeps = sweeps_of(masses, order);
    report.expect("sweeps to 5 %, " + name + ", " + std::to_string(n) + " balls, top ball of " +
                      std::to_string(top) + " kg",
                  "methods 3.3, exact arithmetic", counts[n - 1], sweeps, 0.0);
    curve.points.emplace_back(static_cast<double>(n), sweeps);
  }
  return curve;
}

/// The rate of Gauss-Seidel on a stack of n is cos^2(pi / 2n): measured far into the tail.
static void check_rate_of_stack(Report& report) {
  const std::vector<double> masses(4, 1.0);
  const std::vector<double> exact = exact_impulses(masses);
  World<2> world = stack_of_balls(masses, velocities_only(1));
  const auto impulses = impulses_by_sweep(world, 31);
  const double ratio = (exact[3] - impulses[30][3]) / (exact[3] - impulses[20][3]);
  const double pi = 3.14159265358979323846;
  // Over ten sweeps, so that rounding of the impulses matters less.
  report.expect("error after a sweep over error before it, four equal balls", "cos^2(pi / 2 n)",
                std::pow(std::cos(pi / 8.0), 2), std::pow(ratio, 0.1), 1.0e-4);
}

Report stacks() {
  Report report{"stacks", {}, {}};
  const Curve up = check_heights(report, 1.0, Order::kId, {1, 5, 11, 20, 31, 45, 61, 81, 102, 127});
  const Curve down =
      check_heights(report, 1.0, Order::kReverse, {1, 6, 13, 23, 35, 50, 67, 88, 110, 136});
  Curve square{"1.31 n^2", {}};
  for (int n = 1; n <= 10; ++n) square.points.emplace_back(n, 1.31 * n * n);
  report.figures.push_back({"sweeps-against-stack-height",
                            "Sweeps to 5 % for equal balls",
                            "balls",
                            "sweeps",
                            true,
                            true,
                            {up, down, square}});
  check_heights(report, 0.5, Order::kId, {1, 3, 8, 15, 25, 38, 53, 71, 91, 114});
  check_heights(report, 10.0, Order::kId, {1, 32, 65, 100, 138, 178, 221, 266, 313, 364});
  check_heights(report, 10.0, Order::kReverse, {1, 33, 67, 103, 142, 183, 227, 273, 321, 373});
  check_heights(report, 50.0, Order::kId, {1, 152, 305, 460, 617});
  check_rate_of_stack(report);
  return report;
}

}  // namespace cycloid::experiments
