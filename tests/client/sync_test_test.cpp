#include "client/replica/sync_test.hpp"

#include <gtest/gtest.h>

#include "tests/client/simulated_room.hpp"
#include "tests/determinism/scene_test.hpp"

namespace cycloid::client {
namespace {

class EveryScene : public history::SceneTest {};

/// Some ticks into the scene, where bodies touch, every distance from 1 to 8 in turn.
TEST_P(EveryScene, ComesOutTheSameHoweverFarItGoesBack) {
  const scenes::Scene scene = this->scene();
  RewindableScene world(scene);
  for (int tick = 0; tick < 20; ++tick) ASSERT_EQ(world.step(), "");
  SyncTest test(world, {});
  for (std::uint32_t tick = 0; tick < 2 * kSyncDistanceMax; ++tick) {
    const auto failure = test.advance();
    ASSERT_FALSE(failure) << failure->error << " tick " << failure->tick << " from "
                          << failure->from_tick << ": " << failure->difference;
  }
  EXPECT_EQ(world.tick(), 20u + 2 * kSyncDistanceMax);
  EXPECT_EQ(test.restores(), 2u * kSyncDistanceMax);
  EXPECT_EQ(test.steps(), 2u * kSyncDistanceMax + 2u * (1 + 2 + 3 + 4 + 5 + 6 + 7 + 8));
}

INSTANTIATE_TEST_SUITE_P(Scenes, EveryScene, testing::ValuesIn(history::scene_names()),
                         history::scene_test_name);

/// Ticks until the sync test sees something, at a distance; 0 where it sees nothing in 120.
std::uint64_t seen_at(Rewindable& world, std::uint32_t distance, SyncFailure& seen) {
  SyncTest test(world, {distance});
  for (int tick = 0; tick < 120; ++tick) {
    if (const auto failure = test.advance()) {
      seen = *failure;
      return failure->tick;
    }
  }
  return 0;
}

/// A game with a state of its own beside the world, which no save of the world holds.
class ForgetsACounter final : public RewindableScene {
 public:
  explicit ForgetsACounter(const scenes::Scene& scene)
      : RewindableScene(scene, [this](int seat, std::uint64_t tick) {
          scenes::SeatInput input = restless_input(seat, tick);
          if (++counter_ % 32 == 0) input.axes[0] = 32767;
          return input;
        }) {}

 private:
  std::uint64_t counter_ = 0;
};

/// Contacts forget what they pushed with: the next tick starts its sweeps from nothing.
class ForgetsImpulses final : public RewindableScene {
 public:
  using RewindableScene::RewindableScene;
  void restore(std::size_t place) override {
    RewindableScene::restore(place);
    auto state = simulation().planar()->state();
    for (auto& contact : state.contacts) {
      for (auto& point : contact.points) point.normal_impulse = 0.0f;
    }
    simulation().planar()->restore(state);
  }
};

/// What a button did before is not taken back: a held one acts twice.
class ForgetsRegisters final : public RewindableScene {
 public:
  explicit ForgetsRegisters(const scenes::Scene& scene) : RewindableScene(scene, restless_input) {}
  void restore(std::size_t place) override {
    const std::uint32_t buttons = simulation().planar()->registers()[0];
    RewindableScene::restore(place);
    EXPECT_TRUE(simulation().planar()->set_register(0, buttons).ok());
  }
};

TEST(SyncTestSees, StateThatTheGameKeepsBesideTheWorldAtEveryDistance) {
  const scenes::Scene scene = std::move(*scenes::find("half-pipe").scene);
  for (std::uint32_t distance = 1; distance <= kSyncDistanceMax; ++distance) {
    ForgetsACounter world(scene);
    SyncFailure seen;
    EXPECT_NE(seen_at(world, distance, seen), 0u) << distance;
    EXPECT_NE(seen.digest, seen.digest_again);
    EXPECT_NE(seen.difference, "");
  }
}

TEST(SyncTestSees, ForgottenImpulsesOfContactsAndNamesTheFirstField) {
  const scenes::Scene scene = std::move(*scenes::find("pyramid-20").scene);
  for (std::uint32_t distance = 1; distance <= kSyncDistanceMax; ++distance) {
    ForgetsImpulses world(scene);
    SyncFailure seen;
    EXPECT_NE(seen_at(world, distance, seen), 0u) << distance;
    EXPECT_NE(seen.difference.find(" and "), std::string::npos) << seen.difference;
  }
}

TEST(SyncTestSees, ButtonsThatAreRememberedAcrossAWayBack) {
  const scenes::Scene scene = std::move(*scenes::find("half-pipe").scene);
  ForgetsRegisters world(scene);
  SyncFailure seen;
  EXPECT_NE(seen_at(world, 8, seen), 0u);
}

TEST(SyncTestSees, AWorldThatCannotStep) {
  class Stuck final : public RewindableScene {
   public:
    using RewindableScene::RewindableScene;
    std::string step() override { return tick() == 5 ? "stuck" : RewindableScene::step(); }
  };
  const scenes::Scene scene = std::move(*scenes::find("half-pipe").scene);
  Stuck world(scene);
  SyncFailure seen;
  EXPECT_EQ(seen_at(world, 2, seen), 6u);
  EXPECT_EQ(seen.error, "stuck");
}

TEST(SyncTestSees, NothingInAGoodWorldAtAnyDistance) {
  const scenes::Scene scene = std::move(*scenes::find("half-pipe").scene);
  for (std::uint32_t distance = 0; distance <= kSyncDistanceMax; ++distance) {
    RewindableScene world(scene, restless_input);
    SyncFailure seen;
    EXPECT_EQ(seen_at(world, distance, seen), 0u) << distance << ": " << seen.difference;
  }
}

}  // namespace
}  // namespace cycloid::client
