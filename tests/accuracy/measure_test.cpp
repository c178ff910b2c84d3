#include "bench/accuracy/measure.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bench/trials/methods.hpp"
#include "scenes/accuracy.hpp"
#include "scenes/catalogue.hpp"

namespace cycloid::accuracy {

static Subject subject_named(const char* name, std::uint32_t ticks) {
  return {scenes::find(name).scene.value(), ticks, nullptr};
}

// A stored choice is what the scene runs with; under a setting it must not be.
TEST(Settings, TakeThePlaceOfAChoiceThatTheSceneStores) {
  scenes::Scene scene = scenes::find("trial-stack-10").scene.value();
  scene.accuracy.error_m = 0.001f;
  scenes::store_choice(scene, solver::Tuning::xpbd());
  ASSERT_TRUE(scenes::check(scene).empty());
  const scenes::Scene set = with_setting(scene, {"soft-step", 3, 2, 1});
  EXPECT_TRUE(scenes::check(set).empty());
  const solver::Tuning tuning = scenes::tuning_of(set);
  EXPECT_EQ(tuning.substeps, 3u);
  EXPECT_EQ(tuning.sweeps, 2u);
  EXPECT_EQ(tuning.stabilisation, solver::Stabilisation::kSoft);
  EXPECT_EQ(tuning.sleep_s, scene.tuning.sleep_s) << "what is the scene's stays";
}

TEST(Settings, OfAMethodAreItsPublishedTuning) {
  const solver::Tuning scene;
  for (const trials::Method& method : trials::methods()) {
    ASSERT_TRUE(is_method(method.name));
    const solver::Tuning tuning = tuning_of(published(method.name), scene);
    EXPECT_EQ(tuning.substeps, method.tuning.substeps) << method.name;
    EXPECT_EQ(tuning.sweeps, method.tuning.sweeps) << method.name;
    EXPECT_EQ(tuning.relax_sweeps, method.tuning.relax_sweeps) << method.name;
    EXPECT_EQ(tuning.position_sweeps, method.tuning.position_sweeps) << method.name;
    EXPECT_EQ(tuning.stabilisation, method.tuning.stabilisation) << method.name;
  }
  EXPECT_FALSE(is_method("soft"));
}

TEST(Settings, KeepWhatTheSceneSaysOfItsWorld) {
  solver::Tuning scene;
  scene.slop = 0.001f;
  scene.continuous = 0;
  scene.particle_substeps = 12;
  scene.particle_damping = 0.5f;
  const solver::Tuning tuning = tuning_of({"ngs", 2, 16, 0}, scene);
  EXPECT_EQ(tuning.slop, 0.001f);
  EXPECT_EQ(tuning.continuous, 0u);
  EXPECT_EQ(tuning.particle_substeps, 12u);
  EXPECT_EQ(tuning.particle_damping, 0.5f);
  EXPECT_EQ(tuning.substeps, 2u);
  EXPECT_EQ(tuning.sweeps, 16u);
  EXPECT_EQ(tuning.position_sweeps, 6u) << "twice the published 8 sweeps and 3";
  EXPECT_EQ(tuning_of({"ngs", 2, 1, 0}, scene).position_sweeps, 1u);
  EXPECT_EQ(tuning_of({"pgs", 2, 9, 0}, scene).position_sweeps, 0u);
}

TEST(Settings, NameSubstepsSweepsAndRelaxSweeps) {
  EXPECT_EQ(name_of({"soft-step", 4, 1, 1}), "soft-step 4x1+1");
  EXPECT_EQ(name_of({"pgs", 1, 10, 0}), "pgs 1x10");
}

TEST(Settings, OfAGridAreAllWithoutDoubles) {
  const auto settings = grid({{"soft-step", "pgs"}, {1, 2, 2}, {1, 4}, {0, 1}});
  ASSERT_EQ(settings.size(), 2u * 2u * 2u + 2u * 2u) << "pgs has no relax sweeps";
  EXPECT_EQ(settings.front(), (Setting{"soft-step", 1, 1, 0}));
  EXPECT_EQ(settings.back(), (Setting{"pgs", 2, 4, 0}));
  EXPECT_EQ(grid({}).size(), trials::methods().size());
}

static bool same(const Spread& a, const Spread& b) {
  return a.max == b.max && a.rms == b.rms && a.p95 == b.p95;
}

TEST(Measure, TwiceGivesTheSame) {
  const Subject subject = subject_named("trial-stack-10", 90);
  const Measured a = measure(subject, published("soft-step"), {});
  const Measured b = measure(subject, published("soft-step"), {});
  EXPECT_EQ(a.digest, b.digest);
  EXPECT_EQ(a.metrics.natural_map, b.metrics.natural_map);
  EXPECT_EQ(a.metrics.velocity_error, b.metrics.velocity_error);
  ASSERT_TRUE(a.metrics.penetration_steady_m && b.metrics.penetration_steady_m);
  EXPECT_TRUE(same(*a.metrics.penetration_steady_m, *b.metrics.penetration_steady_m));
  EXPECT_EQ(a.price.rows_per_tick, b.price.rows_per_tick);
  EXPECT_NE(a.digest, measure(subject, published("pgs"), {}).digest);
}

// Two boxes, two contacts of two points, each with a normal and a tangent: 8 rows, which 4 substeps
// solve in one sweep and one relax sweep each.
TEST(Measure, CountsRowsOfATickAndBytesOfAState) {
  const Subject subject = subject_named("trial-heavy-on-light-10", 60);
  const Measured measured = measure(subject, published("soft-step"), {});
  EXPECT_EQ(measured.price.rows_per_tick, 64.0);
  EXPECT_EQ(measure(subject, {"soft-step", 4, 2, 1}, {}).price.rows_per_tick, 96.0);
  const auto run = scenes::Simulation::create(with_setting(subject.scene, published("soft-step")));
  EXPECT_GT(measured.price.state_bytes, run.value().encoded_bytes()) << "contacts have been made";
  EXPECT_GT(time_ticks(subject, published("soft-step"), {}), 0.0);
}

// The heavy upper box sinks g h^2 r of the substep h below where the lower one rests; the more
// substeps, the less, and a method with 1 sweep of 1 step is far from standing.
TEST(Measure, ErrorFallsWithSubsteps) {
  const Subject subject = subject_named("trial-heavy-on-light-100", 300);
  const double coarse = position_error_m(measure(subject, {"tgs-ngs", 4, 1, 0}, {}));
  const double fine = position_error_m(measure(subject, {"tgs-ngs", 32, 1, 0}, {}));
  EXPECT_GT(coarse, fine);
}

// Symplectic Euler falls g h t / 2 too far in free fall with steps of h, whatever the method.
TEST(Measure, ConsistencyOfFreeFallIsTheErrorOfItsIntegrator) {
  scenes::Scene scene;
  scene.name = "fall";
  scene.gravity = {0.0f, -10.0f, 0.0f};
  scene.materials.push_back({});
  scenes::SceneBody ball;
  ball.shapes.emplace_back();
  ball.shapes[0].radius = 0.5f;
  scene.bodies.push_back(ball);
  ASSERT_TRUE(scenes::check(scene).empty());
  MeasureOptions options;
  options.consistency = true;
  const Measured measured = measure({scene, 60, nullptr}, {"soft-step", 2, 1, 1}, options);
  double squares = 0.0;
  for (int tick = 1; tick <= 60; ++tick) {
    const double h = 1.0 / 120.0;
    const double off = 10.0 * (h - h / 16.0) * (tick / 60.0) / 2.0;
    squares += off * off;
  }
  ASSERT_TRUE(measured.metrics.consistency_m.has_value());
  EXPECT_NEAR(*measured.metrics.consistency_m, std::sqrt(squares / 60.0), 1e-4);
  EXPECT_LT(*measured.metrics.momentum_drift, 1e-5);
  EXPECT_NEAR(*measured.metrics.moved_m, 5.0, 0.05);
}

static void push_beyond_all_bounds(solver::World<2>& world, std::uint32_t tick) {
  if (tick != 30) return;
  EXPECT_TRUE(world.apply_force(world.bodies().back().id, {{0.0f, 1.0e11f}}).ok());
}

TEST(Measure, OfAWorldThatFaultsIsNoGoodAnswer) {
  Subject subject = subject_named("trial-stack-10", 60);
  subject.act = push_beyond_all_bounds;
  const Measured measured = measure(subject, published("soft-step"), {});
  EXPECT_FALSE(measured.ended);
  EXPECT_TRUE(std::isinf(position_error_m(measured)));
}

TEST(Measure, TakesScenesOfSpaceAndTheirScripts) {
  const Measured pile = measure(subject_named("trial-duplicate-points", 120), published("ngs"), {});
  EXPECT_TRUE(pile.ended);
  ASSERT_TRUE(pile.metrics.natural_map.has_value());
  const Subject subject = subject_named("half-pipe", 120);
  const Measured measured = measure(subject, published("soft-step"), {});
  auto run = scenes::Simulation::create([&] {
    scenes::Scene scene = with_setting(subject.scene, published("soft-step"));
    scene.tuning.sleep_s = 0.0f;
    return scene;
  }());
  for (std::uint64_t tick = 1; tick <= 120; ++tick) {
    std::vector<scenes::SeatInput> inputs;
    for (int seat = 0; seat < run.value().seats(); ++seat)
      inputs.push_back(scenes::scripted_input(subject.scene, seat, tick));
    ASSERT_TRUE(run.value().step(inputs).ok());
  }
  EXPECT_EQ(measured.digest, run.value().digest()) << "the run of `cycloid run`, to the bit";
}

}  // namespace cycloid::accuracy
