#include "client/replica/predictor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/client/authority.hpp"
#include "tests/client/simulated_room.hpp"
#include "tests/determinism/scene_test.hpp"

namespace cycloid::client {
namespace {

using Inputs = std::vector<scenes::SeatInput>;

scenes::Scene scene_of(const std::string& name) {
  return std::move(*scenes::find(name).scene);
}

Inputs inputs_at(const scenes::Simulation& simulation, std::uint64_t tick) {
  Inputs inputs;
  for (int seat = 0; seat < simulation.seats(); ++seat)
    inputs.push_back(restless_input(seat, tick));
  return inputs;
}

class Prediction : public testing::TestWithParam<std::string> {};

/// Frames come in bursts, at random times behind my own inputs, and now and then the server has put
/// another input in the place of mine.
TEST_P(Prediction, ConfirmedStateIsTheServersToTheBitWhateverWasPredicted) {
  const scenes::Scene scene = scene_of(GetParam());
  for (const std::uint32_t window : {1u, 7u, 64u}) {
    scenes::Simulation right = SimulatedRoom::make(scene);
    scenes::Simulation mine = SimulatedRoom::make(scene);
    Predictor predictor(mine, {window, 0, one_shot_buttons(scene)});
    std::mt19937 random(window);
    std::uint64_t said = 0;
    while (right.tick() < 90) {
      const std::uint64_t goal = right.tick() + random() % (window + 4);
      while (said < goal) {
        ++said;
        predictor.hear(said, restless_input(0, said));
      }
      predictor.settle();
      ASSERT_EQ(predictor.predicted_tick(), mine.tick());
      ASSERT_LE(predictor.predicted_tick(), predictor.confirmed_tick() + window);
      for (auto frames = random() % (2 + window / 4); frames > 0; --frames) {
        Inputs inputs = inputs_at(right, right.tick() + 1);
        if (random() % 8 == 0 && !inputs.empty()) inputs[0] = {};
        ASSERT_TRUE(right.step(inputs).ok());
        ASSERT_TRUE(predictor.confirm(inputs).ok());
        ASSERT_EQ(predictor.confirmed_tick(), right.tick());
        const auto digest = predictor.with_confirmed([](const auto& at) { return at.digest(); });
        ASSERT_EQ(digest, right.digest()) << "tick " << right.tick() << ", window " << window;
      }
    }
    while (right.tick() < said) {
      const Inputs inputs = inputs_at(right, right.tick() + 1);
      ASSERT_TRUE(right.step(inputs).ok());
      ASSERT_TRUE(predictor.confirm(inputs).ok());
    }
    predictor.settle();
    EXPECT_EQ(mine.digest(), right.digest());
    EXPECT_GT(predictor.statistics().rollbacks, 0u);
    EXPECT_LE(predictor.statistics().deepest_ticks, window);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Prediction,
                         testing::Values("half-pipe", "room-200", "character-course",
                                         "character-course-3d", "vehicle-3d", "ragdoll-motors"),
                         history::scene_test_name);

class PredictorTest : public testing::Test {
 protected:
  static constexpr std::uint32_t kWindow = 5;
  PredictorTest() : predictor_(simulation_, {kWindow, 0, one_shot_buttons(scene_)}) {}
  void say(std::uint64_t tick) {
    predictor_.hear(tick, restless_input(0, tick));
    predictor_.settle();
  }

  scenes::Scene scene_ = scene_of("half-pipe");
  scenes::Simulation simulation_ = SimulatedRoom::make(scene_);
  Predictor predictor_;
};

TEST_F(PredictorTest, StallsWhenTheWindowIsFullAndGoesOnWithTheNextFrame) {
  for (std::uint64_t tick = 1; tick <= 8; ++tick) say(tick);
  EXPECT_TRUE(predictor_.full());
  EXPECT_EQ(simulation_.tick(), 5u);
  EXPECT_EQ(predictor_.statistics().stalls, 3u);
  ASSERT_TRUE(predictor_.confirm(inputs_at(simulation_, 1)).ok());
  predictor_.settle();
  EXPECT_EQ(simulation_.tick(), 6u);
}

TEST_F(PredictorTest, RightPredictionIsNotSteppedAgain) {
  Inputs inputs(static_cast<std::size_t>(simulation_.seats()));
  for (std::uint64_t tick = 1; tick <= 5; ++tick) say(tick);
  for (std::uint64_t tick = 1; tick <= 5; ++tick) {
    inputs[0] = restless_input(0, tick);
    ASSERT_TRUE(predictor_.confirm(inputs).ok());
  }
  EXPECT_EQ(predictor_.statistics().rollbacks, 0u);
  EXPECT_EQ(predictor_.statistics().resimulated, 0u);
  EXPECT_EQ(predictor_.confirmed_tick(), 5u);
}

TEST_F(PredictorTest, WrongPredictionGoesBackOnceForAllFramesAtHand) {
  for (std::uint64_t tick = 1; tick <= 5; ++tick) say(tick);
  Inputs inputs = inputs_at(simulation_, 1);
  ASSERT_TRUE(predictor_.confirm(inputs).ok());
  ASSERT_TRUE(predictor_.confirm(inputs).ok());
  ASSERT_TRUE(predictor_.confirm(inputs).ok());
  predictor_.settle();
  EXPECT_EQ(predictor_.statistics().rollbacks, 1u);
  EXPECT_EQ(predictor_.statistics().deepest_ticks, 5u);
  EXPECT_EQ(predictor_.statistics().resimulated, 5u);
  EXPECT_EQ(simulation_.tick(), 5u);
}

TEST_F(PredictorTest, OthersAreTakenToRepeatThemselvesWithoutOneShotButtons) {
  const std::vector<std::uint16_t> once = one_shot_buttons(scene_);
  ASSERT_EQ(once.size(), static_cast<std::size_t>(simulation_.seats()));
  Inputs inputs(once.size());
  inputs[1].axes[0] = 20000;
  inputs[1].buttons = 0xffff;
  ASSERT_TRUE(predictor_.confirm(inputs).ok());
  say(2);
  Inputs guess = inputs;
  guess[0] = restless_input(0, 2);
  guess[1].buttons = static_cast<std::uint16_t>(0xffff & ~once[1]);
  ASSERT_TRUE(predictor_.confirm(guess).ok());
  EXPECT_EQ(predictor_.statistics().rollbacks, 0u) << "that is what was predicted";
}

TEST_F(PredictorTest, ResetToAnEarlierTickForgetsWhatWasSaidAfterIt) {
  for (std::uint64_t tick = 1; tick <= 5; ++tick) say(tick);
  for (std::uint64_t tick = 1; tick <= 4; ++tick)
    ASSERT_TRUE(predictor_.confirm(inputs_at(simulation_, tick)).ok());
  scenes::Simulation start = SimulatedRoom::make(scene_);
  std::vector<std::byte> bytes;
  start.encode(bytes);
  ASSERT_TRUE(simulation_.decode(bytes).ok());
  predictor_.reset(true);
  predictor_.settle();
  EXPECT_EQ(predictor_.confirmed_tick(), 0u);
  EXPECT_EQ(predictor_.predicted_tick(), 0u);
  ASSERT_TRUE(predictor_.confirm(Inputs(2)).ok());
  ASSERT_TRUE(start.step(Inputs(2)).ok());
  EXPECT_EQ(simulation_.digest(), start.digest());
}

TEST_F(PredictorTest, AMatchThatGoesBackToTheConfirmedTickForgetsWhatWasSaidAfterIt) {
  scenes::Simulation right = SimulatedRoom::make(scene_);
  for (std::uint64_t tick = 1; tick <= 5; ++tick) say(tick);
  for (std::uint64_t tick = 1; tick <= 4; ++tick) {
    ASSERT_TRUE(predictor_.confirm(inputs_at(simulation_, tick)).ok());
    ASSERT_TRUE(right.step(inputs_at(right, tick)).ok());
  }
  std::vector<std::byte> bytes;
  right.encode(bytes);
  ASSERT_TRUE(simulation_.decode(bytes).ok());
  predictor_.reset(true);
  predictor_.settle();
  EXPECT_EQ(predictor_.predicted_tick(), 4u);
  Inputs guess = inputs_at(right, 4);  // The last that was said in the history that still stands.
  const std::vector<std::uint16_t> once = one_shot_buttons(scene_);
  for (std::size_t seat = 0; seat < guess.size(); ++seat)
    guess[seat].buttons &= static_cast<std::uint16_t>(~once[seat]);
  predictor_.hear(6, restless_input(0, 6));
  predictor_.settle();
  ASSERT_TRUE(right.step(guess).ok());
  guess[0] = restless_input(0, 6);
  ASSERT_TRUE(right.step(guess).ok());
  EXPECT_EQ(simulation_.digest(), right.digest());
}

// Of a tick that never came to be, because the server put another input in the place of mine.
TEST(PredictorFaults, AFaultThatWasOnlyPredictedIsTakenBack) {
  scenes::Scene scene = scene_of("half-pipe");
  for (scenes::Control& control : scene.seats[0].controls) {
    control.effect = scenes::Effect::kForce;
    control.value = {1.0e11f, 1.0e11f, 0.0f};
  }
  scenes::Simulation right = SimulatedRoom::make(scene);
  scenes::Simulation mine = SimulatedRoom::make(scene);
  Predictor predictor(mine, {5, 0, one_shot_buttons(scene)});
  scenes::SeatInput all;
  all.axes.fill(32767);
  all.buttons = 0xffff;
  const Inputs neutral(2);
  for (std::uint64_t tick = 1; tick <= 3; ++tick) {
    predictor.hear(tick, all);
    predictor.settle();
    EXPECT_EQ(predictor.statistics().faults, tick);
    EXPECT_EQ(predictor.predicted_tick(), tick - 1);
    EXPECT_FALSE(mine.fault());
    ASSERT_TRUE(right.step(neutral).ok());
    ASSERT_TRUE(predictor.confirm(neutral).ok());
    EXPECT_EQ(mine.digest(), right.digest());
  }
}

TEST_F(PredictorTest, WrongNumberOfInputsChangesNothing) {
  for (std::uint64_t tick = 1; tick <= 3; ++tick) say(tick);
  const std::uint64_t digest = simulation_.digest();
  EXPECT_FALSE(predictor_.confirm(Inputs(7)).ok());
  EXPECT_EQ(simulation_.digest(), digest);
  EXPECT_EQ(predictor_.confirmed_tick(), 0u);
}

TEST(OneShotButtons, AreThoseThatActOnlyWhenTheyGoDown) {
  scenes::Scene scene;
  scene.seats.resize(1);
  const auto add = [&](scenes::Source source, std::uint32_t index, scenes::Effect effect) {
    scenes::Control& control = scene.seats[0].controls.emplace_back();
    control.source = source;
    control.index = index;
    control.effect = effect;
  };
  add(scenes::Source::kButton, 0, scenes::Effect::kJump);
  add(scenes::Source::kButton, 1, scenes::Effect::kForce);
  add(scenes::Source::kButton, 2, scenes::Effect::kSpawn);
  add(scenes::Source::kButton, 2, scenes::Effect::kWalk);
  add(scenes::Source::kButton, 3, scenes::Effect::kImpulse);
  add(scenes::Source::kAxis, 1, scenes::Effect::kForce);
  EXPECT_EQ(one_shot_buttons(scene), (std::vector<std::uint16_t>{0b1001}));
}

/// The report of ggrs#63: far apart, no input delay, a digest every tick.
TEST(PredictingReplica, HasNoFalseDesyncAt300MillisecondsWithADigestEveryTick) {
  const scenes::Scene scene = scene_of("half-pipe");
  SimulatedRoom room(scene, 63);
  room.sit({300000, 4000}, 1, 64);
  room.sit({300000, 4000}, 1, 64);
  room.run(600);
  room.quiet();
  for (const SimulatedRoom::Seat& seat : room.seats()) {
    const Replica& client = *seat.client;
    EXPECT_EQ(client.progress().phase, Phase::kRunning) << client.progress().reason;
    EXPECT_EQ(client.progress().last_tick, 600u);
    EXPECT_EQ(client.progress().digests_compared, 600u);
    EXPECT_EQ(client.progress().mismatches, 0u);
    EXPECT_EQ(client.digest(), room.digests().back());
    const PredictorStatistics& statistics = client.predictor()->statistics();
    EXPECT_GT(statistics.rollbacks, 50u);
    EXPECT_GE(statistics.deepest_ticks, 17u);
    EXPECT_GT(client.simulation().tick(), 616u) << "the state to show is ahead";
  }
}

TEST(PredictingReplica, AWindowSmallerThanTheLeadDelaysMyOwnInputAndStaysRight) {
  const scenes::Scene scene = scene_of("character-course");
  SimulatedRoom room(scene, 5);
  room.sit({100000, 0}, 1, 3);
  room.run(300);
  room.quiet();
  const Replica& client = *room.seats()[0].client;
  EXPECT_EQ(client.progress().mismatches, 0u);
  EXPECT_EQ(client.simulation().tick(), 303u);
  EXPECT_EQ(client.digest(), room.digests().back());
}

TEST(PredictingReplica, HostsClockPredictsThroughASilenceUntilTheWindowIsFull) {
  const scenes::Scene scene = scene_of("half-pipe");
  SimulatedRoom room(scene, 5);
  room.sit({0, 0}, 2, 10);
  room.run(20);
  room.quiet();
  Replica& client = *room.seats()[0].client;
  ASSERT_EQ(client.progress().last_tick, 20u);
  const std::uint64_t ahead = client.simulation().tick();
  Outbox out;
  std::uint64_t advanced = 0;
  while (client.advance(out)) ++advanced;
  EXPECT_EQ(client.simulation().tick(), 30u);
  EXPECT_EQ(ahead + advanced, 30u);
  EXPECT_EQ(out.size(), advanced) << "each is said as well";
}

TEST(PredictingReplica, KeepsWhatIsConfirmedAndGoesOnFromIt) {
  const scenes::Scene scene = scene_of("half-pipe");
  Authority authority(scene);
  const auto options = [&](bool holds_state) {
    FollowerOptions made;
    made.predict_ticks = 10;
    made.holds_state = holds_state;
    made.resume = {std::byte{1}};
    made.input = [&](int seat, std::uint64_t tick) {
      return scenes::scripted_input(scene, seat, tick);
    };
    return made;
  };
  const auto create = [&] { return std::move(scenes::Simulation::create(scene).value()); };
  Outbox out;
  Replica before(create(), options(false));
  scenes::Simulation::Saved kept;
  EXPECT_FALSE(before.keep(kept)) << "nothing has come yet";
  before.receive(authority.welcome(0), out);
  before.receive(authority.snapshot(), out);
  for (int i = 0; i < 20; ++i) before.receive(authority.frame(), out);
  before.settle();
  for (int i = 0; i < 5; ++i) before.advance(out);
  const std::uint64_t shown = before.simulation().digest();
  ASSERT_GT(before.simulation().tick(), 20u);
  ASSERT_TRUE(before.keep(kept));
  EXPECT_EQ(kept.digest(), authority.simulation().digest());
  EXPECT_EQ(before.simulation().digest(), shown) << "what is shown has not changed";

  scenes::Simulation simulation = create();
  simulation.restore(kept);
  Replica after(std::move(simulation), options(true));
  out.clear();
  after.greet(out);
  ASSERT_EQ(out.size(), 2u);
  EXPECT_EQ(std::get<protocol::Ack>(out[1]).tick, 20u);
  after.receive(authority.welcome(0), out);
  EXPECT_FALSE(after.advance(out)) << "it does not know yet where the match is";
  for (int i = 0; i < 100; ++i) after.receive(authority.frame(), out);
  after.receive(protocol::Pong{1, 120}, out);
  after.receive(authority.frame(), out);
  after.receive(authority.digest(), out);
  after.settle();
  EXPECT_EQ(after.progress().mismatches, 0u);
  EXPECT_EQ(after.progress().digests_compared, 1u);
  EXPECT_EQ(after.digest(), authority.simulation().digest());
  EXPECT_GT(after.simulation().tick(), 121u) << "it predicts again";
  const auto first = std::ranges::find_if(
      out, [](const auto& said) { return std::holds_alternative<protocol::Input>(said); });
  ASSERT_NE(first, out.end());
  EXPECT_GT(std::get<protocol::Input>(*first).tick, 121u);
}

}  // namespace
}  // namespace cycloid::client
