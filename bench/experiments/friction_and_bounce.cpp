#include <algorithm>
#include <array>
#include <cmath>

#include "bench/experiments/reports.hpp"
#include "bench/experiments/worlds.hpp"

namespace cycloid::experiments {

using namespace solver;

/// A box on a slope, and how it has moved after some seconds.
struct Slide {
  double way = 0.0;           ///< Down the slope, m.
  double acceleration = 0.0;  ///< Mean over the second half, m/s^2.
};

static Slide slide(double angle, double friction, const Tuning& tuning) {
  World<2> world = make_world(tuning, {static_cast<float>(friction)});
  add_ground(world, angle);
  const auto sine = static_cast<float>(std::sin(angle));
  const auto cosine = static_cast<float>(std::cos(angle));
  BodyDef<2> def;
  def.position = {{-0.25f * sine, 0.25f * cosine}};
  def.rotation = {{cosine, sine}};
  const ShapeDef<2> shape = box(0.5, 0.25);
  const BodyId id = require(world.create_body(def, std::span(&shape, 1)));
  const auto down = [&](const Vec<2>& v) {
    return -static_cast<double>(v[0]) * std::cos(angle) -
           static_cast<double>(v[1]) * std::sin(angle);
  };
  step(world, 60);
  const double speed = down(view(world, id).velocity);
  step(world, 60);
  return {down(view(world, id).position), down(view(world, id).velocity) - speed};
}

struct StabilisedTuning {
  const char* name;
  Tuning tuning;
};

static std::array<StabilisedTuning, 3> stabilised_tunings() {
  return {StabilisedTuning{"soft step", Tuning::soft_step()},
          StabilisedTuning{"Baumgarte", Tuning::pgs()},
          StabilisedTuning{"non-linear Gauss-Seidel", Tuning::pgs_ngs()}};
}

static void check_slopes(Report& report) {
  const double ramp = std::atan(0.25);
  for (const StabilisedTuning& method : stabilised_tunings()) {
    const std::string name = std::string(", ") + method.name;
    report.expect("way of a box on the slope of tangent 0.25 in 2 s, friction 0.2553, m" + name,
                  "Coulomb: sticks where tan < mu", 0.0, slide(ramp, 0.2553, method.tuning).way,
                  1.0e-3);
    for (const auto& [angle, friction] :
         {std::pair{ramp, 0.2}, std::pair{ramp, 0.1}, std::pair{ramp, 0.0}, std::pair{0.5, 0.3},
          std::pair{0.6, 0.5}}) {
      const double expected = kGravity * (std::sin(angle) - friction * std::cos(angle));
      report.expect("acceleration of a box, slope " + std::to_string(angle) + " rad, friction " +
                        std::to_string(friction) + ", m/s^2" + name,
                    "g (sin - mu cos)", expected,
                    slide(angle, friction, method.tuning).acceleration, 0.01 * expected);
    }
  }
}

/// Height of the lowest point above the ground at the top of the first bounce, m.
static double bounce(double restitution, double height, const Tuning& tuning) {
  World<2> world = make_world(tuning, {0.0f, static_cast<float>(restitution)});
  add_ground(world);
  const BodyId id = add(world, ball(0.5), 0.0, 0.5 + height);
  double apex = 0.0;
  bool hit = false;
  for (int tick = 0; tick < 240; ++tick) {
    step(world);
    const BodyView<2> now = view(world, id);
    if (!hit && now.velocity[1] < 0.0f) continue;
    if (hit && now.velocity[1] < 0.0f) break;
    hit = true;
    apex = std::max(apex, static_cast<double>(now.position[1]) - 0.5);
  }
  return apex;
}

static void check_restitution(Report& report) {
  for (const double e : {0.0, 0.5, 0.8, 1.0})
    for (const double height : {1.0, 4.0})
      report.expect("height of the first bounce from " + std::to_string(static_cast<int>(height)) +
                        " m at restitution " + std::to_string(e).substr(0, 3) + ", m",
                    "e^2 of the height", e * e * height, bounce(e, height, Tuning::soft_step()),
                    0.01 * height);
}

/// Highest point of the last 2 of 60 s of a ball that bounces at e = 1 from 1 m.
static double height_after_minute() {
  World<2> world = make_world(Tuning::soft_step(), {0.0f, 1.0f});
  add_ground(world);
  const BodyId id = add(world, ball(0.5), 0.0, 1.5);
  step(world, 58 * 60);
  double apex = 0.0;
  for (int tick = 0; tick < 120; ++tick) {
    step(world);
    apex = std::max(apex, static_cast<double>(view(world, id).position[1]) - 0.5);
  }
  return apex;
}

/// Of all bodies, J.
static double kinetic_energy(const World<2>& world) {
  double energy = 0.0;
  for (const Body<2>& body : world.state().bodies) {
    const double x = static_cast<double>(body.velocity[0]);
    const double y = static_cast<double>(body.velocity[1]);
    const double spin = static_cast<double>(body.spin[0]);
    energy += 0.5 * (static_cast<double>(body.mass) * (x * x + y * y) +
                     static_cast<double>(body.inertia.m[0]) * spin * spin);
  }
  return energy;
}

/// Twenty elastic discs in a box of 8 m, without gravity and friction: the share of their energy
/// that is left, second by second.
static Curve gas() {
  Tuning tuning = Tuning::soft_step();
  tuning.restitution_threshold = 0.0f;
  World<2> world = make_world(tuning, {0.0f, 1.0f}, 0.0);
  for (const auto& [x, y, half_x, half_y] :
       {std::array{0.0, -5.0, 6.0, 1.0}, std::array{0.0, 5.0, 6.0, 1.0},
        std::array{-5.0, 0.0, 1.0, 6.0}, std::array{5.0, 0.0, 1.0, 6.0}})
    add(world, box(half_x, half_y), x, y, 0.0, BodyKind::kStatic);
  for (int i = 0; i < 20; ++i) {
    const BodyId id = add(world, ball(0.3), -3.0 + 1.5 * (i % 5), -2.25 + 1.5 * (i / 5), 1.0);
    const auto x = static_cast<float>((7 * i) % 11 - 5);
    const auto y = static_cast<float>((5 * i) % 9 - 4);
    require(world.set_velocity(id, {{x, y}}, Spin<2>::zero()));
  }
  const double start = kinetic_energy(world);
  Curve curve{"20 elastic discs", {{0.0, 1.0}}};
  for (int second = 1; second <= 60; ++second) {
    step(world, 60);
    curve.points.emplace_back(second, kinetic_energy(world) / start);
  }
  return curve;
}

/// One disc meets another off its middle, without friction.
static void check_frictionless_impact(Report& report) {
  Tuning tuning = Tuning::soft_step();
  World<2> world = make_world(tuning, {0.0f, 1.0f}, 0.0);
  const BodyId first = add(world, ball(0.3), 0.0, 0.0, 1.0);
  const BodyId second = add(world, ball(0.3), 1.0, 0.35, 1.0);
  require(world.set_velocity(first, {{5.0f, 0.0f}}, Spin<2>::zero()));
  step(world, 20);
  report.expect("spin of a disc after an impact without friction, rad/s",
                "a central impulse has no moment", 0.0,
                static_cast<double>(view(world, second).spin[0]), 0.01);
  report.expect("energy of two elastic discs after an impact off the middle, J", "energy is kept",
                12.5, kinetic_energy(world), 0.0125);
}

Report friction_and_bounce() {
  Report report{"friction-and-bounce", {}, {}};
  check_slopes(report);
  check_restitution(report);
  report.expect("height of a ball at restitution 1 from 1 m after 60 s, m", "energy is kept", 1.0,
                height_after_minute(), 0.01);
  check_frictionless_impact(report);
  const Curve energy = gas();
  report.expect("energy of 20 elastic discs after 60 s over that at the start", "energy is kept",
                1.0, energy.points.back().second, 0.05);
  report.figures.push_back({"energy-of-elastic-discs",
                            "Energy of 20 elastic discs in a box",
                            "s",
                            "energy over first",
                            false,
                            false,
                            {energy}});
  return report;
}

}  // namespace cycloid::experiments
