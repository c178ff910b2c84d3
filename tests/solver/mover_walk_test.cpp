#include <cmath>
#include <cstring>
#include <vector>

#include "tests/solver/mover_fixture.hpp"

namespace cycloid::solver {

static World<2> make_step(float height) {
  World<2> world = make_world<2>();
  add_ground<2>(world, up<2>());
  add_static_box(world, {{6.0f, height - 1.0f}}, 5.0f, 1.0f);
  return world;
}

TEST(Mover, ClimbsStepsUpToItsStepHeightAndNoHigher) {
  for (const float speed : {0.5f, 2.0f, 8.0f}) {
    for (const float height : {0.05f, 0.2f, 0.3f, 0.34f, 0.36f, 0.4f, 1.0f}) {
      const World<2> world = make_step(height);
      MoverState<2> state;
      state.position = {{0.0f, kSkin}};
      for (int tick = 0; tick < static_cast<int>(150.0f / speed); ++tick) {
        state = walk(world, walker(), state, speed);
        ASSERT_TRUE(state.grounded) << height << " at " << state.position[0];
        ASSERT_GE(clearance(world, walker(), state.position), 0.0f);
      }
      if (height < 0.35f) {
        EXPECT_NEAR(state.position[1], height + kSkin, 0.006f) << height << " at " << speed;
        EXPECT_GT(state.position[0], 1.5f) << height << " at " << speed;
      } else {
        EXPECT_NEAR(state.position[1], kSkin, 0.006f) << height << " at " << speed;
        EXPECT_NEAR(state.position[0], 1.0f - 0.3f - kSkin, 0.001f) << height;
      }
    }
  }
}

TEST(Mover, FollowsTheGroundDownStepsWithoutLeavingIt) {
  const World<2> world = make_step(0.3f);
  MoverState<2> state;
  state.position = {{2.0f, 0.3f + kSkin}};
  state.grounded = true;
  for (int tick = 0; tick < 90; ++tick) {
    state = walk(world, walker(), state, -2.0f);
    ASSERT_TRUE(state.grounded) << state.position[0];
  }
  EXPECT_NEAR(state.position[1], kSkin, 0.006f);
  EXPECT_NEAR(state.position[0], 2.0f - 3.0f, 0.05f);
}

TEST(Mover, ClimbsSlopesUpToItsLimitAndNoSteeper) {
  for (const float angle_deg : {10.0f, 40.0f, 44.0f, 46.0f, 50.0f, 70.0f}) {
    World<2> world = make_world<2>();
    add_ground<2>(world, up<2>());
    add_ground<2>(world, {{-std::sin(radians(angle_deg)), std::cos(radians(angle_deg))}});
    MoverState<2> state;
    state.position = {{-1.0f, kSkin}};
    for (int tick = 0; tick < 180; ++tick) {
      state = walk(world, walker(), state, 2.0f);
      ASSERT_TRUE(state.grounded) << angle_deg << " at " << state.position[0];
    }
    const float high = state.position[1];
    if (angle_deg < 45.0f) {
      // On the slope a horizontal wish is projected: cos^2 of it is left.
      const float c = std::cos(radians(angle_deg));
      EXPECT_GT(high, 0.8f * 2.0f * c * c * 2.0f * std::tan(radians(angle_deg))) << angle_deg;
      EXPECT_LT(high, 5.3f * c * c * std::tan(radians(angle_deg))) << angle_deg;  // In 2.5 s.
      for (int tick = 0; tick < 60; ++tick) {
        state = walk(world, walker(), state, -1.0f);
        ASSERT_TRUE(state.grounded) << angle_deg;
      }
      EXPECT_NEAR(state.position[1] - high, -std::tan(radians(angle_deg)), 0.03f) << angle_deg;
    } else {
      EXPECT_NEAR(high, kSkin, 0.006f) << angle_deg;
    }
  }
}

TEST(Mover, LeavesOverlapAtItsRecoverySpeed) {
  World<2> world = make_world<2>();
  add_ground<2>(world, up<2>());
  MoverState<2> state;
  state.position = {{0.0f, -0.2f}};
  int ticks = 0;
  while (state.position[1] < 0.99f * kSkin && ticks < 100) {
    const float before = state.position[1];
    state = walk(world, walker(), state, 1.0f);
    EXPECT_LE(state.position[1] - before, 3.0f * kMoveTick + 1.0e-6f);
    ++ticks;
  }
  EXPECT_EQ(ticks, 5);                                        // 0.21 m in steps of 0.05 m.
  EXPECT_NEAR(state.position[0], 5.0f * kMoveTick, 1.0e-3f);  // It walks meanwhile.
}

TEST(Mover, RidesAPlatform) {
  for (const Vec<2> velocity :
       {Vec<2>{{2.0f, 0.0f}}, Vec<2>{{0.0f, 2.0f}}, Vec<2>{{1.0f, -1.0f}}}) {
    World<2> world = make_world<2>();
    BodyDef<2> def;
    def.kind = BodyKind::kKinematic;
    def.position = {{0.0f, -0.5f}};
    def.velocity = velocity;
    const BodyId platform = add(world, def, box(2.0f, 0.5f));
    MoverState<2> state;
    state.position = {{0.0f, kSkin}};
    state = move(world.state(), walker(), state, kMoveTick).state;
    ASSERT_TRUE(state.grounded);
    EXPECT_EQ(state.ground, platform);
    // It came down with the world's velocity, so it is the platform that moves; now it stands.
    EXPECT_NEAR(state.velocity[0], -velocity[0], 1.0e-6f);
    state.velocity = Vec<2>::zero();
    for (int tick = 0; tick < 120; ++tick) {
      state = move(world.state(), walker(), state, kMoveTick).state;
      step(world, 1);
      ASSERT_TRUE(state.grounded) << tick;
    }
    const Vec<2> surface = view(world, platform).position + Vec<2>{{0.0f, 0.5f}};
    EXPECT_NEAR(state.position[0] - surface[0], 0.0f, 1.0e-3f);
    // Ground that sinks is followed a tick later.
    EXPECT_NEAR(state.position[1] - surface[1], kSkin + kMoveTick * max(0.0f, -velocity[1]),
                1.0e-3f);
    EXPECT_NEAR(length(state.velocity), 0.0f, 1.0e-5f);
    // A jump takes the platform's velocity along.
    state.velocity[1] = 3.0f;
    state = move(world.state(), walker(), state, kMoveTick).state;
    EXPECT_FALSE(state.grounded);
    EXPECT_NEAR(state.velocity[0], velocity[0], 1.0e-5f);
    EXPECT_NEAR(state.velocity[1], velocity[1] + 3.0f, 1.0e-5f);
  }
}

TEST(Mover, SameCallsGiveTheSameBits) {
  std::vector<MoverState<2>> runs[2];
  for (std::vector<MoverState<2>>& run : runs) {
    const World<2> world = make_step(0.3f);
    MoverState<2> state;
    state.position = {{-0.3f, 0.7f}};
    for (int tick = 0; tick < 200; ++tick) {
      state = walk(world, walker(), state, tick % 90 < 60 ? 2.3f : -1.7f);
      if (tick % 50 == 49) state.velocity[1] = 4.0f;
      run.push_back(state);
    }
  }
  for (std::size_t i = 0; i < runs[0].size(); ++i) {
    EXPECT_EQ(std::memcmp(&runs[0][i].position, &runs[1][i].position, sizeof(Vec<2>)), 0);
    EXPECT_EQ(std::memcmp(&runs[0][i].velocity, &runs[1][i].velocity, sizeof(Vec<2>)), 0);
    EXPECT_EQ(runs[0][i].grounded, runs[1][i].grounded);
  }
}

}  // namespace cycloid::solver
