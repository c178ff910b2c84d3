#include <cmath>
#include <string>

#include "bench/experiments/reports.hpp"
#include "bench/experiments/worlds.hpp"
#include "solver/character/mover.hpp"

namespace cycloid::experiments {

using namespace solver;

/// Two planes through the origin that enclose `angle` (rad), open towards -x; `copies` of each.
static std::vector<CollisionPlane<2>> corner_of(double angle, int copies = 1) {
  std::vector<CollisionPlane<2>> planes;
  for (int i = 0; i < copies; ++i)
    for (const double side : {1.0, -1.0}) {
      CollisionPlane<2> plane;
      plane.normal = {{static_cast<float>(-std::sin(0.5 * angle)),
                       static_cast<float>(side * std::cos(0.5 * angle))}};
      plane.offset = 0.0f;
      planes.push_back(plane);
    }
  return planes;
}

static double distance_after(double angle, int sweeps) {
  const auto planes = corner_of(angle);
  const Vec<2> end =
      sweep_planes<2>({{1.0f, 0.0f}}, std::span<const CollisionPlane<2>>(planes), sweeps);
  return static_cast<double>(length(end));
}

/// The first number of sweeps that leaves at most `tolerance`: 1 where it is reached there and not
/// one sweep before, else 0.
static double reached_exactly(double angle, int sweeps, double tolerance) {
  const bool now = distance_after(angle, sweeps) <= tolerance;
  const bool before = sweeps > 1 && distance_after(angle, sweeps - 1) <= tolerance;
  return now && !before ? 1.0 : 0.0;
}

static void check_sweeps(Report& report) {
  struct Case {
    int degrees;
    int to_5, to_1, to_0_1;
  };
  for (const Case& each :
       {Case{90, 1, 1, 1}, Case{60, 3, 4, 6}, Case{45, 5, 8, 11}, Case{30, 11, 17, 25},
        Case{20, 25, 38, 56}, Case{10, 99, 151, 226}, Case{5, 394, 605, 907}}) {
    const double angle = each.degrees * kPi / 180.0;
    const std::string corner = " in a corner of " + std::to_string(each.degrees) + " degrees";
    const auto expect = [&](const char* share, int sweeps, double tolerance) {
      report.expect("the mover's planes reach " + std::string(share) + " after exactly " +
                        std::to_string(sweeps) + " sweeps" + corner,
                    "methods 3.6", 1.0, reached_exactly(angle, sweeps, tolerance), 0.0);
    };
    expect("5 %", each.to_5, 0.05);
    expect("1 %", each.to_1, 0.01);
    expect("0.1 %", each.to_0_1, 0.001);
    auto planes = corner_of(angle);
    auto redundant = corner_of(angle, 10);
    const Vec<2> exact = solve_planes<2>({{1.0f, 0.0f}}, planes).position;
    const Vec<2> again = solve_planes<2>({{1.0f, 0.0f}}, redundant).position;
    report.expect("the exact solve leaves nothing" + corner, "Catto 2014, planes", 0.0,
                  static_cast<double>(length(exact)), 1.0e-6);
    report.expect("ten of each plane change nothing" + corner, "Catto 2014, redundant planes", 0.0,
                  static_cast<double>(length(exact - again)), 0.0);
  }
}

/// How far a ball of 0.3 m gets towards a wall of 0.02 m at x = 3 in one tick, m.
static double reach_at_wall(double speed) {
  World<2> world = make_world(Tuning::soft_step(), {0.0f}, 0.0);
  add(world, box(0.01, 5.0), 3.0, 0.0, 0.0, BodyKind::kStatic);
  MoverDef<2> def;
  MoverState<2> state;
  state.velocity = {{static_cast<float>(speed), 0.0f}};
  return static_cast<double>(
      move(world.state(), def, state, static_cast<float>(kTick)).state.position[0]);
}

Report character() {
  Report report{"character", {}, {}};
  check_sweeps(report);
  for (const double speed : {200.0, 1000.0, 10000.0, 100000.0})
    report.expect("a mover at " + std::to_string(static_cast<int>(speed)) +
                      " m/s stops its skin before a wall of 0.02 m, m",
                  "Catto 2014: never through a wall", 3.0 - 0.01 - 0.3 - 0.01, reach_at_wall(speed),
                  2.0e-3);
  return report;
}

}  // namespace cycloid::experiments
