#include <array>
#include <bit>
#include <utility>
#include <vector>

#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

/// The two normal impulses of a box on a plane after one sweep from nothing.
static std::array<float, 2> impulses_after_one_sweep(ContactBlockRows together) {
  Tuning tuning = Tuning::pgs();
  tuning.sweeps = 1;
  tuning.warm_starting = 0.0f;
  tuning.contact_block = together;
  World<2> world = make_world(def_with<2>(tuning));
  add_ground<2>(world, up<2>());
  add_stack(world, 1);
  step(world, 1);
  const auto& contacts = world.state().contacts;
  EXPECT_EQ(contacts.size(), 1u);
  EXPECT_EQ(contacts[0].point_count, 2u);
  return {contacts[0].points[0].normal_impulse, contacts[0].points[1].normal_impulse};
}

TEST(BlockSolver, IsExactInOneSweepForABoxOnAPlane) {
  const float half_weight = 0.5f * 10.0f * kTick;
  const auto together = impulses_after_one_sweep(ContactBlockRows::kNormals);
  EXPECT_NEAR(together[0], half_weight, 1.0e-6f);
  EXPECT_NEAR(together[1], half_weight, 1.0e-6f);
  // One after the other is not: the first row has K = 1 + 1.5 and takes 0.4 of the weight.
  const auto apart = impulses_after_one_sweep(ContactBlockRows::kNone);
  EXPECT_NEAR(apart[0], 0.8f * half_weight, 1.0e-5f);
}

/// Velocity and spin of a leaning rod one tick after its tip has struck the ground.
static Vec<3> struck_rod(ContactBlockRows together, std::uint32_t sweeps, float speed_x) {
  Tuning tuning = Tuning::pgs();
  tuning.sweeps = sweeps;
  tuning.warm_starting = 0.0f;
  tuning.contact_block = together;
  World<2> world = make_world(def_with<2>(tuning, {2.0f, 0.0f}));
  add_ground<2>(world, up<2>());
  BodyDef<2> def;
  const float lean = 1.0472f;  // 60 degrees: 2 |K_nt| / K_nn = 1.48.
  def.position = {{0.0f, std::sin(lean) + 0.02f}};
  def.rotation = turned(lean);
  def.velocity = {{speed_x, -2.0f}};
  const BodyId rod = add(world, def, capsule(1.0f, 0.02f));
  step(world, 1);
  EXPECT_EQ(world.statistics().contacts, 1u);
  const BodyView<2> now = view(world, rod);
  return {{now.velocity[0], now.velocity[1], now.spin[0]}};
}

TEST(BlockSolver, NormalAndFrictionTogetherDoNotCycleWhereOneAfterTheOtherDoes) {
  bool cycled = false;
  for (const float speed_x : {-6.0f, -3.0f, 0.0f, 3.0f, 6.0f, 9.0f}) {
    const auto change = [&](ContactBlockRows together) {
      return length(struck_rod(together, 41, speed_x) - struck_rod(together, 40, speed_x));
    };
    cycled = cycled || change(ContactBlockRows::kNone) > 0.01f;
    EXPECT_LT(change(ContactBlockRows::kNormalFriction), 1.0e-5f) << "speed " << speed_x;
  }
  EXPECT_TRUE(cycled);
}

/// Sweeps from nothing until the ground carries 1 + 10 kg within a thousandth.
static std::uint32_t sweeps_to_carry(float over_relaxation) {
  for (std::uint32_t sweeps = 1; sweeps < 400; ++sweeps) {
    Tuning tuning = Tuning::pgs();
    tuning.sweeps = sweeps;
    tuning.warm_starting = 0.0f;
    tuning.over_relaxation = over_relaxation;
    World<2> world = make_world(def_with<2>(tuning, {0.0f, 0.0f}));
    add_ground<2>(world, up<2>());
    BodyDef<2> def;
    def.position = {{0.0f, 0.5f}};
    def.mass = 1.0f;
    add(world, def, ball<2>(0.5f));
    def.position = {{0.0f, 1.5f}};
    def.mass = 10.0f;
    add(world, def, ball<2>(0.5f));
    step(world, 1);
    const float carried = world.state().contacts[0].points[0].normal_impulse;
    if (std::abs(carried / (110.0f * kTick) - 1.0f) < 1.0e-3f) return sweeps;
  }
  return 400;
}

// Two rows with mu^2 = 1 / 1.1: a sweep keeps 0.909 of the error, with omega = 1.3 it keeps 0.827,
// from (lambda + omega - 1)^2 = lambda omega^2 mu^2; log 0.909 / log 0.827 = 0.50.
TEST(OverRelaxation, HalvesTheSweepsOfATenToOnePair) {
  const std::uint32_t plain = sweeps_to_carry(1.0f);
  const std::uint32_t relaxed = sweeps_to_carry(1.3f);
  EXPECT_GT(plain, 50u);
  EXPECT_LT(plain, 90u);
  EXPECT_NEAR(static_cast<float>(relaxed), 0.5f * static_cast<float>(plain), 4.0f);
}

}  // namespace cycloid::solver
