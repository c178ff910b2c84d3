#include <gtest/gtest.h>

#include "tests/hostile/allocations.hpp"
#include "tests/hostile/matches.hpp"
#include "tests/hostile/worlds.hpp"

namespace cycloid::hostile {
namespace {

/// 20,000 balls in one place: 200 million pairs, which would take gigabytes.
template <int D>
solver::World<D> crowded_world(int workers) {
  solver::World<D> world = sample_world<D>();
  checked(world.set_workers(workers));
  for (int i = 0; i < 20000; ++i) put(world, 0.0f, 0.0f, sample_ball<D>(0.5f));
  return world;
}

TEST(HostileWork, BodiesInOnePlaceAreAFaultBeforeTheyAreMemory) {
  solver::World<2> world = crowded_world<2>(1);
  reset_allocations();
  const solver::Error error = world.step();
  EXPECT_EQ(error.code, solver::Code::kFaulted);
  EXPECT_STREQ(error.field, "limits.contacts");
  EXPECT_LT(allocations().peak_bytes, 200u << 20);
  ASSERT_TRUE(world.fault().has_value());
  EXPECT_EQ(world.fault()->field, solver::kFaultContacts);
  EXPECT_EQ(world.tick(), 0u);
}

TEST(HostileWork, ThatFaultIsTheSameWithEveryNumberOfWorkers) {
  const auto digest = [](int workers) {
    solver::World<3> world = crowded_world<3>(workers);
    (void)world.step();
    return world.digest();
  };
  const std::uint64_t one = digest(1);
  EXPECT_EQ(digest(2), one);
  EXPECT_EQ(digest(5), one);
}

/// Filters let none of them meet, so no pair is counted; looking at them all has an end as well.
TEST(HostileWork, BodiesThatMayNotMeetInOnePlaceAreLookedAtOnlySoOften) {
  solver::WorldDef<2> def;
  def.limits.contacts = 0;
  solver::World<2> world = checked(solver::World<2>::create(def));
  solver::ShapeDef<2> ball;
  ball.radius = 0.5f;
  ball.filter.mask = 0;
  for (int i = 0; i < 4000; ++i) put(world, 0.0f, 0.0f, ball);
  EXPECT_EQ(world.step().code, solver::Code::kFaulted);
}

TEST(HostileWork, SweepsOfATickAreBounded) {
  solver::WorldDef<2> def;
  def.tuning.substeps = 64;
  def.tuning.sweeps = 1000;
  EXPECT_STREQ(solver::World<2>::create(def).error().field, "substeps");
  def.tuning.sweeps = 100;
  EXPECT_TRUE(solver::World<2>::create(def).ok());
  def.tuning.particle_substeps = 256;
  def.tuning.particle_sweeps = 1000;
  EXPECT_STREQ(solver::World<2>::create(def).error().field, "particle_substeps");
}

/// What a search for the first of a name made quadratic: each shape looks among all materials.
TEST(HostileWork, ManyNamesAreFoundInTime) {
  scenes::Scene scene;
  scene.limits.materials = 1u << 20;
  scene.limits.bodies = 1u << 20;
  scene.limits.shapes = 1u << 20;
  for (int i = 0; i < 50000; ++i) scene.materials.push_back({"m" + std::to_string(i)});
  for (int i = 0; i < 50000; ++i) {
    scenes::SceneBody& body = scene.bodies.emplace_back();
    body.shapes.emplace_back();
    body.shapes[0].radius = 0.5f;
    body.shapes[0].material = "m" + std::to_string(i);
  }
  EXPECT_TRUE(scenes::check(scene).empty());
}

/// What a parser made quadratic that looked among all siblings at the end of each object.
TEST(HostileWork, ManyObjectsAreReadInTime) {
  constexpr std::size_t kBodies = 200000;
  std::string text = R"({"dimension":2,"limits":{"bodies":500000},"bodies":[)";
  for (std::size_t i = 0; i < kBodies; ++i) text += R"({"mass":1},)";
  text.back() = ']';
  const scenes::Loaded loaded = scenes::from_json(text + "}");
  ASSERT_TRUE(loaded.scene);
  EXPECT_EQ(loaded.scene->bodies.size(), kBodies);
}

TEST(HostileWork, MistakesHaveAnEnd) {
  std::string text = "{\"dimension\":2,\"bodies\":[";
  for (int i = 0; i < 30000; ++i) text += "{\"x\":1},";
  text += "0]}";
  const scenes::Loaded loaded = scenes::from_json(text);
  EXPECT_FALSE(loaded.scene);
  EXPECT_LE(loaded.mistakes.size(), scenes::kMistakesMax + 100);
  const std::string key(1u << 22, 'k');
  EXPECT_EQ(scenes::from_json("{\"" + key + "\":1}").mistakes.size(), 1u);
}

}  // namespace
}  // namespace cycloid::hostile
