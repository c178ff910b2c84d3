#include <gtest/gtest.h>

#include <algorithm>

#include "tests/solver/space_fixture.hpp"

namespace cycloid::solver {

/// Boxes that lie still on a floor and balls that drop into a heap beside them, one after the
/// other, so that contacts of sleepers lie among those of movers. More pairs than a few chunks
/// hold.
static World<2> floor_and_heap() {
  constexpr int kOfEach = 700;
  constexpr int kColumns = 25;
  WorldDef<2> def;
  def.gravity = {{0.0f, -10.0f}};
  def.tuning.sleep_s = 0.2f;
  World<2> world = make_world(def);
  add_ground<2>(world, {{0.0f, 1.0f}});
  for (int i = 0; i < kOfEach; ++i) {
    add_at(world, Vec<2>{{20.0f + static_cast<float>(i), 0.25f}}, box(0.25f, 0.25f));
    const float x = 0.61f * static_cast<float>(i % kColumns) + 0.05f * static_cast<float>(i % 7);
    add_at(world, Vec<2>{{x - 16.0f, 0.5f + 0.65f * static_cast<float>(i / kColumns)}},
           ball<2>(0.3f));
  }
  return world;
}

// Several threads list pairs and contacts by chunks that are joined. One of the two worlds is also
// restored in the middle, and both go on until much of it has fallen asleep.
TEST(ChunksOfPairs, GiveWhatOneThreadListsAtOnce) {
  World<2> alone = floor_and_heap();
  World<2> shared = floor_and_heap();
  ASSERT_TRUE(shared.set_workers(3).ok());
  std::uint32_t asleep_most = 0;
  std::uint32_t pairs_most = 0;
  for (int tick = 0; tick < 90; ++tick) {
    if (tick == 45) shared.restore(WorldState<2>(shared.state()));
    ASSERT_TRUE(alone.step().ok());
    ASSERT_TRUE(shared.step().ok());
    ASSERT_EQ(alone.digest(), shared.digest()) << "tick " << tick;
    ASSERT_EQ(alone.statistics().pairs, shared.statistics().pairs) << "tick " << tick;
    ASSERT_TRUE(std::ranges::equal(alone.contact_events(), shared.contact_events())) << tick;
    asleep_most = std::max(asleep_most, shared.statistics().asleep);
    pairs_most = std::max(pairs_most, shared.statistics().pairs);
  }
  EXPECT_GT(asleep_most, 600u) << "or no contact was kept as it is";
  EXPECT_GT(pairs_most, 4u * 512u) << "or there were no chunks";
}

/// Towers of two boxes on a broad one. None of them sleeps.
template <int D>
static World<D> towers(const ShapeDef<D>& cube, const ShapeDef<D>& floor) {
  WorldDef<D> def = with_gravity<D>();
  def.tuning.sleep_s = 0.0f;
  World<D> world = make_world(def);
  BodyDef<D> ground;
  ground.kind = BodyKind::kStatic;
  add(world, ground, floor);
  for (int i = 0; i < 2000; ++i) {
    Vec<D> position = Vec<D>::zero();
    position[0] = 0.6f * static_cast<float>(i / 2 - 500);
    position[1] = i % 2 == 0 ? 1.24f : 1.74f;
    add_at(world, position, cube);
  }
  return world;
}

/// Takes a box out of the middle in one tick, and hits every third in another.
template <int D>
static void disturb(int tick, World<D>& world) {
  const std::vector<BodyView<D>> bodies = world.bodies();
  Vec<D> aside = Vec<D>::zero();
  aside[0] = 3.0f;
  for (std::size_t i = 1; i < 1900; i += 3) {
    if (tick != 16) continue;
    EXPECT_TRUE(world.set_velocity(bodies[i].id, aside, Spin<D>::zero()).ok());
  }
  if (tick == 8) {
    EXPECT_TRUE(world.destroy_body(bodies[1001].id).ok());
  }
}

/// By three threads as by one.
template <int D>
static void expect_one_list(const ShapeDef<D>& cube, const ShapeDef<D>& floor) {
  World<D> alone = towers(cube, floor);
  World<D> shared = towers(cube, floor);
  ASSERT_TRUE(shared.set_workers(3).ok());
  for (int tick = 0; tick < 24; ++tick) {
    for (World<D>* world : {&alone, &shared}) {
      disturb(tick, *world);
      ASSERT_TRUE(world->step().ok());
    }
    ASSERT_EQ(alone.digest(), shared.digest()) << "tick " << tick;
    ASSERT_TRUE(std::ranges::equal(alone.contact_events(), shared.contact_events())) << tick;
    EXPECT_GT(shared.statistics().contacts, 3u * 512u);
  }
}

TEST(ChunksOfPairs, KeepTheirPlacesAtRestAndMakeRoomWhenTheyChange) {
  expect_one_list<2>(box(0.25f, 0.25f), box(400.0f, 1.0f));
}
TEST(ChunksOfPairs, KeepTheirPlacesInSpaceToo) {
  expect_one_list<3>(box_def({{0.25f, 0.25f, 0.25f}}), box_def({{400.0f, 1.0f, 2.0f}}));
}

// A floor along an axis has a box; what stands high above it makes no pair with it. A floor that is
// turned by little has none, and everything makes a pair.
TEST(HalfSpacePairs, AreOfWhatIsNearAFloorAlongAnAxis) {
  const auto pairs_above = [](const Vec<2>& normal) {
    World<2> world = make_world(WorldDef<2>{});
    add_ground<2>(world, normal);
    for (int i = 0; i < 10; ++i)
      add_at(world, Vec<2>{{0.0f, 0.4f + 5.0f * static_cast<float>(i)}}, box(0.5f, 0.5f));
    EXPECT_TRUE(world.step().ok());
    return world.statistics().pairs;
  };
  EXPECT_EQ(pairs_above({{0.0f, 1.0f}}), 1u);
  EXPECT_EQ(pairs_above({{0.0f, -1.0f}}), 10u) << "all of them lie deep in it";
  EXPECT_EQ(pairs_above({{0.6f, 0.8f}}), 10u);
}

}  // namespace cycloid::solver
