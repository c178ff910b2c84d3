#include <algorithm>
#include <cmath>

#include "bench/experiments/reports.hpp"
#include "bench/experiments/worlds.hpp"

namespace cycloid::experiments {

using namespace solver;

/// A bead of 1 kg on a wire: one constraint and gravity.
struct Wire {
  World<2> world;
  BodyId bead;

  Wire(CurveKind curve, double size, double x, double y, double tick_s = kTick)
      : world(make_world(Tuning::soft_step(), {0.0f}, kGravity, tick_s)) {
    JointDef<2> joint;
    joint.kind = JointKind::kCurve;
    joint.body_a = add_point(world, 0.0, 0.0);
    joint.body_b = bead = add_point(world, x, y, 1.0);
    joint.curve = curve;
    joint.size = {static_cast<float>(size), static_cast<float>(size)};
    require(world.create_joint(joint));
  }
};

static double x_of(const Wire& wire) {
  return static_cast<double>(view(wire.world, wire.bead).position[0]);
}

/// Time until the bead, from rest and from the left, passes x = `line` (m), s; the way between two
/// ticks is taken as straight.
static double time_to(Wire wire, double line, double tick_s = kTick) {
  double before = x_of(wire);
  for (int tick = 1; tick < 6000; ++tick) {
    step(wire.world);
    const double now = x_of(wire);
    if (now >= line) return (tick - 1 + (line - before) / (now - before)) * tick_s;
    before = now;
  }
  return 0.0;
}

/// A bead on the trough x = R (t + sin t), y = -R (1 + cos t) at parameter `t`.
static Wire on_cycloid(double radius, double t) {
  return {CurveKind::kCycloid, radius, radius * (t + std::sin(t)), -radius * (1.0 + std::cos(t))};
}

/// A straight ramp down from (0, 0) to (x, y): a chain of a static body.
static double time_on_ramp(double x, double y) {
  World<2> world = make_world(Tuning::soft_step());
  ShapeDef<2> chain;
  chain.kind = ShapeKind::kChain;
  const auto to_x = static_cast<float>(x);
  const auto to_y = static_cast<float>(y);
  // Longer than the way at both ends, so that the bead stays off them.
  chain.points = {{{-0.25f * to_x, -0.25f * to_y}}, {{1.25f * to_x, 1.25f * to_y}}};
  JointDef<2> joint;
  joint.kind = JointKind::kCurve;
  joint.body_a = add(world, chain, 0.0, 0.0, 0.0, BodyKind::kStatic);
  joint.body_b = add_point(world, 0.0, 0.0, 1.0);
  joint.curve = CurveKind::kPolyline;
  require(world.create_joint(joint));
  double before = 0.0;
  for (int tick = 1; tick < 6000; ++tick) {
    step(world);
    const double now = static_cast<double>(view(world, joint.body_b).position[0]);
    if (now >= x) return (tick - 1 + (x - before) / (now - before)) * kTick;
    before = now;
  }
  return 0.0;
}

/// The fastest way from a rim to the bottom a radius beside and below it, against the quarter
/// circle between them.
static void check_descent(Report& report) {
  const char* const source = "methods 3.7 #24";
  for (const double r : {1.0, 4.0}) {
    const double unit = std::sqrt(r / kGravity);
    const std::string at = ", radius " + std::to_string(static_cast<int>(r)) + " m";
    const double circle = time_to({CurveKind::kCircle, r, -r, 0.0}, 0.0) / unit;
    report.expect("time from rim to bottom of a quarter circle over sqrt(r/g)" + at, source,
                  1.854075, circle, 0.01);
    const double theta = 2.412011;
    const double radius = 0.572917 * r;
    const Wire best = on_cycloid(radius, -kPi);
    const double end = radius * (-kPi + theta - std::sin(theta));
    const double cycloid = time_to(on_cycloid(radius, -kPi), end) / unit;
    report.expect("time on the fastest cycloid between the same points over sqrt(r/g)" + at, source,
                  1.825682, cycloid, 0.01);
    report.expect("by how much the cycloid is faster, %" + at, source, 1.53,
                  100.0 * (1.0 - cycloid / circle), 0.5);
    report.expect("where the bead starts, m" + at, "the cusp", -kPi * radius, x_of(best), 1.0e-5);
  }
  const double radius = 1.0;
  const double unit = std::sqrt(radius / kGravity);
  const double arch = time_to(on_cycloid(radius, -kPi), 0.0) / unit;
  const double ramp = time_on_ramp(kPi * radius, -2.0 * radius) / unit;
  report.expect("time on half a cycloid arch over sqrt(R/g)", source, kPi, arch, 0.015);
  report.expect("time on the straight ramp between its ends over sqrt(R/g)", source, 3.724192, ramp,
                0.015);
  report.expect("by how much the ramp is slower, %", source, 18.54, 100.0 * (ramp / arch - 1.0),
                0.7);
}

/// The same time to the bottom from any height.
static void check_tautochrone(Report& report) {
  Curve curve{"measured", {}};
  Curve exact{"pi sqrt(R / g)", {}};
  const double time = kPi * std::sqrt(2.0 / kGravity);
  for (const double t : {3.1, 2.5, 2.0, 1.5, 1.0, 0.5, 0.2}) {
    const double measured = time_to(on_cycloid(2.0, -t), 0.0);
    report.expect(
        "time to the bottom of a cycloid from parameter " + std::to_string(t).substr(0, 3) + ", s",
        "Huygens 1673: pi sqrt(R/g) from any height", time, measured, 0.005 * time);
    const double height = 2.0 * (1.0 - std::cos(t));
    curve.points.emplace_back(height, measured);
    exact.points.emplace_back(height, time);
  }
  report.figures.push_back({"tautochrone",
                            "Time to the bottom of a cycloid with R = 2 m",
                            "height of the start, m",
                            "s",
                            false,
                            false,
                            {exact, curve}});
}

/// Total energy of the bead, J.
static double energy_of(const Wire& wire) {
  const BodyView<2> now = view(wire.world, wire.bead);
  const double x = static_cast<double>(now.velocity[0]);
  const double y = static_cast<double>(now.velocity[1]);
  return 0.5 * (x * x + y * y) + kGravity * static_cast<double>(now.position[1]);
}

/// What the constraint does to the bead in 20 s on a circle of 1 m from the rim.
struct Work {
  double power = 0.0;  ///< Largest |lambda J v|, W.
  double drift = 0.0;  ///< Largest change of energy, J.
  double gap = 0.0;    ///< Largest distance from the curve, m.
};

static Work work(double tick_s) {
  Wire wire(CurveKind::kCircle, 1.0, -std::sin(1.2), -std::cos(1.2), tick_s);
  const double start = energy_of(wire);
  Work result;
  for (int tick = 0; tick < static_cast<int>(20.0 / tick_s); ++tick) {
    step(wire.world);
    const BodyView<2> now = view(wire.world, wire.bead);
    const double x = static_cast<double>(now.position[0]);
    const double y = static_cast<double>(now.position[1]);
    const double radius = std::hypot(x, y);
    const double along =
        (static_cast<double>(now.velocity[0]) * x + static_cast<double>(now.velocity[1]) * y) /
        radius;
    const double force =
        static_cast<double>(wire.world.state().joints[0].impulse[0]) / (tick_s / 4.0);
    result.power = std::max(result.power, std::abs(force * along));
    result.drift = std::max(result.drift, std::abs(energy_of(wire) - start));
    result.gap = std::max(result.gap, std::abs(radius - 1.0));
  }
  return result;
}

static void check_work(Report& report) {
  const Work coarse = work(kTick);
  const Work middle = work(kTick / 2.0);
  const Work fine = work(kTick / 4.0);
  // 30 N at a speed that is 0 to 1e-6 m/s in floats.
  report.expect("largest power of the wire, W", "Catto 2014: lambda J v = 0", 0.0, coarse.power,
                1.0e-4);
  report.expect("largest distance from the wire, m", "0", 0.0, coarse.gap, 1.0e-3);
  report.expect("largest change of energy in 20 s, J", "1 % of the swing", 0.0, coarse.drift,
                0.064);
  report.expect("change of energy at half the tick over that at the tick", "O(h): 1/2", 0.5,
                middle.drift / coarse.drift, 0.1);
  report.expect("change of energy at a quarter of the tick over that at half", "O(h): 1/2", 0.5,
                fine.drift / middle.drift, 0.1);
  report.figures.push_back(
      {"bead-energy",
       "Largest change of energy of a bead on a circle in 20 s",
       "tick, s",
       "J",
       true,
       true,
       {{"soft step",
         {{kTick / 4.0, fine.drift}, {kTick / 2.0, middle.drift}, {kTick, coarse.drift}}}}});
}

Report curves() {
  Report report{"curves", {}, {}};
  check_descent(report);
  check_tautochrone(report);
  check_work(report);
  return report;
}

}  // namespace cycloid::experiments
