#include "protocol/state/state_feed.hpp"

#include <gtest/gtest.h>

#include <deque>
#include <random>
#include <set>

#include "protocol/state/received_states.hpp"
#include "tests/protocol/state_scenes.hpp"

namespace cycloid::protocol {
namespace {

using states::Played;

/// A client behind a link that delays, and sometimes a server that drops what waits for it, as the
/// room does with snapshots that a slow client has not read.
struct FarClient {
  int delay_ticks = 0;
  int loss_percent = 0;
  ReceivedStates received;
  SentStates sent;
  std::deque<std::pair<int, StateDelta>> down{};
  std::deque<std::pair<int, std::uint64_t>> up{};
  int taken = 0;
};

/// What the world was after each tick, to compare with.
struct Truth {
  std::vector<states::Encoding> exact;
  std::vector<QuantisedState> quantised;
};

void send(StateFeed& feed, int tick, std::mt19937& random, FarClient& client) {
  const auto delta = feed.delta(client.sent.baseline());
  if (static_cast<int>(random() % 100) < client.loss_percent) return;
  client.sent.sent(delta->held);
  client.down.emplace_back(tick + client.delay_ticks, delta->message);
}

void receive(Profile profile, int tick, const Truth& truth, bool budget_binds, FarClient& client) {
  while (!client.down.empty() && client.down.front().first <= tick) {
    const StateDelta message = client.down.front().second;
    client.down.pop_front();
    ASSERT_EQ(client.received.take(message), "");
    ++client.taken;
    if (profile == Profile::kExact) {
      ASSERT_EQ(client.received.exact(), truth.exact[message.tick]);
    } else if (!budget_binds) {
      ASSERT_EQ(client.received.quantised(), truth.quantised[message.tick]);
    }
    client.up.emplace_back(tick + client.delay_ticks, message.tick);
  }
  while (!client.up.empty() && client.up.front().first <= tick) {
    ASSERT_TRUE(client.sent.acknowledge(client.up.front().second));
    client.up.pop_front();
  }
}

struct Link {
  Profile profile = Profile::kQuantised;
  std::size_t budget = 1u << 20;
};

/// Eight clients with delays of 0 to 7 ticks, some of which lose a third of what they are sent.
void expect_all_follow(const std::string& name, const Link& link) {
  SCOPED_TRACE(name);
  std::mt19937 random(41);
  Played played(name);
  StateFeed feed({link.profile, {}, link.budget, {}});
  std::vector<FarClient> clients;
  for (int i = 0; i < 8; ++i)
    clients.push_back({i, i % 3 == 2 ? 33 : 0, ReceivedStates(link.profile), {}});
  Truth truth{{{}}, {{}}};
  for (int tick = 1; tick <= 120; ++tick) {
    played.step_wildly(random);
    truth.exact.push_back(played.encoding());
    truth.quantised.push_back(capture(played.simulation()));
    feed.advance(played.simulation(), played.simulation().digest());
    std::set<std::optional<StateKey>> baselines;
    const std::uint64_t encodes = feed.encodes();
    for (FarClient& client : clients) {
      baselines.insert(client.sent.baseline());
      send(feed, tick, random, client);
    }
    EXPECT_LE(feed.encodes() - encodes, baselines.size());
    for (FarClient& client : clients)
      receive(link.profile, tick, truth, link.budget < 1000, client);
    EXPECT_LE(feed.states(), 181u * 9u);
  }
  for (const FarClient& client : clients) {
    EXPECT_GT(client.taken, 60);
    EXPECT_LT(client.received.states(), 24u) << "baselines that nobody names are not let go";
  }
}

TEST(StateFeed, FollowsThroughDelaysAndLossesExactly) {
  for (const char* name : {"ragdolls", "character-course-3d"})
    expect_all_follow(name, {Profile::kExact});
}

TEST(StateFeed, FollowsThroughDelaysAndLossesOnTheGrid) {
  for (const std::string& name : states::names()) expect_all_follow(name, {});
}

TEST(StateFeed, FollowsThroughDelaysAndLossesWithinABudget) {
  for (const char* name : {"ball-pit-3d", "room-200"})
    expect_all_follow(name, {Profile::kQuantised, 150});
}

TEST(StateFeed, CodesOnceForEachBaselineAndNotForEachClient) {
  Played played("ragdolls");
  StateFeed feed({});
  std::vector<StateKey> keys;
  for (int tick = 0; tick < 10; ++tick) {
    played.step();
    feed.advance(played.simulation(), played.simulation().digest());
    keys.push_back(feed.now());
  }
  const std::uint64_t before = feed.encodes();
  for (int client = 0; client < 128; ++client) {
    const auto delta = feed.delta(keys[static_cast<std::size_t>(client % 3)]);
    EXPECT_EQ(delta, feed.delta(keys[static_cast<std::size_t>(client % 3)]));
    EXPECT_EQ(delta->held, feed.now()) << "they meet in one baseline";
  }
  EXPECT_EQ(feed.encodes() - before, 3u);
  // Ways that lead to the same state lead to the same baseline.
  played.step();
  feed.advance(played.simulation(), played.simulation().digest());
  EXPECT_EQ(feed.delta(keys[9])->message.baseline_tick, keys[9].tick);
}

TEST(StateFeed, ABaselineThatIsGoneMeansAFullState) {
  Played played("stack-10");
  StateFeed feed({Profile::kQuantised, {}, 1u << 20, {20, 16u << 20}});
  played.step();
  feed.advance(played.simulation(), 0);
  const StateKey first = feed.now();
  for (int tick = 0; tick < 20; ++tick) {
    played.step();
    feed.advance(played.simulation(), 0);
  }
  EXPECT_EQ(feed.delta(first)->message.baseline_tick, first.tick);
  EXPECT_EQ(feed.states(), 21u);
  played.step();
  feed.advance(played.simulation(), 0);
  EXPECT_EQ(feed.states(), 21u);
  const auto full = feed.delta(first);
  EXPECT_EQ(full->message.baseline_tick, 0u);
  EXPECT_EQ(full, feed.delta(std::nullopt));
  ReceivedStates fresh(Profile::kQuantised);
  EXPECT_EQ(fresh.take(full->message), "");
  EXPECT_EQ(fresh.quantised(), capture(played.simulation()));
  feed.forget_before(played.simulation().tick());
  EXPECT_EQ(feed.states(), 1u);
  feed.forget_all();
  EXPECT_EQ(feed.states(), 0u);
  EXPECT_EQ(feed.bytes(), 0u);
}

TEST(StateFeed, AnotherStateOfATickIsNoBaseline) {
  Played played("stack-10");
  StateFeed feed({});
  played.step();
  feed.advance(played.simulation(), 0);
  const StateKey wrong{feed.now().tick, feed.now().digest ^ 1u};
  played.step();
  feed.advance(played.simulation(), 0);
  EXPECT_EQ(feed.delta(wrong)->message.baseline_tick, 0u);
  EXPECT_EQ(feed.delta(feed.now())->message.baseline_tick, 0u) << "not before itself";
}

TEST(StateFeed, NothingNewNeedsNotBeSent) {
  Played played("cubes-901");
  played.idle(400);
  StateFeed feed({});
  feed.advance(played.simulation(), 0);
  const StateKey rest = feed.now();
  ReceivedStates received(Profile::kQuantised);
  ASSERT_EQ(received.take(feed.delta(std::nullopt)->message), "");
  played.idle(60);
  feed.advance(played.simulation(), 0);
  const auto delta = feed.delta(rest);
  EXPECT_FALSE(delta->changes);
  EXPECT_TRUE(delta->message.bytes.empty());
  EXPECT_EQ(received.take(delta->message), "");
  EXPECT_EQ(received.quantised().tick, rest.tick + 60);
}

/// A state of any size.
struct Blob {
  std::size_t bytes;
};
std::size_t size_bytes(const Blob& blob) {
  return blob.bytes;
}

TEST(StateHistory, IsBoundedInBytesAndTicks) {
  StateHistory<Blob> history({100, 1000});
  for (std::uint64_t tick = 1; tick <= 50; ++tick) {
    history.put({tick, 7}, std::make_shared<const Blob>(Blob{90}));
    EXPECT_LE(history.bytes(), 1000u);
  }
  EXPECT_EQ(history.states(), 11u);
  EXPECT_EQ(history.find({39, 7}), nullptr);
  EXPECT_NE(history.find({40, 7}), nullptr);
  EXPECT_EQ(history.find({40, 8}), nullptr);
  history.put({50, 7}, std::make_shared<const Blob>(Blob{90}));
  EXPECT_EQ(history.states(), 11u) << "the same is kept once";
  history.put({51, 7}, std::make_shared<const Blob>(Blob{1001}));
  EXPECT_EQ(history.states(), 0u);
  EXPECT_EQ(history.bytes(), 0u);
}

TEST(SentStates, AreBoundedAndOnlyGoForward) {
  SentStates sent;
  for (std::uint64_t tick = 1; tick <= 1000; ++tick) sent.sent({tick, tick + 5});
  EXPECT_EQ(sent.unanswered(), SentStates::kSentMax);
  EXPECT_FALSE(sent.acknowledge(1));
  EXPECT_FALSE(sent.acknowledge(1001));
  EXPECT_FALSE(sent.baseline());
  EXPECT_TRUE(sent.acknowledge(900));
  EXPECT_EQ(sent.baseline(), (StateKey{900, 905}));
  EXPECT_FALSE(sent.acknowledge(900));
  EXPECT_FALSE(sent.acknowledge(899));
  EXPECT_TRUE(sent.acknowledge(1000));
  EXPECT_EQ(sent.unanswered(), 0u);
}

TEST(ReceivedStates, RefuseWhatTheyCannotUseAndKeepWhatTheyHave) {
  Played played("stack-10");
  StateFeed feed({});
  ReceivedStates received(Profile::kQuantised);
  played.step();
  feed.advance(played.simulation(), 0);
  const StateKey first = feed.now();
  ASSERT_EQ(received.take(feed.delta(std::nullopt)->message), "");
  const QuantisedState before = received.quantised();
  played.step(30);
  feed.advance(played.simulation(), 0);
  const StateDelta good = feed.delta(first)->message;
  StateDelta bad = good;
  bad.profile = Profile::kExact;
  EXPECT_EQ(received.take(bad), "a state of the other profile");
  bad = good;
  bad.baseline_tick = 17;
  EXPECT_EQ(received.take(bad), "a state against tick 17, which is not held here");
  bad = good;
  bad.tick = 0;
  EXPECT_EQ(received.take(bad), "a state of tick 0, here is 1 already");
  bad = good;
  bad.digest ^= 1u;
  EXPECT_EQ(received.take(bad), "a damaged state of tick 31");
  bad = good;
  bad.bytes.pop_back();
  EXPECT_EQ(received.take(bad), "a damaged state of tick 31");
  EXPECT_EQ(received.quantised(), before);
  EXPECT_EQ(received.take(good), "");
  EXPECT_EQ(received.tick(), 31u);
}

TEST(ReceivedStates, AreBoundedWhateverTheServerNames) {
  Played played("stack-10");
  StateFeed feed({Profile::kExact, {}, 0, {}});
  ReceivedStates received(Profile::kExact, {10, 32u << 20, 1u << 20, 100});
  for (int tick = 0; tick < 40; ++tick) {
    played.step();
    feed.advance(played.simulation(), 0);
    ASSERT_EQ(received.take(feed.delta(std::nullopt)->message), "");
    EXPECT_LE(received.states(), 10u);
  }
  EXPECT_EQ(received.exact(), played.encoding());
  EXPECT_TRUE(received.holds(1)) << "the server builds on it, for all that is known here";
  EXPECT_FALSE(received.holds(31));
  EXPECT_TRUE(received.holds(32));
  ReceivedStates narrow(Profile::kExact, {10, 1, 1u << 20, 100});
  ReceivedStates small(Profile::kExact, {10, 32u << 20, 100, 100});
  EXPECT_EQ(small.take(feed.delta(std::nullopt)->message), "a damaged state of tick 40");
  EXPECT_TRUE(small.empty());
  ASSERT_EQ(narrow.take(feed.delta(std::nullopt)->message), "");
  EXPECT_EQ(narrow.states(), 1u) << "the newest stays";
}

TEST(ReceivedStates, TakeASnapshotThatCameInPartsAsABaseline) {
  Played played("character-course-3d");
  Played client("character-course-3d");
  StateFeed feed({});
  played.step(50);
  feed.advance(played.simulation(), played.simulation().digest());
  const StateKey sent = feed.now();
  ASSERT_TRUE(client.simulation().decode(played.encoding()).ok());
  ReceivedStates received(Profile::kQuantised);
  received.hold(sent.tick, {}, capture(client.simulation()));
  played.step(5);
  feed.advance(played.simulation(), played.simulation().digest());
  const auto delta = feed.delta(sent);
  ASSERT_EQ(delta->message.baseline_tick, sent.tick);
  EXPECT_EQ(received.take(delta->message), "");
  EXPECT_EQ(received.quantised(), capture(played.simulation()));
}

}  // namespace
}  // namespace cycloid::protocol
