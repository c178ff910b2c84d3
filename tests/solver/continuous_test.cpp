#include <gtest/gtest.h>

#include "solver/motion.hpp"
#include "tests/solver/space_fixture.hpp"
#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

static WorldDef<2> restless() {
  WorldDef<2> def;
  def.tuning.sleep_s = 0.0f;
  return def;
}

static BodyId add_wall(World<2>& world, float x) {
  BodyDef<2> def;
  def.kind = BodyKind::kStatic;
  def.position = {{x, 0.0f}};
  return add(world, def, box(0.01f, 50.0f));
}

// Row 22 of the scenes where methods fail: a ball of 0.05 m against a wall of 0.02 m.
TEST(Continuous, NoBallPassesAThinWallAtAnySpeedAngleOrPhase) {
  for (const float speed : {1.0f, 10.0f, 200.0f, 1000.0f, 5000.0f})
    for (const float angle : {0.0f, 0.7f, 1.4f})
      for (int phase = 0; phase < 8; ++phase) {
        World<2> world = make_world(restless());
        add_wall(world, 3.0f);
        BodyDef<2> def;
        def.position = {{0.05f * static_cast<float>(phase), 0.0f}};
        def.velocity = {{speed * std::cos(angle), speed * std::sin(angle) * 0.01f}};
        const BodyId id = add(world, def, ball<2>(0.05f));
        const int ticks = static_cast<int>(60.0f * 4.0f / def.velocity[0]) + 30;
        for (int tick = 0; tick < ticks; ++tick) {
          step(world, 1);
          ASSERT_LT(view(world, id).position[0], 3.0f) << speed << ' ' << angle << ' ' << phase;
        }
      }
}

// More than threads take one by one, each from its own distance at its own speed.
TEST(Continuous, ManyBallsAreStoppedTheSameByAnyNumberOfThreads) {
  std::vector<std::uint64_t> digests;
  for (const int workers : {1, 2, 3}) {
    World<2> world = make_world(restless());
    ASSERT_TRUE(world.set_workers(workers).ok());
    add_wall(world, 3.0f);
    std::vector<BodyId> balls;
    for (int i = 0; i < 700; ++i) {
      BodyDef<2> def;
      def.position = {{-0.01f * static_cast<float>(i % 97), 0.13f * static_cast<float>(i - 350)}};
      def.velocity = {{50.0f + static_cast<float>(i), 0.0f}};
      balls.push_back(add(world, def, ball<2>(0.05f)));
    }
    for (int tick = 0; tick < 10; ++tick) {
      step(world, 1);
      for (const BodyId ball : balls) ASSERT_LT(view(world, ball).position[0], 3.0f);
    }
    digests.push_back(world.digest());
  }
  EXPECT_EQ(digests[1], digests[0]);
  EXPECT_EQ(digests[2], digests[0]);
}

TEST(Continuous, ABulletHitsAWallThatAnotherBodyHides) {
  World<2> world = make_world(restless());
  add_wall(world, 3.0f);
  const BodyId light = add_at<2>(world, {{1.5f, 0.0f}}, ball<2>(0.1f));
  BodyDef<2> def;
  def.velocity = {{800.0f, 0.0f}};
  const BodyId bullet = add(world, def, ball<2>(0.05f));
  step(world, 60);
  EXPECT_LT(view(world, bullet).position[0], 3.0f);
  EXPECT_LT(view(world, light).position[0], 3.0f);
}

// Row 23: a rod of 2 m x 0.02 m at 50 rad/s against a small peg. Without the sweep it turns past.
TEST(Continuous, ASpinningRodDoesNotPassThePeg) {
  const auto passes = [](std::uint32_t continuous, float spin) {
    WorldDef<2> def = restless();
    def.tuning.continuous = continuous;
    World<2> world = make_world(def);
    BodyDef<2> peg;
    peg.kind = BodyKind::kStatic;
    peg.position = {{0.0f, 0.8f}};
    add(world, peg, ball<2>(0.02f));
    BodyDef<2> rod;
    rod.spin = {{spin}};
    const BodyId id = add(world, rod, box(1.0f, 0.01f));
    JointDef<2> axle;
    axle.body_a = add_wall(world, -30.0f);
    axle.anchor_a = {{30.0f, 0.0f}};
    axle.body_b = id;
    EXPECT_TRUE(world.create_joint(axle).ok());
    float turned_by = 0.0f;
    Rotation<2> before = view(world, id).rotation;
    for (int tick = 0; tick < 60; ++tick) {
      step(world, 1);
      const Rotation<2> now = view(world, id).rotation;
      turned_by += std::atan2(now[1] * before[0] - now[0] * before[1],
                              now[0] * before[0] + now[1] * before[1]);
      before = now;
      if (turned_by > 1.7f) return true;
    }
    return false;
  };
  EXPECT_FALSE(passes(1, 50.0f));
  EXPECT_FALSE(passes(1, 37.0f));
  EXPECT_TRUE(passes(0, 50.0f));
}

// Half a slop is more than a card is thick: stopped there it would hang in the air.
TEST(Continuous, ACardStopsNoFartherAwayThanAQuarterOfItsThickness) {
  World<2> world = make_world(restless());
  add_wall(world, 3.0f);
  BodyDef<2> def;
  def.velocity = {{100.0f, 0.0f}};
  const BodyId card = add(world, def, box(0.001f, 0.1f));
  step(world, 2);  // 1.67 m in the first; in the second the wall is in its way.
  const float gap = 2.99f - (view(world, card).position[0] + 0.001f);
  EXPECT_GT(gap, 0.0f);
  EXPECT_LT(gap, 0.00065f);
}

TEST(Continuous, ItDoesNotHoldWhatSlidesOrRolls) {
  WorldDef<2> def = restless();
  def.gravity = {{0.0f, -10.0f}};
  def.materials = {{0.0f, 0.0f, 0.0f}};
  World<2> world = make_world(def);
  add_ground<2>(world, up<2>());
  BodyDef<2> slider;
  slider.position = {{0.0f, 0.05f}};
  slider.velocity = {{300.0f, 0.0f}};
  const BodyId id = add(world, slider, box(0.05f, 0.05f));
  step(world, 60);
  EXPECT_NEAR(view(world, id).position[0], 300.0f, 0.5f);
}

/// A smooth bar of 6 m about the origin that a hand turns.
static World<2> bar_that_turns(std::uint32_t continuous, float spin) {
  WorldDef<2> def = restless();
  def.tuning.continuous = continuous;
  def.materials = {{0.0f, 0.0f, 0.0f}};
  World<2> world = make_world(def);
  BodyDef<2> bar;
  bar.kind = BodyKind::kKinematic;
  bar.spin = {{spin}};
  add(world, bar, box(3.0f, 0.1f));
  return world;
}

// A bar swings a ball round, which slides outwards on it: what the contact solver has made of the
// two is the way that they go.
TEST(Continuous, ItDoesNotHoldWhatTouchesAndTurns) {
  const auto end = [](std::uint32_t continuous, float out) {
    World<2> world = bar_that_turns(continuous, 0.25f);
    BodyDef<2> slider;
    slider.position = {{1.0f, 0.3005f}};
    slider.velocity = {{out, 0.26f}};
    const BodyId id = add(world, slider, ball<2>(0.2f));
    step(world, 1);
    return view(world, id).position;
  };
  for (const float out : {6.5f, 8.0f, 10.0f}) {
    EXPECT_EQ(end(1, out)[0], end(0, out)[0]) << out;
    EXPECT_EQ(end(1, out)[1], end(0, out)[1]) << out;
  }
}

/// A box that overlaps a bar which turns, and moves along it.
struct Rider {
  float bar_spin, overlap, x, tilt, spin;
  Vec<2> velocity;
};

static Vec<2> end_of_ride(const Rider& rider, std::uint32_t continuous) {
  World<2> world = bar_that_turns(continuous, rider.bar_spin);
  BodyDef<2> moving;
  moving.position = {{rider.x, 0.3f - rider.overlap}};
  moving.rotation = rotation_by(Spin<2>{{rider.tilt}});
  moving.spin = {{rider.spin}};
  moving.velocity = rider.velocity;
  const BodyId id = add(world, moving, box(0.2f, 0.2f));
  step(world, 1);
  return view(world, id).position;
}

// One corner leaves while the other comes: they end no deeper in one another than they began.
TEST(Continuous, ItDoesNotHoldWhatOverlapsAndRocks) {
  for (const Rider& rider :
       {Rider{0.231f, 0.0028f, -0.062f, -0.0056f, 7.488f, {{11.322f, -0.79f}}},
        Rider{0.227f, 0.0028f, 0.708f, 0.0087f, -5.008f, {{9.69f, -0.186f}}},
        Rider{-0.449f, 0.0012f, -0.808f, 0.0019f, -7.2f, {{-13.294f, -0.186f}}},
        Rider{0.474f, 0.0023f, 0.614f, -0.0009f, 1.952f, {{8.092f, -0.096f}}}}) {
    const Vec<2> held = end_of_ride(rider, 1);
    const Vec<2> free = end_of_ride(rider, 0);
    EXPECT_EQ(held[0], free[0]) << rider.x;
    EXPECT_EQ(held[1], free[1]) << rider.x;
  }
}

/// Where a column of boxes that lie close together is after a tick in which all fly on together.
static std::vector<Vec<2>> column_after_a_tick(std::uint32_t continuous, float spin) {
  WorldDef<2> def = restless();
  def.tuning.continuous = continuous;
  World<2> world = make_world(def);
  std::vector<BodyId> ids;
  for (int i = 0; i < 12; ++i) {
    BodyDef<2> flier;
    flier.position = {{0.42f * static_cast<float>(i), 3.0f}};
    flier.velocity = {{30.0f - spin * flier.position[1], spin * flier.position[0]}};
    flier.spin = {{spin}};
    ids.push_back(add(world, flier, box(0.2f, 0.2f)));
  }
  step(world, 1);
  std::vector<Vec<2>> ends;
  for (const BodyId id : ids) ends.push_back(view(world, id).position);
  return ends;
}

// Neighbours in a crowd do not pass through one another, however fast it is and however it turns:
// none is stopped at the next one.
TEST(Continuous, WhatFliesSideBySideKeepsItsWay) {
  for (const float spin : {0.0f, 4.0f}) {
    const std::vector<Vec<2>> stopped = column_after_a_tick(1, spin);
    const std::vector<Vec<2>> free = column_after_a_tick(0, spin);
    for (std::size_t i = 0; i < free.size(); ++i) {
      EXPECT_EQ(stopped[i][0], free[i][0]) << spin << ' ' << i;
      EXPECT_EQ(stopped[i][1], free[i][1]) << spin << ' ' << i;
    }
  }
}

TEST(Continuous, TwoThatFlyAtEachOtherMeetAtAnySpeedAndPhase) {
  for (const float speed : {40.0f, 300.0f, 3000.0f})
    for (int phase = 0; phase < 8; ++phase) {
      World<2> world = make_world(restless());
      BodyDef<2> def;
      def.velocity = {{speed, 0.0f}};
      const BodyId left = add(world, def, ball<2>(0.05f));
      def.position = {{6.0f + 0.1f * static_cast<float>(phase), 0.0f}};
      def.velocity = {{-0.7f * speed, 0.0f}};
      const BodyId right = add(world, def, box(0.03f, 0.5f));
      for (int tick = 0; tick < 20; ++tick) {
        step(world, 1);
        ASSERT_LT(view(world, left).position[0], view(world, right).position[0])
            << speed << ' ' << phase;
      }
    }
}

/// How deep a heavy box comes to lie over any of a block of small ones that it flies into, m.
static float deepest_overrun(std::uint32_t continuous) {
  WorldDef<2> def = restless();
  def.tuning.continuous = continuous;
  World<2> world = make_world(def);
  BodyDef<2> heavy;
  heavy.position = {{-6.0f, 0.0f}};
  heavy.velocity = {{40.0f, 0.0f}};
  ShapeDef<2> shape = box(4.0f, 4.0f);
  shape.density = 8.0f;
  const BodyId driver = add(world, heavy, shape);
  std::vector<BodyId> crowd;
  for (int i = 0; i < 24 * 16; ++i) {
    const Vec<2> at = {{static_cast<float>(i % 24), static_cast<float>(i / 24) - 8.0f}};
    crowd.push_back(add_at<2>(world, 0.4f * at, box(0.2f, 0.2f)));
  }
  float deepest = 0.0f;
  for (int tick = 0; tick < 60; ++tick) {
    step(world, 1);
    for (const BodyId id : crowd) {
      const Vec<2> at = rotate_back(view(world, driver).rotation,
                                    view(world, id).position - view(world, driver).position);
      deepest = max(deepest, 4.0f - max(abs(at[0]), abs(at[1])));
    }
  }
  return deepest;
}

// Stopped at those beside or before them, boxes of a crowd lose their way and are overrun.
TEST(Continuous, ACrowdIsNotOverrunByWhatDrivesIt) {
  EXPECT_LT(deepest_overrun(0), 0.1f);
  EXPECT_LT(deepest_overrun(1), 0.1f);
}

// What pushes does not excuse from stopping at what does not yield.
TEST(Continuous, NothingIsPushedThroughAThinWall) {
  for (const float speed : {30.0f, 120.0f}) {
    World<2> world = make_world(restless());
    add_wall(world, 3.0f);
    BodyDef<2> def;
    def.velocity = {{speed, 0.0f}};
    def.mass = 20.0f;
    add(world, def, box(0.3f, 0.3f));
    def.position = {{0.36f, 0.0f}};
    def.mass = 0.1f;
    const BodyId pushed = add(world, def, ball<2>(0.05f));
    for (int tick = 0; tick < 60; ++tick) {
      step(world, 1);
      ASSERT_LT(view(world, pushed).position[0], 3.0f) << speed << ' ' << tick;
    }
  }
}

// Nothing stops what is kinematic: whatever it reaches in a tick has its contact before it.
template <int D>
static void check_kinematic_wall(const ShapeDef<D>& wall) {
  for (const float speed : {50.0f, 100.0f, 500.0f})
    for (int phase = 0; phase < 20; ++phase) {
      WorldDef<D> world_def;
      world_def.tuning.sleep_s = 0.0f;
      World<D> world = make_world(world_def);
      BodyDef<D> def;
      def.kind = BodyKind::kKinematic;
      def.position[0] = -3.0f - 0.1f * static_cast<float>(phase);
      def.velocity[0] = speed;
      add(world, def, wall);
      const BodyId id = add_at<D>(world, Vec<D>::zero(), ball<D>(0.1f));
      step(world, 60);
      EXPECT_GT(view(world, id).velocity[0], 0.99f * speed) << D << ' ' << speed << ' ' << phase;
    }
}

TEST(Continuous, NoKinematicWallPassesABallAtAnySpeedOrPhase) {
  check_kinematic_wall<2>(box(0.05f, 1.0f));
  check_kinematic_wall<3>(box_def({{0.05f, 1.0f, 1.0f}}));
}

}  // namespace cycloid::solver
