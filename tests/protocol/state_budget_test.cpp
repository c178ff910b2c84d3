#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <map>
#include <random>

#include "protocol/state/priority.hpp"
#include "protocol/state/quantised_delta.hpp"
#include "tests/protocol/state_scenes.hpp"

namespace cycloid::protocol {
namespace {

using states::Played;

/// So many bodies in a row, at rest.
HeldState row_of(std::uint32_t count) {
  HeldState held;
  for (std::uint32_t i = 0; i < count; ++i) {
    QuantisedBody body;
    body.index = i;
    body.position[0] = static_cast<std::int32_t>(1000 * i);
    body.rotation.largest = 3;
    held.state.bodies.push_back(body);
  }
  return held;
}

/// The bodies that are shown as they are.
std::vector<std::uint32_t> right_bodies(const QuantisedState& held, const QuantisedState& now) {
  std::vector<std::uint32_t> right;
  for (const QuantisedBody& body : now.bodies)
    if (std::find(held.bodies.begin(), held.bodies.end(), body) != held.bodies.end())
      right.push_back(body.index);
  return right;
}

TEST(StateBudget, OfAnySizeIsHonouredAndHeldIsWhatIsRead) {
  std::mt19937 random(31);
  Played played("ball-pit-3d");
  played.step(20);
  played.kick_all(3.0f, random);
  HeldState held{capture(played.simulation()), {}};
  for (int tick = 0; tick < 60; ++tick) {
    played.step();
    const QuantisedState now = capture(played.simulation());
    const std::size_t budget = kBudgetBytesMin + random() % 500;
    QuantisedDelta made = encode_quantised(&held, now, budget);
    ASSERT_LE(made.bytes.size(), budget);
    // What it leaves unused is less than the next change takes.
    if (!made.held.waiting.empty()) {
      EXPECT_GE(made.bytes.size() + 24, budget);
    }
    const auto read = decode_quantised(&held.state, now.tick, made.bytes, 4096);
    ASSERT_TRUE(read);
    ASSERT_EQ(*read, made.held.state);
    held = std::move(made.held);
  }
}

TEST(StateBudget, FromNothingBringsAWorldPieceByPiece) {
  Played played("cubes-901");
  const QuantisedState now = capture(played.simulation());
  QuantisedDelta made = encode_quantised(nullptr, now, 300);
  ASSERT_LE(made.bytes.size(), 300u);
  auto client = decode_quantised(nullptr, now.tick, made.bytes, 4096);
  int deltas = 1;
  while (!made.held.waiting.empty()) {
    ASSERT_TRUE(client);
    ASSERT_EQ(*client, made.held.state);
    const HeldState held = made.held;
    made = encode_quantised(&held, now, 300);
    ASSERT_LE(made.bytes.size(), 300u);
    client = decode_quantised(&*client, now.tick, made.bytes, 4096);
    ASSERT_LT(++deltas, 50);
  }
  EXPECT_EQ(*client, now);
  EXPECT_GT(deltas, 2);
}

TEST(StateBudget, TheSmallestBringsOneOfTheCostliestChanges) {
  // Everything about one body of many is as unlikely as it can be.
  const HeldState held = row_of(10'000);
  QuantisedState now = held.state;
  now.tick = 1;
  QuantisedBody& body = now.bodies[7777];
  body.generation = 0x80000000u;
  body.position = {INT32_MIN, INT32_MAX, INT32_MIN};
  body.rotation = {0, {kRotationParts, -kRotationParts, kRotationParts}};
  body.velocity = {INT16_MIN, INT16_MAX, INT16_MIN};
  body.spin = body.velocity;
  body.at_rest = true;
  EXPECT_LE(encode_quantised(&held, now, 1u << 20).bytes.size(), kBudgetBytesMin);
  EXPECT_EQ(encode_quantised(&held, now, 0).held.state, now);
}

TEST(StateBudget, GoesToWhatIsMostWrong) {
  const HeldState held = row_of(400);
  QuantisedState now = held.state;
  now.tick = 1;
  std::mt19937 random(33);
  for (QuantisedBody& body : now.bodies)
    for (std::int32_t& steps : body.position) steps += static_cast<std::int32_t>(random() % 16);
  for (const std::uint32_t far : {17u, 101u, 180u}) now.bodies[far].position[2] += 5000;
  now.bodies[60].rotation.parts[1] = 200;
  const QuantisedDelta made = encode_quantised(&held, now, kBudgetBytesMin);
  ASSERT_FALSE(made.held.waiting.empty());
  const std::vector<std::uint32_t> right = right_bodies(made.held.state, now);
  for (const std::uint32_t first : {17u, 60u, 101u, 180u})
    EXPECT_TRUE(std::binary_search(right.begin(), right.end(), first)) << first;
}

TEST(StateBudget, GoesToWhatAppearsAndVanishesBeforeWhatMoves) {
  const HeldState held = row_of(200);
  QuantisedState now = held.state;
  now.tick = 1;
  for (QuantisedBody& body : now.bodies) body.position[1] += 30'000;
  now.bodies.erase(now.bodies.begin() + 50);
  now.bodies[120].generation = 9;
  QuantisedBody fresh;
  fresh.index = 900;
  now.bodies.push_back(fresh);
  const QuantisedState made = encode_quantised(&held, now, kBudgetBytesMin).held.state;
  const std::vector<std::uint32_t> right = right_bodies(made, now);
  EXPECT_TRUE(std::binary_search(right.begin(), right.end(), now.bodies[120].index));
  EXPECT_TRUE(std::binary_search(right.begin(), right.end(), 900u));
  EXPECT_TRUE(std::none_of(made.bodies.begin(), made.bodies.end(),
                           [](const QuantisedBody& body) { return body.index == 50; }));
}

TEST(StateBudget, TheSmallestErrorIsNotForgottenBehindGreatOnes) {
  HeldState held = row_of(200);
  QuantisedState now = held.state;
  std::mt19937 random(34);
  now.bodies[70].position[0] += 1;
  for (std::uint64_t tick = 1; tick <= kWaitTicksMax + 8; ++tick) {
    now.tick = tick;
    for (QuantisedBody& body : now.bodies)
      if (body.index != 70)
        body.position[1] = static_cast<std::int32_t>(100'000 + random() % 100'000);
    held = encode_quantised(&held, now, 400).held;
    if (held.state.bodies[70] == now.bodies[70]) {
      // By its error alone it would have waited on.
      EXPECT_GE(tick, kWaitTicksMax);
      return;
    }
  }
  FAIL() << "it waits for ever";
}

TEST(StateBudget, ErrorThatAccumulatesOvertakesOneThatIsNew) {
  HeldState held = row_of(2);
  QuantisedState now = held.state;
  now.tick = 100;
  held.state.tick = 99;
  now.bodies[0].position[0] += 40;
  now.bodies[1].position[0] += 50;
  EXPECT_EQ(changes_by_urgency(held, now)[0].what.index, 1u);
  held.waiting = {{1, 0, 10}};
  EXPECT_EQ(changes_by_urgency(held, now)[0].what.index, 0u);
}

/// Every client's delta is based on the one before it that came through, `delay` ticks ago.
struct Starving {
  std::size_t budget = 0;
  int delay = 1;
  int loss_percent = 0;
};

/// Plays a world where all moves and gives the longest time that any body was wrong, beside the
/// bound that encode_quantised states.
void expect_no_starvation(const Starving& starving) {
  std::mt19937 random(32);
  Played played("ball-pit-3d");
  played.step(20);
  HeldState base{capture(played.simulation()), {}};
  std::map<std::uint32_t, std::uint64_t> right_at;
  for (const QuantisedBody& body : base.state.bodies) right_at[body.index] = base.state.tick;
  std::size_t most_changes = 0;
  std::size_t least_sent = SIZE_MAX;
  std::uint64_t longest = 0;
  int lost = 0;
  for (int tick = 0; tick < 240; ++tick) {
    if (tick % 60 == 0) played.kick_all(2.0f, random);
    played.step();
    if (tick % starving.delay != 0) continue;
    const QuantisedState now = capture(played.simulation());
    QuantisedDelta made = encode_quantised(&base, now, starving.budget);
    ASSERT_LE(made.bytes.size(), starving.budget);
    if (static_cast<int>(random() % 100) < starving.loss_percent) {
      ++lost;
      continue;
    }
    const std::size_t changes = changes_by_urgency(base, now).size();
    most_changes = std::max(most_changes, changes);
    if (!made.held.waiting.empty())
      least_sent = std::min(least_sent, changes - made.held.waiting.size());
    base = std::move(made.held);
    for (const std::uint32_t index : right_bodies(base.state, now)) right_at[index] = now.tick;
    for (const auto& [index, at] : right_at) longest = std::max(longest, now.tick - at);
  }
  ASSERT_LT(least_sent, most_changes) << "the budget did not bind";
  ASSERT_GE(least_sent, 1u);
  const auto delay = static_cast<std::uint64_t>(starving.delay);
  const std::uint64_t rounds = (most_changes + least_sent - 1) / least_sent + 1;
  const std::uint64_t bound = kWaitTicksMax + delay * (rounds + static_cast<std::uint64_t>(lost));
  EXPECT_LE(longest, bound);
  std::printf(
      "budget %zu, %d ticks, %d lost: up to %zu changes, at least %zu sent; wrong for at "
      "most %llu ticks of %llu\n",
      starving.budget, starving.delay, lost, most_changes, least_sent,
      static_cast<unsigned long long>(longest), static_cast<unsigned long long>(bound));
}

TEST(StateBudget, StarvesNoBody) {
  expect_no_starvation({256, 1, 0});
  expect_no_starvation({96, 1, 0});
  expect_no_starvation({200, 3, 0});
  expect_no_starvation({200, 2, 20});
}

}  // namespace
}  // namespace cycloid::protocol
