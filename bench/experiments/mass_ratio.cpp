#include <array>
#include <cmath>

#include "bench/experiments/reports.hpp"
#include "bench/experiments/worlds.hpp"

namespace cycloid::experiments {

using namespace solver;

static const char* const kScript = "Catto 2014, MassRatioConvergence.m: cold start, 5 %";

static int sweeps_at_ratio(double ratio, Order order, double tolerance = 0.05) {
  World<2> world = stack_of_balls({1.0, ratio}, velocities_only(1, order));
  return sweeps_to(world, exact_impulses({1.0, ratio}), tolerance, 600);
}

/// The same count in other units of mass, length of tick and gravity.
static int sweeps_in_units(double ratio, double mass, double gravity, double tick_s) {
  World<2> world = make_world(velocities_only(1), {0.0f}, gravity, tick_s);
  add_ground(world);
  add(world, ball(0.5), 0.0, 0.5, mass);
  add(world, ball(0.5), 0.0, 1.5, mass * ratio);
  return sweeps_to(world, exact_impulses({mass, mass * ratio}, gravity * tick_s), 0.05, 600);
}

static std::string at(const char* what, double ratio) {
  return std::string(what) + " at mass ratio " + std::to_string(static_cast<int>(ratio)) + ":1";
}

/// Every whole ratio to 50, in both orders.
static void check_whole_ratios(Report& report) {
  Curve up{"bottom-up", {}};
  Curve down{"top-down", {}};
  Curve line{"3 r + 2", {}};
  for (int r = 1; r <= 50; ++r) {
    const int sweeps = sweeps_at_ratio(r, Order::kId);
    const int reverse = sweeps_at_ratio(r, Order::kReverse);
    report.expect(at("sweeps, bottom-up,", r), kScript, 3.0 * r + 2.0, sweeps, 0.0);
    report.expect(at("sweeps, top-down,", r), kScript, 3.0 * r + 3.0, reverse, 0.0);
    up.points.emplace_back(r, sweeps);
    down.points.emplace_back(r, reverse);
    line.points.emplace_back(r, 3.0 * r + 2.0);
  }
  report.figures.push_back({"convergence-against-mass-ratio",
                            "Sweeps to 5 % for a heavy ball on a light one",
                            "mass ratio r",
                            "sweeps",
                            false,
                            false,
                            {up, down, line}});
}

/// Below 1:1, beyond 50:1 and to 1 %.
static void check_other_ratios(Report& report) {
  struct Case {
    double ratio;
    int up;
    int down;
  };
  for (const Case& each : {Case{0.5, 3, 4}, Case{0.25, 2, 3}, Case{0.1, 2, 3}, Case{0.05, 1, 2}}) {
    const std::string ratio = " at mass ratio " + std::to_string(each.ratio);
    report.expect("sweeps, bottom-up," + ratio, kScript, each.up,
                  sweeps_at_ratio(each.ratio, Order::kId), 0.0);
    report.expect("sweeps, top-down," + ratio, kScript, each.down,
                  sweeps_at_ratio(each.ratio, Order::kReverse), 0.0);
  }
  // At 117:1 the threshold is met by 1.5e-6, less than 352 sweeps of float rounding.
  const char* const formula = "ceil(ln 20 / ln(1 + 1 / r)), which 3 r + 2 misses from 117 on";
  for (const int r : {100, 116, 117})
    report.expect(at("sweeps, bottom-up,", r), formula,
                  std::ceil(std::log(20.0) / std::log(1.0 + 1.0 / r)),
                  sweeps_at_ratio(r, Order::kId), r == 117 ? 1.0 : 0.0);
  report.expect("sweeps to 1 % at mass ratio 10:1", "ceil(ln 100 / ln 1.1)", 49.0,
                sweeps_at_ratio(10.0, Order::kId, 0.01), 0.0);
}

/// Several measures of accuracy on four equal balls, which tells them apart.
static void check_measures(Report& report) {
  const std::vector<double> masses(4, 1.0);
  const std::vector<double> exact = exact_impulses(masses);
  World<2> world = stack_of_balls(masses, velocities_only(1));
  int top = 0;
  int ground = 0;
  int euclidean = 0;
  const auto impulses = impulses_by_sweep(world, 30);
  for (int k = 30; k > 0; --k) {
    const std::vector<double>& now = impulses[static_cast<std::size_t>(k) - 1];
    double square = 0.0;
    double whole = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
      square += (now[i] - exact[i]) * (now[i] - exact[i]);
      whole += exact[i] * exact[i];
    }
    if (now[3] >= 0.95 * exact[3]) top = k;
    if (now[0] >= 0.95 * exact[0]) ground = k;
    if (square <= 0.05 * 0.05 * whole) euclidean = k;
  }
  report.expect("sweeps for four equal balls, slowest contact", kScript, 20.0,
                sweeps_to(world, exact, 0.05, 30), 0.0);
  report.expect("sweeps for four equal balls, top contact", kScript, 20.0, top, 0.0);
  report.expect("sweeps for four equal balls, ground contact", "methods 3.1", 18.0, ground, 0.0);
  report.expect("sweeps for four equal balls, Euclidean norm", "methods 3.1", 19.0, euclidean, 0.0);
}

/// Impulses of a heavy ball on a light one after each sweep.
static void draw_impulses(Report& report) {
  World<2> world = stack_of_balls({1.0, 10.0}, velocities_only(1));
  Curve lower{"ground", {}};
  Curve upper{"between the balls", {}};
  int sweep = 0;
  for (const std::vector<double>& now : impulses_by_sweep(world, 60)) {
    ++sweep;
    lower.points.emplace_back(sweep, now[0] / (11.0 * kTickSpeed));
    upper.points.emplace_back(sweep, now[1] / (10.0 * kTickSpeed));
    if (sweep > 1) continue;
    report.expect("ground impulse after sweep 1 over g h", "Catto 2014: the light ball's own", 1.0,
                  now[0] / kTickSpeed, 2.0e-6);
    report.expect("upper impulse after sweep 1 over g h", "r / (1 + r) at r = 10", 10.0 / 11.0,
                  now[1] / kTickSpeed, 2.0e-6);
  }
  report.figures.push_back({"impulses-10-to-1",
                            "Accumulated impulses, 10 kg on 1 kg",
                            "sweeps",
                            "impulse over exact",
                            false,
                            false,
                            {lower, upper}});
}

Report mass_ratio() {
  Report report{"mass-ratio", {}, {}};
  check_whole_ratios(report);
  check_other_ratios(report);
  check_measures(report);
  draw_impulses(report);
  for (const auto& [mass, gravity, tick_s] :
       {std::array{1000.0, 10.0, kTick}, std::array{0.001, 9.81, kTick},
        std::array{1.0, 1.6, 1.0 / 240.0}, std::array{7.3, 25.0, 1.0 / 30.0}})
    report.expect("sweeps at 10:1, lower ball " + std::to_string(mass) + " kg, gravity " +
                      std::to_string(gravity) + " m/s^2, tick " + std::to_string(tick_s) + " s",
                  "independent of units", 32.0, sweeps_in_units(10.0, mass, gravity, tick_s), 0.0);
  return report;
}

}  // namespace cycloid::experiments
