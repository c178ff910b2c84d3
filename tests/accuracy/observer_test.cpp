#include "bench/accuracy/observer.hpp"

#include <cmath>

#include "tests/accuracy/worlds.hpp"

namespace cycloid::accuracy {

using solver::World;
using solver::WorldState;

TEST(SpreadOfSizes, IsMaximumRootMeanSquareAndRank) {
  std::vector<double> sizes;
  for (int i = 100; i >= 1; --i) sizes.push_back(i);
  const Spread spread = spread_of(sizes);
  EXPECT_EQ(spread.max, 100.0);
  EXPECT_EQ(spread.p95, 95.0);
  EXPECT_NEAR(spread.rms, std::sqrt(101.0 * 201.0 / 6.0), 1e-12);
  std::vector<double> one = {3.0};
  EXPECT_EQ(spread_of(one).p95, 3.0);
  std::vector<double> none;
  EXPECT_EQ(spread_of(none).max, 0.0);
}

/// The metrics of a world whose states are `start` at tick 0 and then `state`, each tick.
template <int D>
static Metrics watch(const WorldState<D>& start, const WorldState<D>& state,
                     std::uint32_t ticks = 120) {
  MeasureOptions options;
  options.every = 1;
  Observer<D> observer(start, ticks, false, options);
  for (std::uint32_t tick = 1; tick <= ticks; ++tick) EXPECT_TRUE(observer.look(state, tick));
  return observer.finish(state);
}

template <int D>
static void expect_depths() {
  World<D> world = empty_world<D>();
  add_ground(world);
  add_box(world, 0.0f, 0.48f);
  add_box(world, 5.0f, 0.46f);
  add_box(world, 10.0f, 0.51f);
  const Metrics metrics = watch(world.state(), world.state());
  EXPECT_NEAR(metrics.penetration_steady_m->max, 0.04, 1e-6);
  EXPECT_NEAR(metrics.penetration_steady_m->rms, std::sqrt(0.5 * (0.0016 + 0.0004)), 1e-6);
  EXPECT_NEAR(metrics.penetration_steady_m->p95, 0.04, 1e-6);
  EXPECT_NEAR(metrics.penetration_transient_m->max, 0.04, 1e-6);
  EXPECT_FALSE(metrics.gap_steady_m.has_value());
  EXPECT_FALSE(metrics.natural_map.has_value()) << "no contact has been made yet";
  EXPECT_FALSE(metrics.momentum_drift.has_value()) << "the ground holds the boxes";
}
TEST(Observer, MeasuresOverlapsInThePlane) {
  expect_depths<2>();
}
TEST(Observer, MeasuresOverlapsInSpace) {
  expect_depths<3>();
}

TEST(Observer, TellsTransientFromSteady) {
  World<2> world = empty_world<2>();
  add_ground(world);
  add_box(world, 0.0f, 0.4f);
  const WorldState<2> deep = world.state();
  WorldState<2> shallow = deep;
  shallow.bodies.moved(1).position[1] = 0.49f;
  Observer<2> observer(deep, 100, false, {});
  for (std::uint32_t tick = 1; tick <= 100; ++tick)
    ASSERT_TRUE(observer.look(tick <= 50 ? deep : shallow, tick));
  const Metrics metrics = observer.finish(shallow);
  EXPECT_NEAR(metrics.penetration_transient_m->max, 0.1, 1e-6);
  EXPECT_NEAR(metrics.penetration_steady_m->max, 0.01, 1e-6);
  EXPECT_NEAR(*metrics.moved_m, 0.09, 1e-6);
}

TEST(Observer, MeasuresGapsOfAChain) {
  World<2> world = empty_world<2>();
  solver::JointDef<2> pin;
  pin.anchor_a = {{0.5f, 0.0f}};
  pin.anchor_b = {{-0.5f, 0.0f}};
  pin.body_a = add_box(world, 0.0f, 0.0f);
  for (int i = 1; i <= 4; ++i) {
    pin.body_b = add_box(world, static_cast<float>(i), 0.0f);
    ASSERT_TRUE(world.create_joint(pin).ok());
    pin.body_a = pin.body_b;
  }
  WorldState<2> state = world.state();
  state.bodies.moved(4).position[1] = 0.2f;
  const Metrics metrics = watch(world.state(), state);
  ASSERT_TRUE(metrics.gap_steady_m.has_value());
  EXPECT_NEAR(metrics.gap_steady_m->max, 0.2, 1e-6);
  EXPECT_NEAR(metrics.gap_steady_m->rms, 0.1, 1e-6) << "one gap of four";
  EXPECT_NEAR(metrics.gap_transient_m->p95, 0.2, 1e-6);
}

TEST(Observer, SeesEnergyThatCameFromNowhere) {
  World<2> world = empty_world<2>();
  add_box(world, 0.0f, 0.0f, 2.0f);
  WorldState<2> state = world.state();
  state.bodies.moved(0).position[1] = -0.3f;
  state.bodies.moved(0).velocity[1] = -2.0f;
  // It has fallen 0.3 m of 2 kg, which is 6 J, but goes with 4 J: nothing gained.
  EXPECT_EQ(watch(world.state(), state).energy_gained_j, 0.0);
  state.bodies.moved(0).velocity[1] = -3.0f;
  const Metrics metrics = watch(world.state(), state);
  EXPECT_NEAR(*metrics.energy_gained_j, 3.0, 1e-5);
  EXPECT_NEAR(*metrics.jitter_m_s, 3.0, 1e-6);
  // Of 9 J in motion, and 2 J that lift 2 kg by 0.1 m.
  ASSERT_TRUE(metrics.energy_gained_share.has_value());
  EXPECT_NEAR(*metrics.energy_gained_share, 3.0 / 11.0, 1e-5);
}

template <int D>
static World<D> two_in_free_flight() {
  solver::WorldDef<D> def;
  def.gravity[1] = -10.0f;
  World<D> world = std::move(World<D>::create(def).value());
  add_box(world, -2.0f, 0.0f);
  add_box(world, 2.0f, 0.0f, 3.0f);
  solver::Spin<D> spin = solver::Spin<D>::zero();
  spin[0] = 2.0f;
  solver::Vec<D> velocity = solver::Vec<D>::zero();
  velocity[1] = 1.0f;
  EXPECT_TRUE(world.set_velocity(world.bodies()[0].id, velocity, spin).ok());
  return world;
}

template <int D>
static void expect_momenta_to_be_kept() {
  World<D> world = two_in_free_flight<D>();
  Observer<D> observer(world.state(), 60, false, {});
  for (std::uint32_t tick = 1; tick <= 60; ++tick) {
    ASSERT_TRUE(world.step().ok());
    ASSERT_TRUE(observer.look(world.state(), tick));
  }
  const Metrics metrics = observer.finish(world.state());
  ASSERT_TRUE(metrics.momentum_drift && metrics.angular_momentum_drift);
  EXPECT_LT(*metrics.momentum_drift, 1e-5);
  EXPECT_LT(*metrics.angular_momentum_drift, 1e-5);
}
TEST(Observer, FindsMomentaKeptInFreeFlightInThePlane) {
  expect_momenta_to_be_kept<2>();
}
TEST(Observer, FindsMomentaKeptInFreeFlightInSpace) {
  expect_momenta_to_be_kept<3>();
}

// A push from nowhere in one tick of a free body of 1 kg and one of 3 kg.
TEST(Observer, SeesMomentumThatCameFromNowhere) {
  solver::WorldDef<2> def;
  World<2> world = std::move(World<2>::create(def).value());
  add_box(world, -2.0f, 0.0f);
  add_box(world, 2.0f, 0.0f, 3.0f);
  WorldState<2> state = world.state();
  state.bodies.moved(0).velocity[1] = 2.0f;
  const Metrics metrics = watch(world.state(), state);
  ASSERT_TRUE(metrics.momentum_drift && metrics.angular_momentum_drift);
  EXPECT_NEAR(*metrics.momentum_drift, 1.0, 1e-6) << "all of it is new";
  EXPECT_NEAR(*metrics.angular_momentum_drift, 1.0, 1e-6);
}

/// The drift of a resting box that is pushed 1 mm further in each of so many ticks.
static std::optional<double> drift_of_a_millimetre_a_tick(std::uint32_t ticks) {
  World<2> world = resting_box<2>();
  Observer<2> observer(world.state(), ticks, false, {});
  WorldState<2> state = world.state();
  for (std::uint32_t tick = 1; tick <= ticks; ++tick) {
    state.bodies.moved(1).position[0] += 0.001f;
    EXPECT_TRUE(observer.look(state, tick));
  }
  return observer.finish(state).stick_drift_mm_min;
}

TEST(Observer, SeesContactsThatCreep) {
  for (const std::uint32_t ticks : {4u, 20u, 120u}) {
    const auto drift = drift_of_a_millimetre_a_tick(ticks);
    ASSERT_TRUE(drift.has_value()) << ticks;
    EXPECT_NEAR(*drift, 60.0 * 60.0, 1.0) << ticks;
  }
  EXPECT_FALSE(drift_of_a_millimetre_a_tick(2).has_value()) << "one look shows no motion";
  World<2> world = resting_box<2>();
  const auto still = watch(world.state(), world.state()).stick_drift_mm_min;
  ASSERT_TRUE(still.has_value());
  EXPECT_EQ(*still, 0.0);
}

TEST(Observer, CallsNoSlidingContactStuck) {
  World<2> world = resting_box<2>();
  WorldState<2> state = world.state();
  for (auto& point : state.contacts[0].points)
    point.tangent_impulse[0] = 0.6f * point.normal_impulse;
  EXPECT_FALSE(watch(state, state).stick_drift_mm_min.has_value());
}

TEST(Observer, SeesAWorldThatIsNoLongerFinite) {
  World<2> world = resting_box<2>();
  WorldState<2> state = world.state();
  Observer<2> observer(state, 10, false, {});
  EXPECT_TRUE(observer.look(state, 1));
  state.bodies.moved(1).velocity[0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(observer.look(state, 2));
}

// Impulses that XPBD does not keep must not be judged as if they were none.
TEST(Observer, SaysNothingOfImpulsesThatTheMethodDoesNotKeep) {
  World<2> world = empty_world<2>(solver::Tuning::xpbd());
  add_ground(world);
  add_box(world, 0.0f, 0.5f);
  step(world, 60);
  const Metrics metrics = watch(world.state(), world.state());
  EXPECT_FALSE(metrics.natural_map || metrics.complementarity_j || metrics.impulse_error ||
               metrics.wrench_error || metrics.velocity_error || metrics.cone_excess ||
               metrics.stick_drift_mm_min);
}

}  // namespace cycloid::accuracy
