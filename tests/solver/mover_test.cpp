#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "tests/solver/mover_fixture.hpp"

namespace cycloid::solver {

TEST(Mover, NeverPassesAThinWallAtAnySpeed) {
  World<2> world = make_world<2>();
  add_static_box(world, {{1.01f, 0.0f}}, 0.01f, 4000.0f);
  const MoverDef<2> def = ball_mover<2>(0.1f);
  for (const float angle_deg : {0.0f, 45.0f, 80.0f}) {
    for (const float speed : {1.0f, 100.0f, 1000.0f, 100000.0f}) {
      MoverState<2> state;
      state.velocity = {
          {speed * std::cos(radians(angle_deg)), speed * std::sin(radians(angle_deg))}};
      const float wanted = state.velocity[0] * kMoveTick;
      for (int tick = 0; tick < 2; ++tick) {
        state = move(world.state(), def, state, kMoveTick).state;
        const float tolerance = 1.0e-6f * speed * kMoveTick + 1.0e-5f;
        if (wanted < 0.4f) {
          EXPECT_NEAR(state.position[0], wanted * (static_cast<float>(tick) + 1.0f), 1.0e-6f);
        } else {
          EXPECT_NEAR(state.position[0], 1.0f - 0.1f - kSkin, tolerance) << speed;
          EXPECT_NEAR(state.velocity[0], 0.0f, 1.0e-6f * speed);
        }
      }
    }
  }
}

TEST(Mover, NeverPassesAHalfSpaceOrABallInSpace) {
  World<3> world = make_world<3>();
  add_ground<3>(world, up<3>());
  BodyDef<3> def;
  def.kind = BodyKind::kStatic;
  def.position = {{5.0f, 1.0f, 0.0f}};
  add(world, def, ball<3>(0.5f));
  for (const float speed : {1.0f, 100.0f, 1000.0f, 100000.0f}) {
    MoverState<3> state;
    state.position = {{0.0f, 1.0f, 0.0f}};
    state.velocity = {{speed, -speed, 0.0f}};
    for (int tick = 0; tick < 3; ++tick) {
      state = move(world.state(), ball_mover<3>(0.3f), state, kMoveTick).state;
      EXPECT_GE(clearance(world, ball_mover<3>(0.3f), state.position), 0.0f) << speed;
    }
  }
}

TEST(Mover, WalksOnTheGroundInSpace) {
  World<3> world = make_world<3>();
  const float c = std::cos(radians(30.0f));
  add_ground<3>(world, up<3>());
  add_ground<3>(world, {{-0.5f, c, 0.0f}});
  MoverState<3> state;
  state.position = {{-1.0f, 0.31f, 0.0f}};
  for (int tick = 0; tick < 120; ++tick) {
    state.velocity = {{1.0f, tick == 0 ? -1.0f : 0.0f, 1.0f}};
    state = move(world.state(), ball_mover<3>(0.3f), state, kMoveTick).state;
    ASSERT_TRUE(state.grounded) << tick;
  }
  // Where the ball is on the slope its centre is radius + skin off it; along it nothing is lost.
  EXPECT_NEAR(c * state.position[1] - 0.5f * state.position[0], 0.31f, 0.006f);
  EXPECT_GT(state.position[1], 0.6f);
  EXPECT_NEAR(state.position[2], 2.0f, 1.0e-4f);
}

TEST(Mover, SlidesAlongAWallByTheWholeTangentialDistance) {
  for (const float angle_deg : {0.0f, 17.0f, 45.0f, 73.0f}) {
    World<2> world = make_world<2>();
    const Vec<2> normal = {{-std::sin(radians(angle_deg)), std::cos(radians(angle_deg))}};
    const Vec<2> along = {{normal[1], -normal[0]}};
    add_ground<2>(world, normal);
    MoverDef<2> def = ball_mover<2>(0.3f);
    def.slope_cos_min = 1.1f;  // No plane is walkable, and none of these is seen as steep.
    def.up = -normal;
    MoverState<2> state;
    state.position = 0.31f * normal;
    for (int tick = 1; tick <= 60; ++tick) {
      state.velocity = 3.0f * along - 2.0f * normal;
      state = move(world.state(), def, state, kMoveTick).state;
      EXPECT_NEAR(dot(state.position, along), 3.0f * kMoveTick * static_cast<float>(tick), 1.0e-5f);
      EXPECT_NEAR(dot(state.position, normal), 0.31f, 1.0e-5f);
      EXPECT_NEAR(dot(state.velocity, along), 3.0f, 1.0e-5f);
      EXPECT_NEAR(dot(state.velocity, normal), 0.0f, 1.0e-5f);
    }
  }
}

/// Two half-spaces whose free region opens towards -x with the apex at the origin.
static World<2> make_corner(float angle_deg) {
  World<2> world = make_world<2>();
  const float s = std::sin(radians(angle_deg) / 2.0f);
  const float c = std::cos(radians(angle_deg) / 2.0f);
  add_ground<2>(world, {{-s, c}});
  add_ground<2>(world, {{-s, -c}});
  return world;
}

TEST(Mover, StopsInCornersAtTheExactPlace) {
  for (const float angle_deg : {90.0f, 30.0f, 10.0f, 5.0f, 1.0f}) {
    const World<2> world = make_corner(angle_deg);
    const MoverDef<2> def = ball_mover<2>(0.1f);
    // The centre stops where both walls are radius + skin away.
    const float apex = -0.11f / std::sin(radians(angle_deg) / 2.0f);
    for (const float speed : {5.0f, 50.0f, 5000.0f}) {
      MoverState<2> state;
      state.position = {{apex - 2.0f, 0.01f}};
      for (int tick = 0; tick < 60; ++tick) {
        state.velocity = {{speed, 0.0f}};
        state = move(world.state(), def, state, kMoveTick).state;
        ASSERT_GE(clearance(world, def, state.position), 0.9f * kSkin) << angle_deg;
      }
      // Within what the tolerance of the loop, a hundredth of the skin, allows.
      EXPECT_NEAR(state.position[0], apex, 0.001f) << angle_deg << " at " << speed;
      EXPECT_NEAR(state.position[1], 0.0f, 0.001f);
      EXPECT_NEAR(length(state.velocity), 0.0f, 1.0e-6f * speed) << angle_deg;
    }
  }
}

// In front of convex walls the end is a function of the target alone.
TEST(Mover, EndsAtThePointClosestToTheTargetFromAnyStart) {
  const World<2> world = make_corner(30.0f);
  const float apex = -0.11f / std::sin(radians(15.0f));
  for (const Vec<2> start : {Vec<2>{{-3.0f, 0.0f}}, Vec<2>{{-2.0f, 0.3f}}, Vec<2>{{-5.0f, -1.0f}},
                             Vec<2>{{-1.0f, 0.05f}}, Vec<2>{{-0.5f, 0.0f}}}) {
    MoverState<2> state;
    state.position = start;
    state.velocity = 60.0f * (Vec<2>{{1.0f, 0.2f}} - start);
    const MoverStep<2> moved = move(world.state(), ball_mover<2>(0.1f), state, kMoveTick);
    EXPECT_LT(length(moved.state.position - Vec<2>{{apex, 0.0f}}), 1.0e-3f) << start[0];
    EXPECT_LT(moved.iterations, 8);
  }
}

/// A floor and a step of this height from x = 1 on.
static void wander_in_clutter(unsigned seed) {
  std::mt19937 random(seed);
  const auto draw = [&](float low, float high) {
    return low + (high - low) * static_cast<float>(random() >> 8) / 16777216.0f;
  };
  World<2> world = make_world<2>();
  for (int i = 0; i < 120; ++i) {
    const Vec<2> at = {{draw(-8.0f, 8.0f), draw(-8.0f, 8.0f)}};
    if (length(at) < 1.5f) continue;
    BodyDef<2> def;
    def.kind = BodyKind::kStatic;
    def.position = at;
    def.rotation = turned(draw(0.0f, 6.0f));
    const float size = draw(0.1f, 0.8f);
    const ShapeDef<2> shapes[] = {ball<2>(size), box(size, 0.05f), capsule(size, 0.2f)};
    add(world, def, shapes[i % 3]);
  }
  for (const float speed : {1.0f, 10.0f, 1000.0f}) {
    MoverState<2> state;
    float least = 1.0f;
    for (int tick = 0; tick < 3000; ++tick) {
      if (tick % 20 == 0) state.velocity = {{draw(-speed, speed), draw(-speed, speed)}};
      state = move(world.state(), ball_mover<2>(0.2f), state, kMoveTick).state;
      least = std::min(least, clearance(world, ball_mover<2>(0.2f), state.position));
      if (length(state.position) > 9.0f) state.position = Vec<2>::zero();
    }
    EXPECT_GE(least, 0.0f) << speed;
    EXPECT_LE(least, 1.01f * kSkin) << speed << ": it met nothing";
  }
}

// Two of 60 seeds, chosen because following the ground once overlapped in them.
TEST(Mover, NeverOverlapsInAClutterAtAnySpeed) {
  wander_in_clutter(11);
  wander_in_clutter(49);
}

// Deeper than its radius there is nothing left to cast, and it only gets out.
TEST(Mover, LeavesAWallItIsDeepInWithoutPassingIt) {
  World<2> world = make_world<2>();
  add_static_box(world, {{0.0f, 0.0f}}, 0.5f, 4.0f);
  MoverState<2> state;
  state.position = {{-0.1f, 0.0f}};
  for (int tick = 0; tick < 30; ++tick) {
    state.velocity = {{5.0f, 0.0f}};
    const Vec<2> before = state.position;
    state = move(world.state(), ball_mover<2>(0.2f), state, kMoveTick).state;
    EXPECT_LE(length(state.position - before), 3.0f * kMoveTick + 1.0e-6f);
  }
  EXPECT_NEAR(state.position[0], -0.5f - 0.2f - kSkin, 1.0e-3f);
}

TEST(Mover, PushesABoxAndIsNotMovedThroughIt) {
  World<2> world = make_world<2>();
  BodyDef<2> def;
  def.position = {{1.0f, 0.0f}};
  def.mass = 10.0f;
  const BodyId id = add(world, def, box(0.5f, 0.5f));
  MoverState<2> state;
  const MoverDef<2> mover = ball_mover<2>(0.3f);
  bool first = true;
  for (int tick = 0; tick < 120; ++tick) {
    state.velocity = {{2.0f, 0.0f}};
    const MoverStep<2> moved = move(world.state(), mover, state, kMoveTick);
    for (const MoverImpulse<2>& push : moved.impulses) {
      EXPECT_EQ(push.body, id);
      // The reduced mass of 80 and 10 kg at 2 m/s would give 17.8 N s; 1000 N in a tick is less.
      if (first) {
        EXPECT_NEAR(push.impulse[0], 1000.0f * kMoveTick, 1.0e-4f);
      }
      EXPECT_LE(push.impulse[0], 1000.0f * kMoveTick * 1.0001f);
      first = false;
      ASSERT_TRUE(world.apply_impulse(push.body, push.impulse).ok());
    }
    state = moved.state;
    EXPECT_GE(clearance(world, mover, state.position), 0.0f);
    step(world, 1);
  }
  EXPECT_FALSE(first);
  EXPECT_GT(view(world, id).velocity[0], 1.6f);
  EXPECT_GT(view(world, id).position[0], 3.0f);
}

/// The mover that the talk warns of: clips its velocity against each plane it is about to enter,
/// one after the other, then integrates.
static Vec<2> clip_and_integrate(Vec<2> position, Vec<2> velocity,
                                 const std::vector<CollisionPlane<2>>& planes) {
  for (const CollisionPlane<2>& plane : planes) {
    const float into = dot(velocity, plane.normal);
    const float gap = dot(position, plane.normal) - plane.offset;
    if (gap + into * kMoveTick < 0.0f) velocity -= min(0.0f, into) * plane.normal;
  }
  return position + kMoveTick * velocity;
}

/// In double: how deep a position is in the deepest plane.
static double depth_in_planes(const std::vector<CollisionPlane<2>>& planes, const Vec<2>& x) {
  double depth = -1.0e300;
  for (const CollisionPlane<2>& plane : planes)
    depth = std::max(depth, double{plane.offset} - double{plane.normal[0]} * x[0] -
                                double{plane.normal[1]} * x[1]);
  return depth;
}

// In a corner one pass of clipping leaves a velocity that the second plane turned into the first:
// v cos(a / 2) cos(a) sin(a) into it, every tick again. The position mover stays at the apex.
TEST(VelocityClipping, LosesTheCornerWhereThePositionMoverDoesNot) {
  for (const float angle_deg : {30.0f, 10.0f, 5.0f}) {
    const float a = radians(angle_deg);
    std::vector<CollisionPlane<2>> planes = {{.normal = {{-std::sin(a / 2), std::cos(a / 2)}}},
                                             {.normal = {{-std::sin(a / 2), -std::cos(a / 2)}}}};
    const float speed = 6.0f;
    Vec<2> by_velocity = Vec<2>::zero();
    Vec<2> by_position = Vec<2>::zero();
    by_velocity = clip_and_integrate(by_velocity, {{speed, 0.0f}}, planes);
    const float expected = speed * kMoveTick * std::cos(a / 2) * std::cos(a) * std::sin(a);
    EXPECT_NEAR(depth_in_planes(planes, by_velocity), expected, 1.0e-6) << angle_deg;
    for (int tick = 1; tick < 60; ++tick)
      by_velocity = clip_and_integrate(by_velocity, {{speed, 0.0f}}, planes);
    for (int tick = 0; tick < 60; ++tick)
      by_position =
          solve_planes<2>(by_position + kMoveTick * Vec<2>{{speed, 0.0f}}, planes).position;
    // A second of walking into the corner: through it, and exactly at it.
    EXPECT_GT(depth_in_planes(planes, by_velocity), 10.0f * expected) << angle_deg;
    EXPECT_LE(depth_in_planes(planes, by_position), 1.0e-7) << angle_deg;
    EXPECT_LE(length(by_position), 1.0e-6f) << angle_deg;
  }
}

// Along one plane the clipped velocity keeps a rounding error, which time turns into depth: the
// position mover has the rounding of one position instead, however long it walks.
TEST(VelocityClipping, DriftsIntoAPlaneWhereThePositionMoverDoesNot) {
  std::array<double, 3> by_velocity_m{};  // After 10^3, 10^4 and 10^5 ticks.
  std::array<double, 3> by_position_m{};
  for (int i = 1; i < 20; ++i) {
    const float a = 0.07f * static_cast<float>(i);
    std::vector<CollisionPlane<2>> planes = {{.normal = {{-std::sin(a), std::cos(a)}}}};
    const Vec<2> along = {{std::cos(a), std::sin(a)}};
    Vec<2> by_velocity = Vec<2>::zero();
    Vec<2> by_position = Vec<2>::zero();
    std::size_t decade = 0;
    for (int tick = 1; tick <= 100000; ++tick) {
      // To and fro, so that positions stay below 1 m.
      const float run = tick / 6 % 2 == 0 ? 10.0f : -10.0f;
      const Vec<2> velocity = run * along - 30.0f * planes[0].normal;
      const Vec<2> clipped = velocity - dot(velocity, planes[0].normal) * planes[0].normal;
      by_velocity += kMoveTick * clipped;
      by_position = solve_planes<2>(by_position + kMoveTick * velocity, planes).position;
      if (tick != 1000 && tick != 10000 && tick != 100000) continue;
      by_velocity_m[decade] = std::max(by_velocity_m[decade], depth_in_planes(planes, by_velocity));
      by_position_m[decade] = std::max(by_position_m[decade], depth_in_planes(planes, by_position));
      ++decade;
    }
  }
  // Measured: 18 um, 0.18 mm and 1.8 mm; against 18, 9 and 14 nm.
  EXPECT_GT(by_velocity_m[2], 1.0e-3);
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(by_velocity_m[i + 1] / by_velocity_m[i], 10.0, 0.1);
  for (int i = 0; i < 3; ++i) EXPECT_LE(by_position_m[i], 5.0e-8);
}

}  // namespace cycloid::solver
