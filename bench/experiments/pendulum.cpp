#include <algorithm>
#include <cmath>

#include "bench/experiments/reports.hpp"
#include "bench/experiments/worlds.hpp"

namespace cycloid::experiments {

using namespace solver;

/// A bob of 1 kg on a string of 1 m that starts at `amplitude` (rad) from the lowest point.
struct Pendulum {
  World<2> world;
  BodyId bob;

  Pendulum(double amplitude, double tick_s, const Tuning& tuning)
      : world(make_world(tuning, {0.0f}, kGravity, tick_s)) {
    JointDef<2> joint;
    joint.kind = JointKind::kDistance;
    joint.body_a = add_point(world, 0.0, 0.0);
    joint.body_b = bob = add_point(world, std::sin(amplitude), -std::cos(amplitude), 1.0);
    joint.length = 1.0f;
    require(world.create_joint(joint));
  }
};

/// What a swing of some seconds shows.
struct Swing {
  double period = 0.0;   ///< Mean over the whole periods seen, s.
  double tension = 0.0;  ///< The largest, N.
  double stretch = 0.0;  ///< Largest error of length, m.
  double energy = 0.0;   ///< At the end, over that at the start; 0 at the lowest point.
};

static Swing swing(double amplitude, double tick_s, const Tuning& tuning) {
  Pendulum pendulum(amplitude, tick_s, tuning);
  World<2>& world = pendulum.world;
  const double substep = tick_s / tuning.substeps;
  Swing result;
  double first = 0.0;
  double last = 0.0;
  int crossings = 0;
  double before = std::sin(amplitude);
  const int ticks = static_cast<int>(20.0 / tick_s);
  for (int tick = 1; tick <= ticks; ++tick) {
    step(world);
    const BodyView<2> now = view(world, pendulum.bob);
    const double x = static_cast<double>(now.position[0]);
    const double y = static_cast<double>(now.position[1]);
    result.stretch = std::max(result.stretch, std::abs(std::hypot(x, y) - 1.0));
    result.tension =
        std::max(result.tension,
                 std::abs(static_cast<double>(world.state().joints[0].impulse[0])) / substep);
    if (before > 0.0 && x <= 0.0) {
      last = (tick - 1 + before / (before - x)) * tick_s;
      if (crossings++ == 0) first = last;
    }
    before = x;
  }
  const BodyView<2> end = view(world, pendulum.bob);
  const double speed_x = static_cast<double>(end.velocity[0]);
  const double speed_y = static_cast<double>(end.velocity[1]);
  result.period = (last - first) / (crossings - 1);
  result.energy = (0.5 * (speed_x * speed_x + speed_y * speed_y) +
                   kGravity * (1.0 + static_cast<double>(end.position[1]))) /
                  (kGravity * (1.0 - std::cos(amplitude)));
  return result;
}

/// Period over that of small swings: 1 / agm(1, cos(amplitude / 2)), by Gauss.
static double exact_factor(double amplitude) {
  double a = 1.0;
  double b = std::cos(0.5 * amplitude);
  for (int i = 0; i < 8; ++i) {
    const double mean = 0.5 * (a + b);
    b = std::sqrt(a * b);
    a = mean;
  }
  return 1.0 / a;
}

Report pendulum() {
  Report report{"pendulum", {}, {}};
  const double small = 2.0 * kPi * std::sqrt(1.0 / kGravity);
  Curve measured{"measured", {}};
  Curve exact{"1 / agm(1, cos(a / 2))", {}};
  report.expect("factor of the period at 90 degrees, closed form", "methods 4.8", 1.18034,
                exact_factor(0.5 * kPi), 5.0e-6);
  for (const int degrees : {5, 15, 30, 60, 90, 120, 150}) {
    const double amplitude = degrees * kPi / 180.0;
    const Swing now = swing(amplitude, kTick, Tuning::soft_step());
    report.expect("period over 2 pi sqrt(L/g) at " + std::to_string(degrees) + " degrees",
                  "1 / agm(1, cos(a / 2)), Gauss", exact_factor(amplitude), now.period / small,
                  0.005 * exact_factor(amplitude));
    measured.points.emplace_back(degrees, now.period / small);
    exact.points.emplace_back(degrees, exact_factor(amplitude));
  }
  report.figures.push_back({"pendulum-period",
                            "Period of a pendulum over that of small swings",
                            "amplitude, degrees",
                            "factor",
                            false,
                            false,
                            {exact, measured}});
  // Fine ticks: the tension is looked at once a tick.
  Tuning fine = Tuning::soft_step();
  fine.substeps = 1;
  const Swing swung = swing(0.5 * kPi, 1.0 / 960.0, fine);
  report.expect("largest tension from the horizontal, N", "3 m g at the lowest point",
                3.0 * kGravity, swung.tension, 0.3);
  report.expect("largest error of length, m", "methods 4: drift below the slop", 0.0, swung.stretch,
                0.005);
  report.expect("energy after 20 s over that at the start", "no work is done", 1.0, swung.energy,
                0.01);
  const Swing still = swing(1.0e-4, 1.0 / 960.0, fine);
  report.expect("largest tension at rest, N", "m g", kGravity, still.tension, 0.01);
  return report;
}

}  // namespace cycloid::experiments
