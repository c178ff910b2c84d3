#include <cmath>
#include <functional>
#include <string>

#include "bench/experiments/reports.hpp"
#include "bench/experiments/worlds.hpp"

namespace cycloid::experiments {

using namespace solver;

/// What a tick costs, and where the last body is after two seconds.
struct Cost {
  double rows = 0.0;     ///< Per sweep, at the end.
  double turning = 0.0;  ///< Of these, with an angular part.
  double x = 0.0;
  double y = 0.0;
};

/// A sliding column of three bodies of 1 m, pushed to the right at 2 m/s.
static Cost run_column(float friction, const std::function<void(BodyDef<2>&)>& reduce) {
  World<2> world = make_world(Tuning::soft_step(), {friction});
  add_ground(world);
  BodyId last;
  for (int i = 0; i < 3; ++i) {
    BodyDef<2> def;
    def.position = {{0.0f, 0.5f + static_cast<float>(i)}};
    def.velocity = {{2.0f, 0.0f}};
    reduce(def);
    const ShapeDef<2> shape = box(0.5, 0.5);
    last = require(world.create_body(def, std::span(&shape, 1)));
  }
  step(world, 120);
  const BodyView<2> end = view(world, last);
  return {static_cast<double>(world.statistics().rows_per_sweep),
          static_cast<double>(world.statistics().turning_rows_per_sweep),
          static_cast<double>(end.position[0]), static_cast<double>(end.position[1])};
}

static void check_sleep(Report& report) {
  WorldDef<2> def;
  def.gravity = {{0.0f, -static_cast<float>(kGravity)}};
  World<2> world = require(World<2>::create(def));
  add_ground(world);
  BodyId top;
  for (int i = 0; i < 5; ++i) top = add(world, box(0.5, 0.5), 0.0, 0.5 + i);
  step(world, 30);
  report.expect("rows of five boxes that have just been put down", "2 points x 2 rows x 5", 20.0,
                world.statistics().rows_per_sweep, 0.0);
  step(world, 300);
  report.expect("rows of the same boxes at rest", "a resting island: nothing", 0.0,
                world.statistics().rows_per_sweep, 0.0);
  report.expect("and where the top one sleeps, m", "slop and sag: 1 % of the height", 4.5,
                static_cast<double>(view(world, top).position[1]), 0.045);
}

Report reduction() {
  Report report{"reduction", {}, {}};
  const char* const source = "methods 4 #75: no more than a scene needs";
  const auto nothing = [](BodyDef<2>&) {};
  const Cost tiny = run_column(1.0e-9f, nothing);
  const Cost frictionless = run_column(0.0f, nothing);
  report.expect("rows of three boxes with next to no friction", source, 12.0, tiny.rows, 0.0);
  report.expect("rows without friction: no tangents", source, 6.0, frictionless.rows, 0.0);
  report.expect("where the top box is without them, m", source, tiny.x, frictionless.x, 1.0e-3);
  report.expect("how high, m", source, tiny.y, frictionless.y, 1.0e-3);

  const Cost fixed = run_column(0.0f, [](BodyDef<2>& def) { def.fixed_rotation = true; });
  report.expect("rows with an angular part", source, 6.0, frictionless.turning, 0.0);
  report.expect("the same where nothing can turn", source, 0.0, fixed.turning, 0.0);
  report.expect("where the top box is then, m: two seconds at 2 m/s", source, 4.0, fixed.x, 1.0e-3);
  report.expect("where it is when it can tilt, m", source, 4.0, frictionless.x, 0.02);
  const Cost particles = run_column(0.0f, [](BodyDef<2>& def) {
    def.kind = BodyKind::kParticle;
    def.mass = 1.0f;
  });
  report.expect("rows of particles with an angular part", source, 0.0, particles.turning, 0.0);
  check_sleep(report);
  return report;
}

}  // namespace cycloid::experiments
