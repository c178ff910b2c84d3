#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

/// A ball of 1 kg without friction on the ground, and on it one of 1000 kg: more than soft contacts
/// hold up, so it is a loaded island, and it is all that moves.
template <int D>
struct Column {
  World<D> world;
  BodyId light;
  BodyId heavy;
};

struct Asked {
  Tuning tuning;
  float restitution = 0.0f;
  float speed = 0.0f;    ///< Of both along the ground, m/s.
  float spin = 0.0f;     ///< Of the heavy one, rad/s.
  float damping = 0.0f;  ///< 1/s.
};

template <int D>
static Column<D> make_column(const Asked& asked) {
  Material material;
  material.friction = 0.0f;
  material.restitution = asked.restitution;
  WorldDef<D> def = with_gravity<D>(material);
  def.tuning = asked.tuning;
  def.tuning.sleep_s = 0.0f;
  World<D> world = make_world<D>(def);
  add_ground<D>(world, up<D>());
  BodyDef<D> body;
  body.mass = 1.0f;
  body.position[1] = 0.5f;
  body.velocity[0] = asked.speed;
  body.linear_damping = asked.damping;
  const BodyId light = add(world, body, ball<D>(0.5f));
  body.mass = 1000.0f;
  body.position[1] = 1.5f;
  body.spin[Dim<D>::kSpin - 1] = asked.spin;
  const BodyId heavy = add(world, body, ball<D>(0.5f));
  return {std::move(world), light, heavy};
}

template <int D>
static std::uint32_t substeps_after(int ticks, const Asked& asked) {
  Column<D> column = make_column<D>(asked);
  step(column.world, ticks);
  return column.world.statistics().substeps;
}

/// Of both contacts in a tick, as the state has them in one substep of those asked for, N s.
template <int D>
static float impulse_of_tick(const World<D>& world) {
  float sum = 0.0f;
  for (const Contact<D>& contact : world.state().contacts) sum += contact.points[0].normal_impulse;
  return sum * static_cast<float>(world.state().header.tuning.substeps);
}

TEST(FewerSubsteps, HalfAsManyWhereLoadedIslandsHaveAllThatMoves) {
  EXPECT_EQ(substeps_after<2>(30, {}), 2u);
  EXPECT_EQ(substeps_after<3>(30, {}), 2u);
  EXPECT_EQ(substeps_after<2>(30, {Tuning{}.in_substeps(8)}), 4u);
}

TEST(FewerSubsteps, NotWhereItWouldNotBeHalfOrTooFew) {
  for (const std::uint32_t asked : {1u, 2u, 3u, 5u})
    EXPECT_EQ(substeps_after<2>(30, {Tuning{}.in_substeps(asked)}), asked);
}

TEST(FewerSubsteps, UnderNoOtherMethod) {
  EXPECT_EQ(substeps_after<2>(30, {Tuning::soft_step()}), 4u);
  Tuning islands;
  islands.contact_block = ContactBlockRows::kIsland;
  EXPECT_EQ(substeps_after<2>(30, {islands}), 4u);
}

TEST(FewerSubsteps, NotBeforeThereIsALoad) {
  EXPECT_EQ(substeps_after<2>(1, {}), 4u);
}

TEST(FewerSubsteps, NotWhereSweepsAct) {
  EXPECT_EQ(substeps_after<2>(30, {{}, 0.5f}), 4u);
}

// 0.025 rad in a substep of 1/120 s.
TEST(FewerSubsteps, NotWhileSomethingTurnsFast) {
  EXPECT_EQ(substeps_after<2>(30, {{}, 0.0f, 0.0f, 2.9f}), 2u);
  EXPECT_EQ(substeps_after<2>(30, {{}, 0.0f, 0.0f, 3.1f}), 4u);
  EXPECT_EQ(substeps_after<3>(30, {{}, 0.0f, 0.0f, 2.9f}), 2u);
  EXPECT_EQ(substeps_after<3>(30, {{}, 0.0f, 0.0f, 3.1f}), 4u);
}

TEST(FewerSubsteps, NotWhileAnythingElseMoves) {
  Column<2> column = make_column<2>({});
  step(column.world, 30);
  const BodyId falls = add_at<2>(column.world, {{50.0f, 40.0f}}, ball<2>(0.5f));
  step(column.world, 1);
  EXPECT_EQ(column.world.statistics().substeps, 4u);
  ASSERT_TRUE(column.world.destroy_body(falls).ok());
  step(column.world, 1);
  EXPECT_EQ(column.world.statistics().substeps, 2u);
}

// What holds is a force, so neither the one change nor the other moves what rests.
template <int D>
static void expect_rest_through_changes() {
  Column<D> column = make_column<D>({});
  step(column.world, 60);
  const float weight = (1001.0f + 1000.0f) * 10.0f / 60.0f;
  for (int change = 0; change < 6; ++change) {
    if (change % 2 == 0) {
      Vec<D> far = Vec<D>::zero();
      far[0] = 50.0f;
      far[1] = 400.0f;
      const BodyId falls = add_at<D>(column.world, far, ball<D>(0.5f));
      step(column.world, 1);
      ASSERT_TRUE(column.world.destroy_body(falls).ok());
    } else {
      step(column.world, 1);
    }
    ASSERT_EQ(column.world.statistics().substeps, change % 2 == 0 ? 4u : 2u);
    EXPECT_NEAR(impulse_of_tick(column.world), weight, 0.01f * weight);
    EXPECT_LT(length(view(column.world, column.light).velocity), 2.0e-3f);
    EXPECT_LT(length(view(column.world, column.heavy).velocity), 2.0e-3f);
  }
}
TEST(FewerSubsteps, WhatRestsStaysAtRestAsTheyChange) {
  expect_rest_through_changes<2>();
  expect_rest_through_changes<3>();
}

TEST(FewerSubsteps, DampingIsThatOfTheirLength) {
  Column<2> column = make_column<2>({{}, 0.0f, 1.0f, 0.0f, 2.0f});
  step(column.world, 30);
  const float before = view(column.world, column.heavy).velocity[0];
  step(column.world, 30);
  ASSERT_EQ(column.world.statistics().substeps, 2u);
  float left = 1.0f;
  for (int substep = 0; substep < 60; ++substep) left /= 1.0f + 2.0f / 120.0f;
  EXPECT_NEAR(view(column.world, column.heavy).velocity[0] / before, left, 1.0e-4f);
}

}  // namespace cycloid::solver
