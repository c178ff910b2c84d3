#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "solver/character/mover.hpp"
#include "tests/solver/mover_fixture.hpp"
#include "tests/solver/query_3d_fixture.hpp"

namespace cycloid::solver {

/// 1.8 m tall; the position is that of the feet.
static MoverDef<3> tall() {
  MoverDef<3> def;
  def.lower = {{0, 0.3f, 0}};
  def.upper = {{0, 1.5f, 0}};
  return def;
}

static BodyId add_block(World<3>& world, Vec<3> centre, Vec<3> half,
                        Rotation<3> rotation = identity_rotation<3>()) {
  BodyDef<3> def;
  def.kind = BodyKind::kStatic;
  def.position = centre;
  def.rotation = rotation;
  ShapeDef<3> shape;
  shape.kind = ShapeKind::kBox;
  shape.half = half;
  return add(world, def, shape);
}

static World<3> with_floor() {
  World<3> world = make_world<3>();
  add_block(world, {{0, -1, 0}}, {{50, 1, 50}});
  return world;
}

static float gap_of(const World<3>& world, const MoverDef<3>& def, const Vec<3>& position) {
  Probe<3> probe{};
  probe.count = 2;
  probe.radius = def.radius;
  probe.points[0] = def.lower;
  probe.points[1] = def.upper;
  float least = 1.0f;
  for (const QueryHit<3>& hit :
       overlap(world.state(), probe, Pose<3>{position, identity_rotation<3>()}, 1.0f, def.filter))
    least = std::min(least, hit.separation);
  return least;
}

static MoverState<3> walk_3d(const World<3>& world, MoverState<3> state, float x, float z) {
  state.velocity[0] = x;
  state.velocity[2] = z;
  if (!state.grounded) state.velocity[1] -= 10.0f * kMoveTick;
  return move(world.state(), tall(), state, kMoveTick).state;
}

static MoverState<3> standing(float x, float z) {
  MoverState<3> state;
  state.position = {{x, kSkin, z}};
  state.grounded = true;
  return state;
}

TEST(MoverInSpace, WalksOnABoxAndStaysItsSkinAbove) {
  const World<3> world = with_floor();
  MoverState<3> state = standing(0, 0);
  for (int tick = 0; tick < 60; ++tick) {
    state = walk_3d(world, state, 3, -4);
    ASSERT_TRUE(state.grounded) << tick;
    ASSERT_NEAR(state.position[1], kSkin, 0.002f) << tick;
  }
  EXPECT_NEAR(state.position[0], 3, 0.001f);
  EXPECT_NEAR(state.position[2], -4, 0.001f);
}

TEST(MoverInSpace, ClimbsStairsAndNoHighSteps) {
  World<3> world = with_floor();
  for (int i = 0; i < 6; ++i) {
    const float height = 0.25f * static_cast<float>(i + 1);
    add_block(world, {{1.0f + 0.6f * static_cast<float>(i) + 5, height - 1, 0}}, {{5, 1, 3}});
  }
  add_block(world, {{0, 0, 8}}, {{2, 0.5f, 2}});
  MoverState<3> state = standing(0, 0);
  for (int tick = 0; tick < 180; ++tick) {
    state = walk_3d(world, state, 2, 0.1f);
    ASSERT_TRUE(state.grounded) << state.position[0];
    ASSERT_GE(gap_of(world, tall(), state.position), 0.0f);
  }
  EXPECT_NEAR(state.position[1], 1.5f + kSkin, 0.006f);
  EXPECT_GT(state.position[0], 4.5f);
  MoverState<3> low = standing(0, 3);
  for (int tick = 0; tick < 180; ++tick) low = walk_3d(world, low, 0, 2);
  EXPECT_NEAR(low.position[1], kSkin, 0.006f);
  EXPECT_NEAR(low.position[2], 6 - 0.3f - kSkin, 0.001f);
}

TEST(MoverInSpace, SlidesAlongAWallByTheWholeTangentialDistance) {
  World<3> world = with_floor();
  const float turn = 0.6f;  // The wall's outward normal: (-cos, 0, sin) of it.
  add_block(world, {{3, 2, 0}}, {{0.1f, 2, 20}}, turned_about({{0, 1, 0}}, turn));
  const Vec<3> along = {{std::sin(turn), 0, std::cos(turn)}};
  MoverState<3> state = standing(0, 0);
  for (int tick = 0; tick < 120; ++tick) state = walk_3d(world, state, 4, 0);
  const Vec<3> before = state.position;
  for (int tick = 0; tick < 60; ++tick) {
    state = walk_3d(world, state, 4, 0);
    ASSERT_TRUE(state.grounded);
    ASSERT_NEAR(gap_of(world, tall(), state.position), kSkin, 0.002f);
  }
  const Vec<3> way = state.position - before;
  EXPECT_NEAR(dot(way, along), 4 * std::sin(turn), 0.01f);
  EXPECT_NEAR(length(way), 4 * std::sin(turn), 0.01f);
}

TEST(MoverInSpace, StopsInTheCornerOfTwoWalls) {
  World<3> world = with_floor();
  add_block(world, {{4, 2, 0}}, {{1, 2, 10}});
  add_block(world, {{0, 2, 4}}, {{10, 2, 1}});
  MoverState<3> state = standing(0, 0.5f);
  for (int tick = 0; tick < 200; ++tick) {
    state = walk_3d(world, state, 4, 3);
    ASSERT_TRUE(state.grounded) << tick;
  }
  EXPECT_NEAR(state.position[0], 3 - 0.3f - kSkin, 0.001f);
  EXPECT_NEAR(state.position[2], 3 - 0.3f - kSkin, 0.001f);
  const MoverState<3> again = walk_3d(world, state, 4, 3);
  EXPECT_NEAR(length(again.position - state.position), 0, 0.001f);
}

TEST(MoverInSpace, StopsInAWedgeOfFiveDegrees) {
  World<3> world = with_floor();
  const float half = radians(2.5f);
  const float span = 20.0f;
  for (const float side : {-1.0f, 1.0f}) {
    const Rotation<3> turn = turned_about({{0, 1, 0}}, side * half);
    // The inner face goes through the tip of the wedge, at x = 10.
    const Vec<3> centre = Vec<3>{{10, 2, 0}} + rotate(turn, {{-span, 0, side}});
    add_block(world, centre, {{span, 2, 1}}, turn);
  }
  const float stop = 10 - (0.3f + kSkin) / std::sin(half);
  MoverState<3> state = standing(stop - 4, 0);
  float last = state.position[0];
  for (int tick = 0; tick < 300; ++tick) {
    state = walk_3d(world, state, 3, 0.5f);
    ASSERT_GE(gap_of(world, tall(), state.position), 0.5f * kSkin) << tick;
    if (tick > 200) {
      ASSERT_NEAR(state.position[0], last, 0.002f) << tick;
    }
    last = state.position[0];
  }
  EXPECT_NEAR(state.position[0], stop, 0.05f);
}

TEST(MoverInSpace, ClimbsSlopesUpToItsLimitAndNoSteeper) {
  for (const float angle_deg : {10.0f, 40.0f, 50.0f, 70.0f}) {
    World<3> world = with_floor();
    const Rotation<3> turn = turned_about({{0, 0, 1}}, radians(angle_deg));
    add_block(world, rotate(turn, {{10, -1, 0}}), {{10, 1, 5}}, turn);
    MoverState<3> state = standing(-1, 0);
    for (int tick = 0; tick < 180; ++tick) {
      state = walk_3d(world, state, 2, 0.3f);
      ASSERT_TRUE(state.grounded) << angle_deg << " at " << state.position[0];
    }
    if (angle_deg < 45.0f) {
      const float c = std::cos(radians(angle_deg));
      EXPECT_GT(state.position[1], 0.8f * 4.0f * c * c * std::tan(radians(angle_deg))) << angle_deg;
    } else {
      EXPECT_NEAR(state.position[1], kSkin, 0.006f) << angle_deg;
      EXPECT_NEAR(state.position[2], 0.9f, 0.01f) << angle_deg;
    }
  }
}

TEST(MoverInSpace, NeverPassesAThinWallAtAnySpeed) {
  for (const float speed : {1.0f, 10.0f, 100.0f, 1000.0f})
    for (const float turn : {0.0f, 0.3f, 0.9f}) {
      World<3> world = with_floor();
      add_block(world, {{3, 2, 0}}, {{0.005f, 2, 200}}, turned_about({{0, 1, 0}}, turn));
      const Vec<3> normal = {{std::cos(turn), 0, -std::sin(turn)}};
      MoverState<3> state = standing(0, 0);
      for (int tick = 0; tick < 240; ++tick) {
        state = walk_3d(world, state, speed, 0);
        if (std::abs(state.position[2]) > 40) break;
        ASSERT_LT(dot(normal, state.position - Vec<3>{{3, 0, 0}}), -0.3f) << speed << " " << turn;
        ASSERT_GE(gap_of(world, tall(), state.position), 0.0f) << speed << " " << turn;
      }
    }
}

TEST(MoverInSpace, NeverOverlapsInAClutterAndGivesTheSameBits) {
  std::mt19937 random(31);
  World<3> world = with_floor();
  for (int i = 0; i < 60; ++i) {
    const Vec<3> at = random_vector(random, 8);
    const float clear = std::sqrt(at[0] * at[0] + at[2] * at[2]);
    if (clear < 2) continue;
    add_block(
        world, {{at[0], 0.5f, at[2]}},
        {{uniform(random, 0.1f, 0.8f), uniform(random, 0.3f, 1), uniform(random, 0.1f, 0.8f)}},
        turned_about({{0, 1, 0}}, uniform(random, -3, 3)));
  }
  for (const float speed : {2.0f, 20.0f, 100.0f}) {
    MoverState<3> state = standing(0, 0);
    for (int tick = 0; tick < 400; ++tick) {
      const float angle = 0.05f * static_cast<float>(tick);
      const float x = speed * std::cos(angle), z = speed * std::sin(angle);
      const MoverState<3> next = walk_3d(world, state, x, z);
      const MoverState<3> again = walk_3d(world, state, x, z);
      ASSERT_EQ(std::memcmp(&next.position, &again.position, sizeof next.position), 0);
      state = next;
      if (length(state.position) > 45) break;
      ASSERT_GE(gap_of(world, tall(), state.position), -1e-4f) << speed << " at " << tick;
    }
  }
}

}  // namespace cycloid::solver
