#include <algorithm>
#include <array>
#include <cmath>

#include "bench/experiments/reports.hpp"
#include "bench/experiments/worlds.hpp"

namespace cycloid::experiments {

using namespace solver;

/// Ticks until the impulses stay within 5 %, and how far the top one overshoots.
struct Settling {
  int ticks = 0;
  double peak = 0.0;
};

static Settling settle(const std::vector<double>& masses, std::uint32_t sweeps,
                       Curve* curve = nullptr) {
  const std::vector<double> exact = exact_impulses(masses);
  World<2> world = stack_of_balls(masses, velocities_only(sweeps));
  Settling settling;
  for (int tick = 1; tick <= 200; ++tick) {
    step(world);
    const std::vector<double> now = normal_impulses(world);
    if (slowest_error(now, exact) > 0.05) settling.ticks = tick + 1;
    for (std::size_t i = 0; i < now.size(); ++i)
      settling.peak = std::max(settling.peak, now[i] / exact[i]);
    if (curve != nullptr && tick <= 60) curve->points.emplace_back(tick, now.back() / exact.back());
  }
  return settling;
}

static void check_settling(Report& report) {
  struct Case {
    const char* name;
    std::vector<double> masses;
    std::uint32_t sweeps;
    int ticks;
    double peak;
  };
  const std::array cases = {
      Case{"10 kg on 1 kg, 4 sweeps", {1.0, 10.0}, 4, 16, 1.381},
      Case{"10 kg on 1 kg, 10 sweeps", {1.0, 10.0}, 10, 5, 1.217},
      Case{"ten equal balls, 10 sweeps", std::vector<double>(10, 1.0), 10, 22, 1.531}};
  Figure figure{"warm-start-overshoot",
                "Impulse under the top ball, tick by tick",
                "ticks",
                "impulse over exact",
                false,
                false,
                {}};
  for (const Case& each : cases) {
    Curve curve{each.name, {}};
    const Settling settling = settle(each.masses, each.sweeps, &curve);
    figure.curves.push_back(curve);
    report.expect(std::string("ticks until all impulses stay within 5 %, ") + each.name,
                  "methods 3.4", each.ticks, settling.ticks, 0.0);
    report.expect(std::string("largest impulse over exact, ") + each.name, "methods 3.4", each.peak,
                  settling.peak, 5.0e-4);
  }
  report.figures.push_back(figure);
}

/// As in the script of the talk: every frame starts from rest and only the impulses are kept.
static int frames_of_script(std::uint32_t sweeps) {
  const std::vector<double> masses = {1.0, 10.0};
  World<2> world = stack_of_balls(masses, velocities_only(sweeps));
  for (int frame = 1; frame <= 40; ++frame) {
    for (const BodyView<2>& body : world.bodies()) {
      if (body.kind != BodyKind::kDynamic) continue;
      require(world.set_velocity(body.id, Vec<2>::zero(), Spin<2>::zero()));
      const float height = static_cast<float>(body.id.index) - 0.5f;
      require(world.set_pose(body.id, {{0.0f, height}}, identity_rotation<2>()));
    }
    step(world);
    if (slowest_error(normal_impulses(world), exact_impulses(masses)) <= 0.05) return frame;
  }
  return 0;
}

/// How far the top ball has come down when all rests, m; positions are not corrected.
static double sink(const std::vector<double>& masses, std::uint32_t sweeps,
                   std::uint32_t substeps = 1) {
  World<2> world = stack_of_balls(masses, velocities_only(sweeps).in_substeps(substeps));
  const auto top = [&] {
    return static_cast<double>(world.state().bodies[masses.size()].position[1]);
  };
  const double start = top();
  step(world, 900);
  return start - top();
}

static void check_sink(Report& report) {
  const double unit = kGravity * kTick * kTick;
  const auto formula = [&](double ratio, double sweeps) {
    const double rate = std::pow(ratio / (1.0 + ratio), sweeps);
    return unit * rate / (1.0 - rate);
  };
  Curve measured{"measured", {}};
  Curve theory{"g h^2 rho^K / (1 - rho^K)", {}};
  for (const std::uint32_t sweeps : {1u, 2u, 4u, 8u, 10u}) {
    const double depth = sink({1.0, 10.0}, sweeps);
    report.expect("sink of 10 kg on 1 kg with " + std::to_string(sweeps) + " sweeps, m",
                  "g h^2 rho^K / (1 - rho^K)", formula(10.0, sweeps), depth,
                  2.0e-6 + 1.0e-3 * formula(10.0, sweeps));
    measured.points.emplace_back(sweeps, depth);
    theory.points.emplace_back(sweeps, formula(10.0, sweeps));
  }
  report.figures.push_back({"sink-against-sweeps",
                            "How far 10 kg sink into 1 kg before the impulses have come up",
                            "sweeps per tick",
                            "sink, m",
                            true,
                            true,
                            {measured, theory}});
  for (const std::uint32_t substeps : {2u, 4u, 8u})
    report.expect(
        "sink of 10 kg on 1 kg in " + std::to_string(substeps) + " substeps of one sweep, m",
        "g (h/s)^2 r", 10.0 * unit / (substeps * substeps), sink({1.0, 10.0}, 1, substeps), 5.0e-5);
  report.expect("sink of ten equal balls with one sweep, m", "g h^2 n (n - 1) / 2", 45.0 * unit,
                sink(std::vector<double>(10, 1.0), 1), 1.0e-4);
  report.expect("sink of four equal balls with 4 sweeps, over g h^2", "methods 3.4", 1.1655,
                sink(std::vector<double>(4, 1.0), 4) / unit, 2.0e-3);
}

/// Rise of two light balls when 100 kg are taken off them, m/s.
static double rise(std::uint32_t sweeps, int body) {
  World<2> world = stack_of_balls({1.0, 1.0, 100.0}, velocities_only(400));
  step(world, 60);
  require(world.destroy_body(world.bodies().back().id));
  require(world.set_tuning(velocities_only(sweeps)));
  step(world);
  return static_cast<double>(world.state().bodies[static_cast<std::size_t>(body)].velocity[1]);
}

static void check_removal(Report& report) {
  for (const std::uint32_t sweeps : {1u, 4u, 8u, 10u})
    for (const int body : {1, 2})
      report.expect("rise of ball " + std::to_string(body) + " after 100 kg are taken off, " +
                        std::to_string(sweeps) + " sweeps, m/s",
                    "M 2^-K g h", 100.0 * kTickSpeed / std::pow(2.0, sweeps), rise(sweeps, body),
                    2.0e-4 * 100.0 * kTickSpeed / sweeps);
}

Report warm_start() {
  Report report{"warm-start", {}, {}};
  for (const auto& [sweeps, frames] : {std::pair{1u, 32}, std::pair{4u, 8}, std::pair{5u, 7},
                                       std::pair{8u, 4}, std::pair{10u, 4}, std::pair{20u, 2}})
    report.expect(
        "frames to 5 % from rest each, only impulses kept, " + std::to_string(sweeps) + " sweeps",
        "Catto 2014: ceil(32 / K) at 10:1", frames, frames_of_script(sweeps), 0.0);
  check_settling(report);
  check_sink(report);
  check_removal(report);
  return report;
}

}  // namespace cycloid::experiments
