#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

static bool sleeps(const World<2>& world, BodyId id) {
  return world.state().bodies[id.index].asleep != 0;
}

// Words of a body, so that nothing that changes while it sleeps can hide.
static std::vector<std::byte> memory_of(const Body<2>& body) {
  std::vector<std::byte> bytes(sizeof body);
  std::memcpy(bytes.data(), &body, sizeof body);
  return bytes;
}

TEST(Sleep, AStackFallsAsleepAndThenNothingOfItChangesAndNothingIsSolved) {
  World<2> world = make_world(with_gravity<2>());
  add_ground<2>(world, up<2>());
  const std::vector<BodyId> boxes = add_stack(world, 10);
  step(world, 600);
  EXPECT_EQ(world.statistics().asleep, 10u);
  EXPECT_EQ(world.statistics().rows, 0u);
  const WorldState<2> before = world.state();
  step(world, 3000);
  for (const BodyId id : boxes)
    EXPECT_EQ(memory_of(world.state().bodies[id.index]), memory_of(before.bodies[id.index]));
  ASSERT_EQ(world.state().contacts.size(), before.contacts.size());
  EXPECT_TRUE(world.contact_events().empty());
  // Ten contacts, each with the sag of a soft row under its load.
  EXPECT_NEAR(view(world, boxes.back()).position[1], 9.5f, 0.04f);
}

TEST(Sleep, NeverWhereTheTuningSaysSo) {
  WorldDef<2> def = with_gravity<2>();
  def.tuning.sleep_s = 0.0f;
  World<2> world = make_world(def);
  add_ground<2>(world, up<2>());
  add_stack(world, 3);
  step(world, 600);
  EXPECT_EQ(world.statistics().asleep, 0u);
  EXPECT_GT(world.statistics().rows, 0u);
}

TEST(Sleep, ABallThatFallsOnTheTopWakesTheWholeIslandAndNoOther) {
  World<2> world = make_world(with_gravity<2>());
  add_ground<2>(world, up<2>());
  const std::vector<BodyId> hit = add_stack(world, 3);
  const std::vector<BodyId> spared = add_stack(world, 3, 5.0f);
  step(world, 300);
  ASSERT_EQ(world.statistics().asleep, 6u);
  const BodyId ball_id = add_at<2>(world, {{0.2f, 5.0f}}, ball<2>(0.3f));
  float fastest = 0.0f;
  for (int tick = 0; tick < 60; ++tick) {
    step(world, 1);
    if (!sleeps(world, hit[0])) fastest = std::max(fastest, length(view(world, hit[2]).velocity));
  }
  EXPECT_GT(fastest, 0.01f);
  EXPECT_FALSE(sleeps(world, hit[0]));
  for (const BodyId id : spared) EXPECT_TRUE(sleeps(world, id));
  // The blow takes momentum from the ball from the first tick on: it does not bounce off a rock.
  EXPECT_GT(view(world, ball_id).position[1], 3.2f);
}

// A ball rolls from stack to stack, so that islands fall asleep and wake while others sleep on.
TEST(Sleep, TheStatisticsCountWhoSleepsInEveryTick) {
  World<2> world = make_world(with_gravity<2>());
  add_ground<2>(world, up<2>());
  for (int i = 0; i < 4; ++i) add_stack(world, 3, 4.0f * static_cast<float>(i));
  const BodyId ball_id = add_at<2>(world, {{-6.0f, 1.5f}}, ball<2>(1.5f));
  std::set<std::uint32_t> counts;
  for (int tick = 0; tick < 900; ++tick) {
    if (tick == 200) {
      ASSERT_TRUE(world.set_velocity(ball_id, {{6.0f, 0.0f}}, {{-4.0f}}).ok());
    }
    step(world, 1);
    std::uint32_t asleep = 0;
    for (const Body<2>& body : world.state().bodies) asleep += body.asleep;
    ASSERT_EQ(world.statistics().asleep, asleep) << "tick " << tick;
    counts.insert(asleep);
  }
  EXPECT_GT(counts.size(), 3u);
}

TEST(Sleep, EveryCallThatCouldMatterWakes) {
  const auto expect_awake = [](const char* what, auto&& act) {
    World<2> world = make_world(with_gravity<2>());
    const BodyId floor = add_ground<2>(world, up<2>());
    const std::vector<BodyId> boxes = add_stack(world, 2);
    step(world, 300);
    ASSERT_TRUE(sleeps(world, boxes[1])) << what;
    act(world, boxes, floor);
    step(world, 1);
    EXPECT_FALSE(sleeps(world, boxes[1])) << what;
  };
  expect_awake("force", [](auto& world, auto& boxes, BodyId) {
    EXPECT_TRUE(world.apply_force(boxes[0], {{1.0f, 0.0f}}).ok());
  });
  expect_awake("impulse", [](auto& world, auto& boxes, BodyId) {
    EXPECT_TRUE(world.apply_impulse(boxes[0], {{0.1f, 0.0f}}).ok());
  });
  expect_awake("velocity", [](auto& world, auto& boxes, BodyId) {
    EXPECT_TRUE(world.set_velocity(boxes[0], {{0.1f, 0.0f}}, {{0.0f}}).ok());
  });
  expect_awake("pose", [](auto& world, auto& boxes, BodyId) {
    EXPECT_TRUE(world.set_pose(boxes[0], {{3.0f, 0.5f}}, turned(0.0f)).ok());
  });
  expect_awake("gravity", [](auto& world, auto&, BodyId) {
    EXPECT_TRUE(world.set_gravity({{1.0f, -10.0f}}).ok());
  });
  expect_awake("material", [](auto& world, auto&, BodyId) {
    EXPECT_TRUE(world.set_material(0, {0.0f, 0.0f, 0.0f}).ok());
  });
  expect_awake("damping", [](auto& world, auto& boxes, BodyId) {
    EXPECT_TRUE(world.set_damping(boxes[0], 0.0f, 0.0f).ok());
  });
  expect_awake("floor", [](auto& world, auto&, BodyId floor) {
    EXPECT_TRUE(world.destroy_body(floor).ok());
  });
  expect_awake("joint", [](auto& world, auto& boxes, BodyId floor) {
    JointDef<2> def;
    def.body_a = floor;
    def.body_b = boxes[0];
    def.anchor_a = {{0.0f, 0.5f}};
    EXPECT_TRUE(world.create_joint(def).ok());
  });
}

TEST(Sleep, ABoxWhoseSupportIsTakenFalls) {
  World<2> world = make_world(with_gravity<2>());
  add_ground<2>(world, up<2>());
  const std::vector<BodyId> boxes = add_stack(world, 3);
  step(world, 300);
  ASSERT_TRUE(sleeps(world, boxes[2]));
  ASSERT_TRUE(world.destroy_body(boxes[0]).ok());
  step(world, 120);
  EXPECT_NEAR(view(world, boxes[2]).position[1], 1.5f, 0.02f);
}

TEST(Sleep, WhatAMotorTurnsAndWhatAPlatformCarriesStayAwake) {
  World<2> world = make_world(with_gravity<2>());
  const BodyId floor = add_ground<2>(world, up<2>());
  const BodyId wheel = add_at<2>(world, {{0.0f, 3.0f}}, ball<2>(0.5f));
  JointDef<2> axle;
  axle.body_a = floor;
  axle.body_b = wheel;
  axle.anchor_a = {{0.0f, 3.0f}};
  axle.motor = MotorKind::kSpeed;
  axle.motor_speed = 0.01f;
  axle.motor_max = 100.0f;
  ASSERT_TRUE(world.create_joint(axle).ok());
  BodyDef<2> platform;
  platform.kind = BodyKind::kKinematic;
  platform.position = {{10.0f, 1.0f}};
  platform.velocity = {{0.01f, 0.0f}};
  add(world, platform, box(1.0f, 0.1f));
  const BodyId rider = add_at<2>(world, {{10.0f, 1.6f}}, box(0.5f, 0.5f));
  step(world, 600);
  EXPECT_FALSE(sleeps(world, wheel));
  EXPECT_NEAR(view(world, wheel).spin[0], 0.01f, 1.0e-4f);
  EXPECT_FALSE(sleeps(world, rider));
  EXPECT_NEAR(view(world, rider).velocity[0], 0.01f, 1.0e-3f);
}

TEST(Sleep, ARestoredSleeperWakesToTheSameBits) {
  World<2> world = make_world(with_gravity<2>());
  add_ground<2>(world, up<2>());
  add_stack(world, 5);
  step(world, 400);
  ASSERT_EQ(world.statistics().asleep, 5u);
  std::vector<std::byte> bytes;
  world.encode(bytes);
  World<2> other = make_world<2>();
  ASSERT_TRUE(other.decode(bytes).ok());
  for (World<2>* each : {&world, &other}) add_at<2>(*each, {{0.3f, 6.0f}}, ball<2>(0.4f));
  for (int tick = 0; tick < 200; ++tick) {
    step(world, 1);
    step(other, 1);
    ASSERT_EQ(world.digest(), other.digest()) << tick;
  }
}

/// What one tick has left of an island.
struct IslandSeen {
  int bodies = 0;
  int asleep = 0;
  int rested = 0;  ///< For long enough to fall asleep.
  bool is_kept = false;
};

/// Islands by the lowest slot, by contacts and joints of the state alone.
static std::map<std::uint32_t, IslandSeen> islands_of(const WorldState<2>& state) {
  std::vector<std::uint32_t> root(state.bodies.size());
  std::iota(root.begin(), root.end(), 0u);
  std::vector<std::uint8_t> is_kept(root.size(), 0);
  const auto moves = [&](std::uint32_t i) { return state.bodies[i].inverse_mass > 0.0f; };
  const auto link = [&](std::uint32_t a, std::uint32_t b, bool drives) {
    for (const auto& [one, other] : {std::pair{a, b}, std::pair{b, a}}) {
      const bool pushes = !moves(other) && state.bodies[other].velocity[0] != 0.0f;
      if (moves(one) && (drives || pushes)) is_kept[one] = 1;
    }
    if (!moves(a) || !moves(b)) return;
    const auto [least, most] = std::minmax(root[a], root[b]);
    for (std::uint32_t& of : root)
      if (of == most) of = least;
  };
  for (const Contact<2>& contact : state.contacts)
    link(state.shapes[contact.shape_a].body, state.shapes[contact.shape_b].body, false);
  for (const Joint<2>& joint : state.joints)
    if (joint.kind != JointKind::kFree) link(joint.body_a, joint.body_b, joint.motor_speed != 0.0f);
  const auto& header = state.header;
  std::map<std::uint32_t, IslandSeen> islands;
  for (std::uint32_t i = 0; i < root.size(); ++i) {
    const Body<2>& body = state.bodies[i];
    if (!moves(i)) continue;
    IslandSeen& island = islands[root[i]];
    ++island.bodies;
    island.asleep += body.asleep != 0 ? 1 : 0;
    const bool rested =
        static_cast<float>(body.rest_ticks) >= header.tuning.sleep_s / header.tick_s;
    island.rested += rested ? 1 : 0;
    island.is_kept = island.is_kept || is_kept[i] != 0;
  }
  return islands;
}

// Stacks of which some are poked, one stands on a platform that creeps, and one leans on a wheel
// that a motor turns: parts of those rest for long beside others that do not.
TEST(Sleep, IslandsFallAsleepAsWholesAndAsSoonAsTheyMay) {
  constexpr int kStacks = 8;
  World<2> world = make_world(with_gravity<2>());
  const BodyId ground = add_ground<2>(world, up<2>());
  std::vector<std::vector<BodyId>> stacks;
  for (int i = 0; i < kStacks; ++i)
    stacks.push_back(add_stack(world, 5, 1.02f * static_cast<float>(i) + (i < 4 ? 0.0f : 20.0f)));
  BodyDef<2> platform;
  platform.kind = BodyKind::kKinematic;
  platform.position = {{-20.0f, 1.0f}};
  platform.velocity = {{0.01f, 0.0f}};
  add(world, platform, box(3.0f, 0.1f));
  for (int i = 0; i < 3; ++i)
    add_at<2>(world, {{-20.0f, 1.6f + static_cast<float>(i)}}, box(0.5f, 0.5f));
  JointDef<2> axle;
  axle.body_a = ground;
  axle.body_b = add_at<2>(world, {{-40.0f, 0.5f}}, ball<2>(0.5f));
  axle.anchor_a = {{-40.0f, 0.5f}};
  axle.motor = MotorKind::kSpeed;
  axle.motor_speed = 0.001f;
  axle.motor_max = 1.0f;
  ASSERT_TRUE(world.create_joint(axle).ok());
  add_at<2>(world, {{-40.0f, 1.5f}}, box(0.5f, 0.5f));
  int mixed = 0;
  int fell_asleep = 0;
  for (int tick = 0; tick < 900; ++tick) {
    if (tick % 20 == 0) {
      const BodyId poked = stacks[static_cast<std::size_t>(tick / 20 * 3 % kStacks)].back();
      ASSERT_TRUE(world.apply_impulse(poked, {{tick < 450 ? 0.3f : 0.0f, 0.0f}}).ok());
    }
    step(world, 1);
    for (const auto& [slot, island] : islands_of(world.state())) {
      const bool all_rest = island.rested == island.bodies && !island.is_kept;
      ASSERT_EQ(island.asleep, all_rest ? island.bodies : 0) << "tick " << tick << " of " << slot;
      if (island.rested > 0 && island.rested < island.bodies) ++mixed;
      if (all_rest) ++fell_asleep;
    }
  }
  EXPECT_GT(mixed, 100);
  EXPECT_GT(fell_asleep, 100);
}

/// Stacks in a row that have fallen asleep, and balls that roll and hop between some of them.
static World<2> field_of_stacks(int stacks, int balls) {
  World<2> world = make_world(with_gravity<2>());
  add_ground<2>(world, up<2>());
  for (int i = 0; i < stacks; ++i) add_stack(world, 4, 4.0f * static_cast<float>(i));
  step(world, 300);
  EXPECT_EQ(world.statistics().asleep, 4u * static_cast<std::uint32_t>(stacks));
  for (int i = 0; i < balls; ++i)
    add_at<2>(world, {{4.0f * static_cast<float>(i) + 2.0f, 1.0f}}, ball<2>(0.4f));
  return world;
}

// One world goes on with what it has kept about who sleeps; the other is restored before each tick,
// so it looks at all. Contacts come and end in nearly every tick, stacks fall, sleep and wake, and
// calls come between.
TEST(Sleep, WhatIsKeptAboutManySleepersShowsNowhere) {
  constexpr int kStacks = 150;
  constexpr int kBalls = 20;
  World<2> keeps = field_of_stacks(kStacks, kBalls);
  World<2> forgets = field_of_stacks(kStacks, kBalls);
  ASSERT_TRUE(keeps.set_workers(2).ok());
  const auto first_ball = static_cast<std::uint32_t>(1 + 4 * kStacks);
  std::set<std::uint32_t> counts;
  std::size_t events = 0;
  for (std::uint32_t tick = 0; tick < 600; ++tick) {
    const WorldState<2> saved = forgets.state();
    forgets.restore(saved);
    for (World<2>* world : {&keeps, &forgets}) {
      const BodyId pushed{first_ball + tick / 8 % kBalls, 0};
      const float push = tick % 16 < 8 ? 1.5f : -1.0f;
      if (tick % 8 == 0) {
        ASSERT_TRUE(world->apply_impulse(pushed, {{push, 1.0f}}).ok());
      }
      const BodyId poked{1 + tick * 7 % (4 * kStacks), 0};
      if (tick % 50 == 49) {
        ASSERT_TRUE(
            world->destroy_body({poked.index, world->state().bodies[poked.index].generation}).ok());
        add_at<2>(*world, {{4.0f * static_cast<float>(tick % kStacks), 6.0f}}, box(0.3f, 0.3f));
      }
    }
    step(keeps, 1);
    step(forgets, 1);
    ASSERT_EQ(keeps.digest(), forgets.digest()) << "tick " << tick;
    ASSERT_EQ(keeps.statistics().asleep, forgets.statistics().asleep) << "tick " << tick;
    ASSERT_EQ(keeps.statistics().pairs, forgets.statistics().pairs) << "tick " << tick;
    const auto kept = keeps.contact_events();
    const auto found = forgets.contact_events();
    ASSERT_TRUE(std::equal(kept.begin(), kept.end(), found.begin(), found.end()))
        << "tick " << tick;
    counts.insert(keeps.statistics().asleep);
    events += kept.size();
  }
  EXPECT_GT(counts.size(), 20u);
  EXPECT_GT(*counts.begin(), 400u);
  EXPECT_GT(events, 250u);
}

// What is kept about which contacts rest goes with a body: one world goes on with it, the other has
// forgotten all. The contacts of the one that goes lie among those of sleepers.
TEST(Sleep, ABodyThatGoesLeavesTheOthersTheirContacts) {
  const auto digest_after = [](bool forgets) {
    World<2> world = make_world(with_gravity<2>());
    add_ground<2>(world, up<2>());
    const std::vector<BodyId> woken = add_stack(world, 4);
    add_stack(world, 4, 5.0f);
    step(world, 300);
    EXPECT_TRUE(world.apply_impulse(woken[3], {{0.1f, 0.0f}}).ok());
    step(world, 2);
    EXPECT_TRUE(world.destroy_body(woken[1]).ok());
    const WorldState<2> saved = world.state();
    if (forgets) world.restore(saved);
    step(world, 1);
    EXPECT_EQ(world.statistics().asleep, 4u);
    return world.digest();
  };
  EXPECT_EQ(digest_after(false), digest_after(true));
}

// Boxes that overlap under a load rock on one another by less than a thousandth; whatever that
// turns over must not cost their contacts what they know of the load.
TEST(Rest, APyramidThatIsNotLetSleepStandsStill) {
  WorldDef<2> def = with_gravity<2>({0.6f, 0.0f, 0.0f});
  def.tuning = Tuning::soft_step();
  def.tuning.sleep_s = 0.0f;
  World<2> world = make_world(def);
  add_ground<2>(world, up<2>());
  constexpr int kBase = 30;
  for (int row = 0; row < kBase; ++row)
    for (int i = 0; i < kBase - row; ++i)
      add_at<2>(world,
                {{static_cast<float>(i) + 0.5f * static_cast<float>(row),
                  0.5f + static_cast<float>(row)}},
                box(0.5f, 0.5f));
  step(world, 600);
  float fastest = 0.0f;
  for (const Body<2>& body : world.state().bodies) fastest = max(fastest, length(body.velocity));
  EXPECT_LT(fastest, 1.0e-3f);
}

}  // namespace cycloid::solver
