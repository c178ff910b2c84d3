#include <algorithm>
#include <array>
#include <cmath>

#include "bench/experiments/reports.hpp"
#include "bench/experiments/worlds.hpp"

namespace cycloid::experiments {

using namespace solver;

/// Angle about z after a minute at one turn per second, rad in (-pi, pi].
static double planar_angle(const Tuning& tuning) {
  World<2> world = make_world(tuning, {0.0f}, 0.0);
  const BodyId id = add(world, box(1.0, 0.1), 0.0, 0.0);
  require(world.set_velocity(id, Vec<2>::zero(), {{static_cast<float>(2.0 * kPi)}}));
  step(world, 3600);
  const Rotation<2> rotation = view(world, id).rotation;
  return std::atan2(static_cast<double>(rotation[1]), static_cast<double>(rotation[0]));
}

/// Two balls on one body in space, 2 m apart along x: I = (small, large, large).
struct Dumbbell {
  World<3> world;
  BodyId id;

  explicit Dumbbell(const Vec<3>& spin) : world(require(World<3>::create(definition()))) {
    std::array<ShapeDef<3>, 2> balls;
    balls[0].radius = balls[1].radius = 0.5f;
    balls[0].points = {{{-1.0f, 0.0f, 0.0f}}};
    balls[1].points = {{{1.0f, 0.0f, 0.0f}}};
    BodyDef<3> def;
    def.spin = spin;
    id = require(world.create_body(def, balls));
  }
  static WorldDef<3> definition() {
    WorldDef<3> def;
    def.tuning.sleep_s = 0.0f;
    return def;
  }
  void step(int ticks) {
    for (int i = 0; i < ticks; ++i) require(world.step());
  }
};

/// Angular momentum in the world frame (kg m^2/s) and energy (J) of a body that turns.
struct Turning {
  std::array<double, 3> momentum{};
  double energy = 0.0;
};

static Turning turning_of(const Dumbbell& dumbbell) {
  const Body<3>& body = dumbbell.world.state().bodies[0];
  const Rotation<3>& q = body.rotation;
  const Vec<3> local = rotate_back(q, body.spin);
  Vec<3> momentum = Vec<3>::zero();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) momentum[i] += body.inertia.m[3 * i + j] * local[j];
  const Vec<3> world = rotate(q, momentum);
  Turning result;
  for (int i = 0; i < 3; ++i) {
    result.momentum[static_cast<std::size_t>(i)] = static_cast<double>(world[i]);
    result.energy += 0.5 * static_cast<double>(momentum[i]) * static_cast<double>(local[i]);
  }
  return result;
}

static double size_of(const std::array<double, 3>& v) {
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/// A free body keeps its energy and its angular momentum, in size and direction: largest changes
/// over 10 s, relative.
static void check_free(Report& report, const Vec<3>& spin, const std::string& name,
                       double tolerance) {
  Dumbbell dumbbell(spin);
  const Turning before = turning_of(dumbbell);
  double momentum = 0.0;
  double energy = 0.0;
  for (int tick = 0; tick < 600; ++tick) {
    dumbbell.step(1);
    const Turning now = turning_of(dumbbell);
    std::array<double, 3> change{};
    for (std::size_t i = 0; i < 3; ++i) change[i] = now.momentum[i] - before.momentum[i];
    momentum = std::max(momentum, size_of(change) / size_of(before.momentum));
    energy = std::max(energy, std::abs(now.energy / before.energy - 1.0));
  }
  report.expect("largest change of angular momentum over its size in 10 s, " + name,
                "no torque acts", 0.0, momentum, tolerance);
  report.expect("largest change of energy over it in 10 s, " + name, "no torque acts", 0.0, energy,
                tolerance);
}

/// Angle between where the body is after a minute at one turn per second and where it began, rad.
static double spatial_angle(const Vec<3>& axis) {
  Dumbbell dumbbell(static_cast<float>(2.0 * kPi) * axis);
  dumbbell.step(3600);
  const Rotation<3>& q = dumbbell.world.state().bodies[0].rotation;
  const double x = static_cast<double>(q[0]);
  const double y = static_cast<double>(q[1]);
  const double z = static_cast<double>(q[2]);
  return 2.0 * std::atan2(std::sqrt(x * x + y * y + z * z), std::abs(static_cast<double>(q[3])));
}

Report rotation() {
  Report report{"rotation", {}, {}};
  // The spin itself is a float: 2 pi is off by 1.7e-7 rad/s, 1.0e-5 rad in a minute.
  report.expect("angle off after 60 turns in the plane, one substep, rad", "60 turns", 0.0,
                planar_angle(velocities_only(1)), 1.0e-4);
  report.expect("angle off after 60 turns in the plane, soft step, rad", "60 turns", 0.0,
                planar_angle(Tuning::soft_step()), 1.0e-4);
  report.expect("angle off after 60 turns in space about x, rad", "60 turns", 0.0,
                spatial_angle({{1.0f, 0.0f, 0.0f}}), 1.0e-4);
  report.expect("angle off after 60 turns in space about z, rad", "60 turns", 0.0,
                spatial_angle({{0.0f, 0.0f, 1.0f}}), 1.0e-4);
  check_free(report, {{0.0f, 0.0f, 6.0f}}, "about a principal axis", 1.0e-5);
  check_free(report, {{3.0f, 4.0f, 0.0f}}, "tumbling", 1.0e-2);
  return report;
}

}  // namespace cycloid::experiments
