#include <gtest/gtest.h>

#include "scenes/build.hpp"

namespace cycloid::scenes {

/// Without inputs, what falls comes to rest and sleeps: everything that forces move.
static void expect_asleep(const char* name, int ticks) {
  const Loaded loaded = find(name);
  ASSERT_TRUE(loaded.scene.has_value()) << name;
  std::vector<Mistake> mistakes;
  const auto built = build<2>(*loaded.scene, mistakes);
  ASSERT_NE(built, nullptr) << name;
  for (int tick = 0; tick < ticks; ++tick) ASSERT_TRUE(built->world.step().ok()) << name;
  for (const solver::Body<2>& body : built->world.state().bodies)
    if (body.inverse_mass > 0.0f) {
      EXPECT_EQ(body.asleep, 1u) << name;
    }
  EXPECT_EQ(built->world.statistics().rows, 0u) << name;
}

TEST(Rest, RagdollsPilesAndACardHouseFallAsleep) {
  expect_asleep("ragdolls", 3600);
  expect_asleep("room-200", 3600);
  expect_asleep("pyramid-20", 600);
  expect_asleep("card-house", 600);
  expect_asleep("overlap", 600);
}

}  // namespace cycloid::scenes
