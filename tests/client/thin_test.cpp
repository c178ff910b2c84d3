#include "client/replica/thin.hpp"

#include <gtest/gtest.h>

#include "protocol/state/exact_delta.hpp"
#include "protocol/state/quantised_delta.hpp"
#include "protocol/state/state_feed.hpp"
#include "tests/client/fed.hpp"

namespace cycloid::client {
namespace {

using protocol::Profile;

/// A snapshot client beside a server's deltas, which are as large and as old as a test wants.
class ThinStates : public Fed<Thin> {
 protected:
  static protocol::FeedOptions deltas(Profile profile) {
    protocol::FeedOptions options;
    options.profile = profile;
    options.budget_bytes = std::size_t{1} << 20;
    options.history = {10'000, std::size_t{1} << 30};
    return options;
  }
  FollowerOptions options_of(Profile profile) {
    FollowerOptions wanted = options();
    wanted.profile = profile;
    return wanted;
  }
  /// Makes a tick. @returns what the client would hold of it.
  protocol::StateKey tick(protocol::StateFeed& states) { return tick(states, authority_); }
  static protocol::StateKey tick(protocol::StateFeed& states, Authority& authority) {
    authority.frame();
    states.advance(authority.simulation(), authority.simulation().digest());
    return states.now();
  }
};

TEST_F(ThinStates, ExactDeltasOnWhatWasAcknowledgedGiveTheStateToTheBit) {
  start();
  protocol::Snapshot before = authority_.snapshot();
  std::size_t bytes = 0;
  for (int i = 0; i < 20; ++i) {
    for (int tick = 0; tick < 3; ++tick) authority_.frame();
    const protocol::Snapshot now = authority_.snapshot();
    protocol::StateDelta delta{now.tick, before.tick, now.digest, protocol::Profile::kExact, {}};
    const bool from_nothing = before.tick == 0;
    ASSERT_TRUE(protocol::encode_exact_delta(
        from_nothing ? std::span<const std::byte>() : std::span<const std::byte>(before.state),
        now.state, delta.bytes));
    if (!from_nothing) bytes = std::max(bytes, delta.bytes.size());
    feed(delta);
    ASSERT_EQ(follower_.progress().phase, Phase::kRunning) << follower_.progress().reason;
    EXPECT_EQ(follower_.digest(), authority_.simulation().digest());
    before = now;
  }
  EXPECT_LT(bytes, before.state.size() / 2);
  const auto acks = all_of<protocol::Ack>(outbox_);
  ASSERT_EQ(acks.size(), 21u);
  EXPECT_EQ(acks.back().tick, 60u);
}

TEST_F(ThinStates, QuantisedDeltasGoOnFromTheExactStateAndStayWithinTheGrid) {
  FollowerOptions quantising = options();
  quantising.profile = protocol::Profile::kQuantised;
  Thin follower(make(), quantising);
  for (int i = 0; i < 5; ++i) authority_.frame();
  follower.receive(authority_.welcome(0), outbox_);
  for (const auto& part : parts_of(authority_.snapshot())) follower.receive(part, outbox_);
  protocol::HeldState held;
  held.state = protocol::capture(authority_.simulation());
  for (int i = 0; i < 20; ++i) {
    const std::uint64_t baseline = authority_.simulation().tick();
    authority_.frame();
    const auto now = protocol::capture(authority_.simulation());
    const auto delta = protocol::encode_quantised(&held, now, 1u << 20);
    held = delta.held;
    follower.receive(protocol::StateDelta{now.tick, baseline, protocol::digest_of(held.state),
                                          protocol::Profile::kQuantised, delta.bytes},
                     outbox_);
    ASSERT_EQ(follower.progress().phase, Phase::kRunning) << follower.progress().reason;
    const auto right = authority_.simulation().poses();
    const auto shown = follower.poses();
    ASSERT_EQ(shown.size(), right.size());
    for (std::size_t body = 0; body < right.size(); ++body) {
      EXPECT_EQ(shown[body].index, right[body].index);
      for (std::size_t axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(shown[body].position[axis], right[body].position[axis], 0.001);
    }
  }
  EXPECT_EQ(follower.progress().last_tick, 25u);
}

TEST_F(ThinStates, AreAlsoTakenInParts) {
  feed(authority_.welcome(0));
  for (const auto& part : parts_of(authority_.snapshot(), 5000)) feed(part);
  EXPECT_EQ(follower_.progress().phase, Phase::kRunning);
  EXPECT_EQ(all_of<protocol::Ack>(outbox_).size(), 1u);
}

TEST_F(ThinStates, DeltaOfABaselineThatIsNotHeldIsDroppedAndNotAcknowledged) {
  Thin follower(make(), options_of(Profile::kQuantised));
  protocol::StateFeed states(deltas(Profile::kQuantised));
  const auto say = [&](std::optional<protocol::StateKey> baseline) {
    follower.receive(states.delta(baseline)->message, outbox_);
  };
  follower.receive(authority_.welcome(0), outbox_);
  const protocol::StateKey first = tick(states);
  say(std::nullopt);
  const protocol::StateKey unsaid = tick(states);
  tick(states);
  say(unsaid);
  EXPECT_EQ(follower.progress().deltas_dropped, 1u);
  EXPECT_EQ(follower.progress().last_tick, 1u);
  EXPECT_EQ(all_of<protocol::Ack>(outbox_).size(), 1u);
  const protocol::StateKey fourth = tick(states);
  say(first);
  EXPECT_EQ(follower.progress().last_tick, 4u);
  EXPECT_EQ(follower.digest(), fourth.digest);
  EXPECT_EQ(follower.baselines(), 2u);
  tick(states);
  say(fourth);
  EXPECT_EQ(follower.baselines(), 2u) << "what is older than the server's baseline is let go";
  EXPECT_EQ(all_of<protocol::Ack>(outbox_).size(), 3u);
}

/// A client's acknowledgements may be stalled for as long as a server keeps what it has sent.
TEST_F(ThinStates, EveryStateThatAServerMayBuildOnIsHeld) {
  for (const Profile profile : {Profile::kExact, Profile::kQuantised}) {
    Thin follower(make(), options_of(profile));
    protocol::StateFeed states(deltas(profile));
    protocol::SentStates sent;
    Authority authority(scene_);
    follower.receive(authority.welcome(0), outbox_);
    for (std::size_t i = 0; i <= protocol::SentStates::kSentMax; ++i) {
      sent.sent(tick(states, authority));
      follower.receive(states.delta(std::nullopt)->message, outbox_);
    }
    EXPECT_EQ(follower.baselines(), Thin::kBaselinesMax);
    for (const std::uint64_t acknowledged : {2u, 7u, 256u}) {
      ASSERT_TRUE(sent.acknowledge(acknowledged));
      const std::uint64_t now = tick(states, authority).tick;
      const auto delta = states.delta(sent.baseline());
      ASSERT_EQ(delta->message.baseline_tick, acknowledged);
      follower.receive(delta->message, outbox_);
      EXPECT_EQ(follower.progress().last_tick, now) << follower.progress().reason;
    }
    EXPECT_EQ(follower.progress().deltas_dropped, 0u);
  }
}

TEST_F(ThinStates, BaselinesAreBoundedInBytesAndTheOneInUseStays) {
  protocol::StateFeed states(deltas(Profile::kExact));
  FollowerOptions few = options();
  few.baselines_bytes_max = 10 * authority_.snapshot().state.size();
  Thin follower(make(), few);
  follower.receive(authority_.welcome(0), outbox_);
  std::vector<protocol::StateKey> keys;
  for (int i = 0; i < 40; ++i) {
    keys.push_back(tick(states));
    follower.receive(states.delta(std::nullopt)->message, outbox_);
  }
  EXPECT_EQ(follower.progress().last_tick, 40u) << follower.progress().reason;
  EXPECT_LE(follower.baselines(), 10u);
  EXPECT_GE(follower.baselines(), 5u);
  tick(states);
  follower.receive(states.delta(keys[1])->message, outbox_);
  EXPECT_EQ(follower.progress().deltas_dropped, 1u);
  follower.receive(states.delta(keys[0])->message, outbox_);
  EXPECT_EQ(follower.progress().deltas_dropped, 1u);
  EXPECT_EQ(follower.progress().last_tick, 41u);
}

TEST_F(ThinStates, AStateThatIsSaidAgainIsNoMistakeAndAnOlderOneIs) {
  for (const Profile profile : {Profile::kExact, Profile::kQuantised}) {
    Thin follower(make(), options_of(profile));
    protocol::StateFeed states(deltas(profile));
    follower.receive(authority_.welcome(0), outbox_);
    const protocol::StateKey first = tick(states);
    const protocol::StateDelta older = states.delta(std::nullopt)->message;
    follower.receive(older, outbox_);
    tick(states);
    for (int i = 0; i < 2; ++i) follower.receive(states.delta(first)->message, outbox_);
    EXPECT_EQ(follower.progress().phase, Phase::kRunning) << follower.progress().reason;
    EXPECT_EQ(follower.digest(), states.now().digest);
    EXPECT_EQ(follower.baselines(), 2u);
    follower.receive(older, outbox_);
    EXPECT_EQ(follower.progress().phase, Phase::kFailed);
  }
}

/// So a spectator of a room with a delay is shown the past.
TEST_F(ThinStates, AQuantisedClientGoesOnFromAWholeExactDelta) {
  Thin follower(make(), options_of(Profile::kQuantised));
  protocol::StateFeed exact(deltas(Profile::kExact));
  protocol::StateFeed quantised(deltas(Profile::kQuantised));
  follower.receive(authority_.welcome(0), outbox_);
  for (int i = 0; i < 3; ++i) {
    tick(exact);
    follower.receive(exact.delta(std::nullopt)->message, outbox_);
    ASSERT_EQ(follower.progress().phase, Phase::kRunning) << follower.progress().reason;
    EXPECT_EQ(follower.digest(), authority_.simulation().digest());
  }
  quantised.advance(authority_.simulation(), 0);
  const protocol::StateKey baseline = quantised.now();
  const protocol::StateKey now = tick(quantised);
  follower.receive(quantised.delta(baseline)->message, outbox_);
  EXPECT_EQ(follower.digest(), now.digest) << follower.progress().reason;
  EXPECT_EQ(follower.progress().deltas_dropped, 0u);
}

TEST_F(ThinStates, WhatWasShownBeforeARewindIsShownUntilTheStateComes) {
  Thin follower(make(), options_of(Profile::kQuantised));
  protocol::StateFeed states(deltas(Profile::kQuantised));
  follower.receive(authority_.welcome(0), outbox_);
  for (int i = 0; i < 30; ++i) tick(states);
  follower.receive(states.delta(std::nullopt)->message, outbox_);
  const auto shown = follower.poses();
  const std::uint64_t digest = follower.digest();
  ASSERT_NE(shown.at(1).position, make().poses().at(1).position) << "or it would prove nothing";
  follower.receive(protocol::RoomNotice{protocol::NoticeKind::kRewound, 30, 10, ""}, outbox_);
  ASSERT_EQ(follower.progress().phase, Phase::kLoading);
  ASSERT_EQ(follower.poses().size(), shown.size());
  for (std::size_t i = 0; i < shown.size(); ++i)
    EXPECT_EQ(follower.poses()[i].position, shown[i].position);
  EXPECT_EQ(follower.digest(), digest);
}

TEST_F(ThinStates, CorruptDeltasEndTheSession) {
  const protocol::Snapshot state = authority_.snapshot();
  protocol::StateDelta good{0, 0, state.digest, Profile::kExact, {}};
  ASSERT_TRUE(protocol::encode_exact_delta({}, state.state, good.bytes));
  protocol::StateDelta torn = good;
  torn.bytes.resize(torn.bytes.size() / 2);
  protocol::StateDelta other_tick = good;
  other_tick.tick = 1;
  protocol::StateDelta lying{1, 0, 3, Profile::kQuantised, {}};
  lying.bytes =
      protocol::encode_quantised(nullptr, protocol::capture(authority_.simulation()), 4096).bytes;
  protocol::StateDelta damaged = lying;
  damaged.bytes = {std::byte{1}};
  struct Case {
    Profile profile;
    protocol::StateDelta delta;
    const char* words;
  };
  const Case cases[] = {
      {Profile::kExact, torn, "corrupt"},
      {Profile::kExact, other_tick, "the tick or the digest that it says"},
      {Profile::kQuantised, lying, "corrupt: a damaged state of tick 1"},
      {Profile::kQuantised, damaged, "corrupt: a damaged state of tick 1"},
      {Profile::kExact, lying, "a state of the other profile"},
  };
  for (const Case& wrong : cases) {
    Thin follower(make(), options_of(wrong.profile));
    follower.receive(authority_.welcome(0), outbox_);
    follower.receive(wrong.delta, outbox_);
    EXPECT_EQ(follower.progress().phase, Phase::kFailed);
    EXPECT_NE(follower.progress().reason.find(wrong.words), std::string::npos)
        << follower.progress().reason;
  }
}

}  // namespace
}  // namespace cycloid::client
