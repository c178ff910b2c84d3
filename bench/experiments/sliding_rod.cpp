#include "bench/reference/sliding_rod.hpp"

#include <algorithm>
#include <cmath>

#include "bench/experiments/reports.hpp"
#include "bench/experiments/worlds.hpp"
#include "bench/reference/direct.hpp"

namespace cycloid::experiments {

using namespace solver;

static constexpr double kRadius = 0.0005;  ///< Of the rod's ends, m: next to nothing.

/// The rod as a thin capsule whose lower end touches the ground, moving along x at `speed` (m/s).
static World<2> make_rod(double friction, double speed, const Tuning& tuning) {
  World<2> world = make_world(tuning, {static_cast<float>(friction)});
  add_ground(world);
  ShapeDef<2> rod;
  rod.kind = ShapeKind::kCapsule;
  rod.points = {{{-1.0f, 0.0f}}, {{1.0f, 0.0f}}};
  rod.radius = static_cast<float>(kRadius);
  BodyDef<2> def;
  const double cosine = 1.0 / std::sqrt(5.0);
  def.rotation = {{static_cast<float>(cosine), static_cast<float>(2.0 * cosine)}};
  def.position = {{0.0f, static_cast<float>(2.0 * cosine + kRadius)}};
  def.velocity = {{static_cast<float>(speed), 0.0f}};
  def.mass = 1.0f;
  require(world.create_body(def, std::span(&rod, 1)));
  return world;
}

struct Impulses {
  double normal = 0.0;
  double tangent = 0.0;  ///< Without its sign.
  double energy = 0.0;   ///< Of the rod afterwards, J.
};

/// One tick, N s.
static Impulses impulses_of_rod(double friction, double speed, std::uint32_t sweeps,
                                ContactBlockRows rows) {
  Tuning tuning = velocities_only(sweeps);
  tuning.contact_block = rows;
  World<2> world = make_rod(friction, speed, tuning);
  step(world);
  Impulses result;
  for (const Contact<2>& contact : world.state().contacts)
    for (std::uint32_t p = 0; p < contact.point_count; ++p) {
      result.normal += static_cast<double>(contact.points[p].normal_impulse);
      result.tangent += std::abs(static_cast<double>(contact.points[p].tangent_impulse[0]));
    }
  const Body<2>& rod = world.state().bodies[1];
  const double x = static_cast<double>(rod.velocity[0]);
  const double y = static_cast<double>(rod.velocity[1]);
  const double spin = static_cast<double>(rod.spin[0]);
  result.energy = 0.5 * (x * x + y * y + static_cast<double>(rod.inertia.m[0]) * spin * spin);
  return result;
}

static void check_accelerations(Report& report) {
  const char* const source = "Painleve 1895: 1 / (1 + 3 c^2 - 3 mu s c)";
  struct Case {
    double friction;
    double force;
  };
  for (const Case& each : {Case{0.0, 0.625}, Case{0.5, 1.0}, Case{1.0, 2.5}, Case{1.2, 6.25},
                           Case{1.3, 25.0}, Case{1.33, 250.0}})
    report.expect("normal force over weight at friction " + std::to_string(each.friction), source,
                  each.force, reference::normal_force_over_weight({.friction = each.friction}),
                  1.0e-9 * each.force);
  report.expect("whether the force is negative beyond 4/3 (1: yes)", source, 1.0,
                reference::normal_force_over_weight({.friction = 1.4}) < 0.0 ? 1.0 : 0.0, 0.0);
  report.expect("friction from which on no forces exist", source, 4.0 / 3.0,
                reference::critical_friction({}), 1.0e-12);
}

/// The end that digs in: finite impulses that may stop it within the tick.
static void check_digging(Report& report) {
  const char* const source = "methods 3.7 #18, l = 1 m, 1 kg, 10 m/s";
  for (const double friction : {1.3, 1.4, 2.0}) {
    const Impulses now = impulses_of_rod(friction, -10.0, 1, ContactBlockRows::kNormalFriction);
    const std::string at = " at friction " + std::to_string(friction).substr(0, 3);
    report.expect("normal impulse of the rod that digs in" + at + ", N s", source, 3.14167,
                  now.normal, 0.01);
    report.expect("its friction impulse" + at + ", N s", source, 4.05, now.tangent, 0.01);
    report.expect("energy that is left" + at + ", J", source, 29.50, now.energy, 0.02);
  }
  report.expect("normal impulse of the rod that digs in at friction 1, N s", source, 0.41667,
                impulses_of_rod(1.0, -10.0, 1, ContactBlockRows::kNormalFriction).normal, 1.0e-3);
  report.expect("the same row by row with 200 sweeps, N s", source, 0.41667,
                impulses_of_rod(1.0, -10.0, 200, ContactBlockRows::kNone).normal, 1.0e-3);
  report.expect("the same at friction 1.4 row by row with 200 sweeps, N s", source, 3.14167,
                impulses_of_rod(1.4, -10.0, 200, ContactBlockRows::kNone).normal, 0.01);
}

/// Normal impulse over exact after each sweep, in the direction that is called harmless.
static Curve sweep_curve(double friction, ContactBlockRows rows, const char* name) {
  reference::SlidingRod rod{.friction = friction, .speed = 10.0};
  const double exact =
      reference::solve_direct(reference::one_step(rod, kGravity, kTick).problem).lambda[0];
  Curve curve{name, {}};
  for (std::uint32_t sweeps = 1; sweeps <= 40; ++sweeps)
    curve.points.emplace_back(sweeps, impulses_of_rod(friction, 10.0, sweeps, rows).normal / exact);
  return curve;
}

/// From 4/3 on row by row cycles with period 2 and half of its iterates do not push at all; below
/// it the error shrinks by mu |K_nt| / K_nn = 3/4 mu per sweep. Together is exact at once.
static void check_cycle(Report& report) {
  const char* const source = "methods 0.4: mu |K_nt| / K_nn >= 1";
  Figure figure{"rod-cycle", "Normal impulse of the rod that is pulled",
                "sweeps",    "impulse over exact",
                false,       false,
                {}};
  for (const double friction : {0.5, 1.0, 1.34, 1.5, 2.0}) {
    const std::string at = " at friction " + std::to_string(friction).substr(0, 4);
    const Curve rows = sweep_curve(friction, ContactBlockRows::kNone, ("row by row" + at).c_str());
    const Curve together =
        sweep_curve(friction, ContactBlockRows::kNormalFriction, ("together" + at).c_str());
    const auto value = [&](std::size_t sweep) { return rows.points[sweep - 1].second; };
    const double exact = together.points.back().second;
    if (friction * 0.75 >= 1.0) {
      report.expect("change of the impulse over two sweeps, row by row" + at, source, 0.0,
                    value(40) - value(38), 1.0e-4);
      report.expect("least of two impulses in turn" + at, source, 0.0,
                    std::min(value(39), value(40)), 1.0e-6);
      report.expect("whether the other one pushes too much (1: yes)" + at, source, 1.0,
                    std::max(value(39), value(40)) > 1.5 ? 1.0 : 0.0, 0.0);
    } else {
      report.expect("error after a sweep over that before, row by row" + at, "3/4 mu",
                    -0.75 * friction, (value(4) - exact) / (value(3) - exact), 2.0e-3);
    }
    for (const std::size_t sweep : {std::size_t{0}, std::size_t{1}, std::size_t{39}})
      report.expect("impulse over exact after " + std::to_string(sweep + 1) +
                        " sweeps, normal and friction together" + at,
                    "exact", 1.0, together.points[sweep].second, 2.0e-3);
    figure.curves.push_back(rows);
  }
  report.figures.push_back(figure);
}

Report sliding_rod() {
  Report report{"sliding-rod", {}, {}};
  check_accelerations(report);
  check_digging(report);
  check_cycle(report);
  return report;
}

}  // namespace cycloid::experiments
