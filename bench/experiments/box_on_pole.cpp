#include <algorithm>
#include <array>
#include <cmath>

#include "bench/experiments/reports.hpp"
#include "bench/experiments/worlds.hpp"
#include "bench/reference/projected_gauss_seidel.hpp"
#include "bench/reference/stacks.hpp"

namespace cycloid::experiments {

using namespace solver;

static const char* const kMethodsOfPoles =
    "methods 3.5: half width a, contacts at +-b, I = 2/3 m a^2";

/// A box of 1 kg and width 1 m on a pole of `beta` times its width.
static World<2> make_pole(double beta, const Tuning& tuning) {
  World<2> world = make_world(tuning);
  add(world, box(0.5 * beta, 1.0), 0.0, -1.0, 0.0, BodyKind::kStatic);
  add(world, box(0.5, 0.5), 0.0, 0.5);
  return world;
}

static const std::vector<double> kExact = {0.5 * kTickSpeed, 0.5 * kTickSpeed};

struct Row {
  double beta;
  double first;   ///< First contact after one sweep, over exact.
  double second;  ///< Second contact.
  int to_5;       ///< Sweeps to 5 %.
  int to_1_5;     ///< To 1.5 %.
  int to_1;
};

static void check_row(Report& report, const Row& row) {
  const std::string name = ", b/a = " + std::to_string(row.beta).substr(0, 4);
  World<2> world = make_pole(row.beta, velocities_only(1));
  const auto first = impulses_by_sweep(world, 2);
  const double square = 1.5 * row.beta * row.beta;
  report.expect("contact points" + name, kMethodsOfPoles, 2.0, static_cast<double>(first[0].size()),
                0.0);
  report.expect("first impulse over exact after one sweep" + name, kMethodsOfPoles, row.first,
                first[0][0] / kExact[0], 6.0e-5);
  report.expect("first impulse over exact after one sweep" + name, "2 / (1 + 1.5 (b/a)^2)",
                2.0 / (1.0 + square), first[0][0] / kExact[0], 5.0e-6);
  report.expect("second impulse over exact after one sweep" + name, kMethodsOfPoles, row.second,
                first[0][1] / kExact[1], 5.0e-4);
  report.expect("error of sweep 2 over that of sweep 1" + name,
                "((1 - 1.5 (b/a)^2) / (1 + 1.5 (b/a)^2))^2",
                std::pow((1.0 - square) / (1.0 + square), 2),
                (first[1][0] - kExact[0]) / (first[0][0] - kExact[0]), 5.0e-5);
  report.expect("sweeps to 5 %" + name, kMethodsOfPoles, row.to_5,
                sweeps_to(world, kExact, 0.05, 400), 0.0);
  report.expect("sweeps to 1.5 %, visual" + name, "Catto 2014: 2, a couple more, around 12",
                row.to_1_5, sweeps_to(world, kExact, 0.015, 400), 0.0);
  report.expect("sweeps to 1 %" + name, kMethodsOfPoles, row.to_1,
                sweeps_to(world, kExact, 0.01, 400), 0.0);
  Tuning block = velocities_only(1);
  block.contact_block = ContactBlockRows::kNormals;
  World<2> together = make_pole(row.beta, block);
  step(together);
  report.expect("error of the block of two normals after one sweep" + name, "Catto 2006: exact",
                0.0, slowest_error(normal_impulses(together), kExact), 2.0e-6);
}

/// Clamping each change instead of the sum keeps the overshoot of the first sweep for ever.
static void check_wrong_clamp(Report& report, double beta, double separating) {
  const reference::Assembled pole = reference::box_on_pole(1.0, beta, 1.0);
  const auto wrong =
      reference::pgs_history<double>(pole.problem, {.sweeps = 400, .incremental_clamp = true});
  const auto right = reference::pgs_history<double>(pole.problem, {.sweeps = 400});
  const std::string name = ", b/a = " + std::to_string(beta).substr(0, 4);
  report.expect(
      "speed at which the left contact parts for ever when changes are clamped, over g h" + name,
      kMethodsOfPoles, separating, reference::velocities(pole.problem, wrong.back())[0], 6.0e-5);
  report.expect("the same with the sum clamped" + name, "Catto 2006, accumulated impulses", 0.0,
                reference::velocities(pole.problem, right.back())[0], 1.0e-5);
}

/// Where the first sweep does not overshoot no impulse is ever taken back, so that no clamp
/// matters: from b/a = sqrt(2/3) on.
static void check_no_clamp(Report& report) {
  for (const double beta : {0.8165, 0.9, 1.0}) {
    reference::Mlcp problem = reference::box_on_pole(1.0, beta, 1.0).problem;
    const reference::PgsOptions wrong = {.sweeps = 20, .incremental_clamp = true};
    const auto changes = reference::pgs_history<double>(problem, wrong);
    const auto sums = reference::pgs_history<double>(problem, {.sweeps = 20});
    problem.lower.assign(2, -reference::kInfinity);
    const auto free = reference::pgs_history<double>(problem, {.sweeps = 20});
    const std::string name = ", b/a = " + std::to_string(beta).substr(0, 6);
    report.expect("whether clamping the sum changes no bit (1: yes)" + name,
                  "Catto 2014: a box on a plane needs no clamp", 1.0, sums == free ? 1.0 : 0.0,
                  0.0);
    // Once it has converged, rounding may ask for an impulse back.
    double difference = 0.0;
    for (std::size_t sweep = 0; sweep < free.size(); ++sweep)
      for (std::size_t i = 0; i < 2; ++i)
        difference = std::max(difference, std::abs(changes[sweep][i] - free[sweep][i]));
    report.expect("largest difference that clamping the changes makes, N s" + name,
                  "Catto 2014: a box on a plane needs no clamp", 0.0, difference, 1.0e-15);
  }
}

/// A box that drops with v stops by two impulses of m v / 2.
static void check_drop(Report& report) {
  Tuning tuning = velocities_only(1);
  tuning.contact_block = ContactBlockRows::kNormals;
  World<2> world = make_pole(1.0, tuning);
  require(world.set_velocity(world.bodies().back().id, {{0.0f, -3.0f}}, Spin<2>::zero()));
  step(world);
  for (const double impulse : normal_impulses(world))
    report.expect("impulse of one corner of a box of 1 kg that drops with 3 m/s, N s",
                  "Catto 2009: m v / 2, v with a tick of gravity", 0.5 * (3.0 + kTickSpeed),
                  impulse, 2.0e-6);
}

static void draw_pole(Report& report) {
  Figure figure{"impulses-box-on-pole",
                "First impulse of a box on a pole",
                "sweeps",
                "impulse over exact",
                false,
                false,
                {}};
  for (const double beta : {1.0, 0.75, 0.5, 0.25}) {
    World<2> world = make_pole(beta, velocities_only(1));
    Curve left{"first, b/a = " + std::to_string(beta).substr(0, 4), {}};
    Curve right{"second, b/a = " + std::to_string(beta).substr(0, 4), {}};
    int sweep = 0;
    for (const std::vector<double>& now : impulses_by_sweep(world, 16)) {
      ++sweep;
      left.points.emplace_back(sweep, now[0] / kExact[0]);
      right.points.emplace_back(sweep, now[1] / kExact[1]);
    }
    figure.curves.push_back(left);
    figure.curves.push_back(right);
  }
  report.figures.push_back(figure);
}

Report box_on_pole() {
  Report report{"box-on-pole", {}, {}};
  for (const Row& row : {Row{1.0, 0.8, 0.96, 2, 2, 2}, Row{0.75, 1.0847, 0.9928, 2, 2, 2},
                         Row{0.5, 1.4545, 0.7934, 3, 4, 4}, Row{0.25, 1.8286, 0.3135, 9, 12, 13},
                         Row{0.10, 1.9704, 0.0582, 51, 71, 78}})
    check_row(report, row);
  check_no_clamp(report);
  check_drop(report);
  check_wrong_clamp(report, 1.0, 0.0);
  check_wrong_clamp(report, 0.75, 0.0776);
  check_wrong_clamp(report, 0.5, 0.2479);
  check_wrong_clamp(report, 0.25, 0.1420);
  draw_pole(report);
  return report;
}

}  // namespace cycloid::experiments
