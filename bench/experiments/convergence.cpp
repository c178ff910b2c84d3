#include <array>
#include <cmath>

#include "bench/experiments/reports.hpp"
#include "bench/experiments/worlds.hpp"
#include "bench/reference/projected_gauss_seidel.hpp"

namespace cycloid::experiments {

using namespace solver;

static const char* const kTalk = "Catto 2014, error_{k+1} = alpha error_k";

/// Two balls whose masses make the rate r / (1 + r) of a sweep alpha.
static void check_rate(Report& report, double alpha, int sweeps, Curve& curve) {
  const double ratio = alpha / (1.0 - alpha);
  const std::vector<double> exact = exact_impulses({1.0, ratio});
  World<2> world = stack_of_balls({1.0, ratio}, velocities_only(1));
  const std::string name = "alpha = " + std::to_string(alpha).substr(0, 3);
  report.expect("sweeps to 5 %, " + name, "Catto 2014, alpha^k <= 5 %", sweeps,
                sweeps_to(world, exact, 0.05, 60), 0.0);
  curve.name = name;
  int sweep = 0;
  for (const std::vector<double>& now : impulses_by_sweep(world, 30)) {
    const double error = slowest_error(now, exact);
    ++sweep;
    if (error < 1.0e-6) break;
    curve.points.emplace_back(sweep, error);
    report.expect("error after sweep " + std::to_string(sweep) + ", " + name, kTalk,
                  std::pow(alpha, sweep), error, 2.0e-6);
  }
}

/// A lone constraint is exact after one solve, to a few units in the last place.
static void check_single(Report& report) {
  for (const double mass : {1.0, 0.37, 123.0}) {
    World<2> world = stack_of_balls({mass}, velocities_only(1));
    step(world);
    const double ulp = 1.2e-7 * kTickSpeed;
    report.expect("speed of a resting ball of " + std::to_string(mass) + " kg after one solve, m/s",
                  "Catto 2014: one constraint, one iteration", 0.0,
                  static_cast<double>(world.state().bodies[1].velocity[1]), 4.0 * ulp);
  }
}

/// Budget of the talk: what ten sweeps leave.
static void check_budget(Report& report) {
  const std::vector<double> masses = {1.0, 10.0};
  World<2> world = stack_of_balls(masses, velocities_only(1));
  report.expect("error after 10 sweeps, 10 kg on 1 kg", "(10/11)^10", std::pow(10.0 / 11.0, 10),
                slowest_error(impulses_by_sweep(world, 10).back(), exact_impulses(masses)), 2.0e-6);
}

/// Two equations, as a worked example of Gauss-Seidel, with the answer x = 1, y = 2.
static void check_toy(Report& report) {
  reference::Mlcp toy;
  toy.n = 2;
  toy.a = {4.0, 1.0, 1.0, 3.0};
  toy.b = {-6.0, -7.0};
  toy.lower.assign(2, -reference::kInfinity);
  toy.upper.assign(2, reference::kInfinity);
  toy.normal_of.assign(2, -1);
  toy.friction.assign(2, 0.0);
  const auto history = reference::pgs_history<double>(toy, {.sweeps = 12});
  const char* const source = "Sequential impulses explained (2020): 4 x + y = 6, x + 3 y = 7";
  report.expect("x of two equations after 12 sweeps", source, 1.0, history.back()[0], 1.0e-12);
  report.expect("y of two equations after 12 sweeps", source, 2.0, history.back()[1], 1.0e-12);
  report.expect("x after the first sweep", source, 1.5, history.front()[0], 1.0e-15);
  report.expect("error of x after sweep 2 over that after sweep 1", "1 / (4 * 3)", 1.0 / 12.0,
                (history[1][0] - 1.0) / (history[0][0] - 1.0), 1.0e-14);
}

Report convergence() {
  Report report{"convergence", {}, {}};
  std::vector<Curve> curves(3);
  check_rate(report, 0.3, 3, curves[0]);
  check_rate(report, 0.6, 6, curves[1]);
  check_rate(report, 0.9, 29, curves[2]);
  report.figures.push_back({"error-against-sweeps", "Error of two balls after each sweep", "sweeps",
                            "relative error of the impulses", false, true, curves});
  check_single(report);
  check_budget(report);
  check_toy(report);
  return report;
}

}  // namespace cycloid::experiments
