#include "bench/worlds/bench_worlds.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "scenes/catalogue.hpp"
#include "scenes/simulation.hpp"

namespace cycloid::worlds {

static std::size_t movers(const scenes::Scene& scene) {
  return static_cast<std::size_t>(std::count_if(
      scene.bodies.begin(), scene.bodies.end(),
      [](const scenes::SceneBody& body) { return body.kind == solver::BodyKind::kDynamic; }));
}

TEST(BenchWorlds, HaveNamesOfTheirOwnAndAreFoundByThem) {
  std::set<std::string> names;
  for (const BenchWorld& world : bench_worlds()) {
    EXPECT_TRUE(names.insert(world.name).second) << world.name;
    const auto found = find_bench_world(world.name);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->make, world.make);
    EXPECT_EQ(found->size, world.size);
  }
  EXPECT_FALSE(find_bench_world("movers-61"));
  EXPECT_EQ(find_bench_world("half-pipe")->group, Group::kPlane);
  EXPECT_EQ(find_bench_world("top")->group, Group::kSpace);
}

/// Goal: each generator makes a scene that every engine can be given. Method: no mistakes, and a
/// world that steps; the largest of each kind only as data, because building them takes seconds.
TEST(BenchWorlds, AreGoodScenesThatStep) {
  for (const BenchWorld& world : bench_worlds()) {
    if (world.group == Group::kGrowth && world.size > 1000) continue;
    const scenes::Scene scene = make_scene(world);
    EXPECT_EQ(scene.name, world.name);
    auto simulation = scenes::Simulation::create(scene);
    ASSERT_TRUE(simulation.ok()) << world.name << ": " << simulation.error().field;
    const std::vector<scenes::SeatInput> inputs(scene.seats.size());
    for (int tick = 0; tick < 2; ++tick)
      ASSERT_TRUE(simulation.value().step(inputs).ok()) << world.name;
  }
}

/// Goal: a name means one scene. Method: where the catalogue has the name too, all bodies are
/// equal.
TEST(BenchWorlds, OfTheCataloguesNamesAreItsScenes) {
  int shared = 0;
  for (const BenchWorld& world : bench_worlds()) {
    scenes::Loaded loaded = scenes::find(world.name);
    if (!loaded.scene) continue;
    ++shared;
    scenes::Scene scene = make_scene(world);
    loaded.scene->tuning.sleep_s = scene.tuning.sleep_s;
    EXPECT_EQ(scenes::to_binary(scene), scenes::to_binary(*loaded.scene)) << world.name;
  }
  EXPECT_GT(shared, 0);
}

TEST(BenchWorlds, HaveTheBodiesThatTheirNamesSay) {
  EXPECT_EQ(movers(moving_room(60)), 60u);
  EXPECT_EQ(movers(heap(200)), 200u);
  EXPECT_EQ(movers(box_pyramid(100)), 5050u);
  EXPECT_EQ(movers(many_pyramids(20)), 22000u);
  EXPECT_EQ(movers(tumbler(45)), 2025u + 1u);
  EXPECT_EQ(movers(spinner(3000)), 3000u + 1u);
  EXPECT_EQ(movers(ragdoll_rain(200)), 2200u);
  EXPECT_EQ(ragdoll_rain(200).joints.size(), 2000u);
  EXPECT_EQ(movers(smash(120)), 9600u + 1u);
  EXPECT_EQ(movers(compounds(3000)), 3000u);
  EXPECT_EQ(movers(falling_balls(3000)), 3000u);
  EXPECT_EQ(movers(convex_pile(512)), 512u);
  EXPECT_EQ(joint_grid(100).bodies.size(), 10000u);
  EXPECT_EQ(joint_grid(100).joints.size(), 19800u - 6u);
  for (const int bodies : {100, 1000, 50000}) {
    const auto wanted = static_cast<std::size_t>(bodies);
    EXPECT_EQ(movers(moving_room(bodies)), wanted);
    EXPECT_EQ(movers(sleeping_field(bodies)), wanted);
    EXPECT_GE(movers(pyramid_field(bodies)), wanted);
    EXPECT_LT(movers(pyramid_field(bodies)), wanted + 55);
  }
}

TEST(BenchWorlds, AreFunctionsOfTheirSize) {
  EXPECT_EQ(scenes::to_binary(moving_room(20)), scenes::to_binary(moving_room(20)));
  EXPECT_NE(scenes::to_binary(moving_room(20)), scenes::to_binary(moving_room(21)));
}

/// Goal: the field of sleepers measures sleepers. Method: all but the pyramid on its moving floor
/// sleep when the clock starts.
TEST(BenchWorlds, SleepersSleepBeforeTheClockStarts) {
  const BenchWorld world = *find_bench_world("grow-sleepers-500");
  auto simulation = scenes::Simulation::create(make_scene(world));
  ASSERT_TRUE(simulation.ok());
  for (int tick = 0; tick < world.warm_ticks; ++tick) ASSERT_TRUE(simulation.value().step({}).ok());
  EXPECT_EQ(simulation.value().statistics().asleep, 500u - 55u);
}

/// Goal: nothing starts as a heap of overlaps, which no two engines take apart alike.
TEST(BenchWorlds, OfThePlaneHoldTogether) {
  for (const char* name : {"tumbler", "ragdoll-rain", "compounds", "ball-pit", "spinner"}) {
    auto simulation = scenes::Simulation::create(make_scene(*find_bench_world(name)));
    ASSERT_TRUE(simulation.ok());
    for (int tick = 0; tick < 60; ++tick) ASSERT_TRUE(simulation.value().step({}).ok()) << name;
    for (const scenes::Pose& pose : simulation.value().poses()) {
      EXPECT_LT(std::abs(pose.position[0]), 100.0f) << name << " body " << pose.index;
      EXPECT_GT(pose.position[1], -12.0f) << name << " body " << pose.index;
    }
  }
}

}  // namespace cycloid::worlds
