#include <gmock/gmock.h>

#include <cmath>
#include <string>

#include "bench/accuracy/chart_csv.hpp"
#include "bench/accuracy/observer.hpp"
#include "scenes/catalogue.hpp"
#include "tests/accuracy/worlds.hpp"

namespace cycloid::accuracy {

using solver::World;

/// What is said of a run of 100 ticks that ends after so many, of two boxes that a pin holds.
static Metrics metrics_of_a_run_that_ends_after(std::uint32_t ticks) {
  World<2> world = empty_world<2>();
  solver::JointDef<2> pin;
  pin.body_a = add_box(world, 0.0f, 0.0f);
  pin.body_b = add_box(world, 1.0f, 0.0f);
  pin.anchor_a = {{1.0f, 0.0f}};
  EXPECT_TRUE(world.create_joint(pin).ok());
  Observer<2> observer(world.state(), 100, false, {});
  for (std::uint32_t tick = 1; tick <= ticks; ++tick)
    EXPECT_TRUE(observer.look(world.state(), tick));
  return observer.finish(world.state());
}

TEST(Absence, OfASteadyTimeThatNeverCame) {
  const Metrics metrics = metrics_of_a_run_that_ends_after(10);
  EXPECT_TRUE(metrics.penetration_transient_m && metrics.gap_transient_m && metrics.moved_m);
  EXPECT_FALSE(metrics.penetration_steady_m || metrics.gap_steady_m || metrics.jitter_m_s);
}

TEST(Absence, OfEverythingWhereNoTickWasLookedAt) {
  const Metrics metrics = metrics_of_a_run_that_ends_after(0);
  EXPECT_FALSE(metrics.penetration_transient_m || metrics.penetration_steady_m ||
               metrics.gap_transient_m || metrics.gap_steady_m || metrics.energy_gained_j ||
               metrics.energy_gained_share || metrics.momentum_drift ||
               metrics.angular_momentum_drift || metrics.jitter_m_s || metrics.moved_m);
}

static void push_at_once(World<2>& world, std::uint32_t) {
  EXPECT_TRUE(world.apply_force(world.bodies().back().id, {{0.0f, 1.0e11f}}).ok());
}

// An empty field, no 0; and no error of which one could say that it is small.
TEST(Absence, IsAnEmptyFieldOfARunThatFaultsAtOnce) {
  ChartPlan plan;
  plan.scenes.emplace_back();
  plan.scenes[0].subject = {scenes::find("trial-stack-10").scene.value(), 60, push_at_once};
  plan.settings = {published("soft-step")};
  plan.repeats = 0;
  run_chart(plan, [](const ChartProgress&) {});
  const Measured& measured = plan.scenes[0].points[0].measured;
  EXPECT_FALSE(measured.ended);
  for (const ErrorKind& kind : error_kinds()) {
    const std::optional<double> error = kind.of(measured);
    EXPECT_TRUE(!error || std::isinf(*error)) << kind.name;
  }
  EXPECT_THAT(chart_csv(plan, error_kinds()[0], {}),
              testing::HasSubstr("\"\",60,soft-step,4,1,1,0,,1" + std::string(28, ',')))
      << "26 numbers that nobody measured, and no rows";
}

// The last half of one tick is that tick: what is told as steady has been looked at.
TEST(Absence, IsOfTheTransientTimeInARunOfOneTick) {
  World<2> world = empty_world<2>();
  add_ground(world);
  add_box(world, 0.0f, 0.3f);
  Observer<2> observer(world.state(), 1, false, {});
  ASSERT_TRUE(observer.look(world.state(), 1));
  Measured measured;
  measured.metrics = observer.finish(world.state());
  EXPECT_FALSE(measured.metrics.penetration_transient_m.has_value());
  EXPECT_NEAR(position_error_m(measured), 0.2, 1e-6);
}

}  // namespace cycloid::accuracy
