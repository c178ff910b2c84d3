#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "protocol/state/received_states.hpp"
#include "server/room/act_budget.hpp"
#include "server/room/history.hpp"
#include "server/room/outbox.hpp"
#include "server/room/resume_tokens.hpp"
#include "server/room/snapshot_feed.hpp"
#include "tests/server/room_fixture.hpp"

namespace cycloid::server {
namespace {

constexpr std::int64_t kSecondNs = 1'000'000'000;

Shared bytes_of(std::size_t bytes) {
  return std::make_shared<const protocol::Bytes>(bytes);
}

std::shared_ptr<const ExactState> state_of(std::uint64_t tick, std::size_t bytes) {
  return std::make_shared<const ExactState>(tick, tick * 1000, protocol::Bytes(bytes));
}

TEST(ActBudget, AllowsSoManyWithinAnySpan) {
  ActBudget budget(3, std::chrono::seconds(10));
  EXPECT_TRUE(budget.take(0));
  EXPECT_TRUE(budget.take(4 * kSecondNs));
  EXPECT_TRUE(budget.take(9 * kSecondNs));
  EXPECT_FALSE(budget.take(10 * kSecondNs - 1));
  EXPECT_TRUE(budget.take(10 * kSecondNs)) << "the first is out of it";
  EXPECT_FALSE(budget.take(13 * kSecondNs));
  budget.set_bounds(4, std::chrono::seconds(10));
  EXPECT_TRUE(budget.take(13 * kSecondNs));
  EXPECT_FALSE(budget.take(13 * kSecondNs)) << "what was done before the change counts";
}

TEST(Outbox, IsBoundedInBytesAndRefusesWithoutChange) {
  Outbox outbox(100);
  EXPECT_TRUE(outbox.push_frame(bytes_of(60), 1));
  EXPECT_FALSE(outbox.push_control(bytes_of(41), 2));
  EXPECT_EQ(outbox.bytes(), 60u);
  EXPECT_TRUE(outbox.push_control(bytes_of(40), 3));
  outbox.push_last(bytes_of(1000));
  std::uint32_t parts = 8;
  const auto output = outbox.take(parts);
  ASSERT_EQ(output.size(), 3u);
  EXPECT_EQ(output[2]->size(), 1000u) << "the last word is last, whatever its size";
  EXPECT_EQ(outbox.bytes(), 0u);
  EXPECT_FALSE(outbox.has_output(8));
}

TEST(Outbox, FramesThatAStateTakesThePlaceOfLeaveTheirRoom) {
  Outbox outbox(100);
  for (std::uint64_t tick = 5; tick < 10; ++tick) {
    ASSERT_TRUE(outbox.push_frame(bytes_of(60), 1)) << tick;
    outbox.begin_state(state_of(tick, 10));
    EXPECT_EQ(outbox.bytes(), 0u);
  }
}

TEST(Outbox, AStateTakesThePlaceOfFramesAndComesBetweenThem) {
  Outbox outbox(1000);
  ASSERT_TRUE(outbox.push_frame(bytes_of(1), 1));
  ASSERT_TRUE(outbox.push_control(bytes_of(2), 1));
  outbox.begin_state(state_of(5, 5 * protocol::kSnapshotPartBytesMax));
  ASSERT_TRUE(outbox.push_frame(bytes_of(3), 2));
  std::uint32_t parts = 2;
  auto output = outbox.take(parts);
  EXPECT_EQ(parts, 0u);
  ASSERT_EQ(output.size(), 4u);
  EXPECT_EQ(output[0]->size(), 2u) << "what was said before it";
  EXPECT_GT(output[1]->size(), protocol::kSnapshotPartBytesMax);
  EXPECT_EQ(output[3]->size(), 3u);
  EXPECT_FALSE(outbox.has_output(parts)) << "its share of this tick is gone";
  EXPECT_TRUE(outbox.has_output(1));
  outbox.replace_snapshot(bytes_of(7));
  parts = 2;
  EXPECT_EQ(outbox.take(parts).size(), 2u) << "the snapshot differs from a state that is not there";
  parts = 2;
  output = outbox.take(parts);
  ASSERT_EQ(output.size(), 2u);
  EXPECT_EQ(output[1]->size(), 7u);
  EXPECT_EQ(parts, 1u);
}

// A state that begins anew in a tick whose share of parts is gone: a frame of a tick after it would
// come to who has nothing that it continues.
TEST(Outbox, WhatFollowsAStateWaitsForItsFirstPart) {
  Outbox outbox(1000);
  outbox.begin_state(state_of(5, 5 * protocol::kSnapshotPartBytesMax));
  std::uint32_t parts = 2;
  EXPECT_EQ(outbox.take(parts).size(), 2u);
  ASSERT_TRUE(outbox.push_control(bytes_of(2), 1));
  outbox.begin_state(state_of(6, 2 * protocol::kSnapshotPartBytesMax));
  ASSERT_TRUE(outbox.push_frame(bytes_of(3), 2));
  ASSERT_TRUE(outbox.has_output(parts));
  auto output = outbox.take(parts);
  ASSERT_EQ(output.size(), 1u);
  EXPECT_EQ(output[0]->size(), 2u) << "what was said before it";
  EXPECT_FALSE(outbox.has_output(parts));
  EXPECT_EQ(outbox.bytes(), 3u);
  EXPECT_EQ(outbox.oldest_frame_ns(), 2);
  parts = 1;
  output = outbox.take(parts);
  ASSERT_EQ(output.size(), 2u);
  EXPECT_GT(output[0]->size(), protocol::kSnapshotPartBytesMax);
  EXPECT_EQ(output[1]->size(), 3u) << "once it has begun, frames go on between its parts";
  EXPECT_EQ(outbox.bytes(), 0u);
}

TEST(Outbox, KnowsItsOldestFrameAndNotItsOldestWord) {
  Outbox outbox(1000);
  ASSERT_TRUE(outbox.push_control(bytes_of(1), 5));
  EXPECT_FALSE(outbox.oldest_frame_ns());
  ASSERT_TRUE(outbox.push_frame(bytes_of(1), 9));
  ASSERT_TRUE(outbox.push_frame(bytes_of(1), 10));
  EXPECT_EQ(outbox.oldest_frame_ns(), 9);
}

TEST(KeyframeRing, KeepsToItsBudgetButForWhatIsNeeded) {
  KeyframeRing ring(1000);
  for (std::uint64_t tick = 0; tick <= 500; tick += 10) ring.push(state_of(tick, 300), tick);
  EXPECT_EQ(ring.size(), 3u);
  EXPECT_EQ(ring.bytes(), 900u);
  EXPECT_EQ(ring.at_or_before(495)->tick(), 490u);
  EXPECT_EQ(ring.at_or_before(479), nullptr);
  for (std::uint64_t tick = 510; tick <= 600; tick += 10) ring.push(state_of(tick, 300), 523);
  EXPECT_EQ(ring.at_or_before(523)->tick(), 520u) << "over the budget, and needed";
  EXPECT_EQ(ring.at_or_before(519), nullptr);
  ring.drop_after(570);
  EXPECT_EQ(ring.at_or_before(600)->tick(), 570u);
  ring.drop_before(560);
  EXPECT_EQ(ring.size(), 2u);
  EXPECT_EQ(ring.bytes(), 600u);
}

TEST(FrameRing, FindsTheLastTicksAndNoOther) {
  FrameRing ring(10);
  EXPECT_EQ(ring.find(1), nullptr);
  for (std::uint64_t tick = 1; tick <= 25; ++tick) {
    protocol::InputFrame frame;
    frame.tick = tick;
    ring.push({frame, tick, false});
  }
  EXPECT_EQ(ring.find(15), nullptr);
  EXPECT_EQ(ring.find(26), nullptr);
  for (std::uint64_t tick = 16; tick <= 25; ++tick) EXPECT_EQ(ring.find(tick)->digest, tick);
  ring.drop_after(20);
  EXPECT_EQ(ring.find(21), nullptr);
  EXPECT_EQ(ring.size(), 5u);
}

TEST(ResumeTokens, AreGoodForOneSeatOnce) {
  ResumeTokens tokens(3);
  ResumeSecret first{};
  ResumeSecret second{};
  first.fill(std::byte{1});
  second.fill(std::byte{2});
  EXPECT_FALSE(tokens.find(ResumeSecret{})) << "no secret is the secret of no seat";
  tokens.give(1, first);
  EXPECT_EQ(tokens.find(first), 1u);
  for (std::size_t byte = 0; byte < first.size(); ++byte) {
    ResumeSecret wrong = first;
    wrong[byte] ^= std::byte{0x80};
    EXPECT_FALSE(tokens.find(wrong)) << byte;
  }
  EXPECT_FALSE(tokens.find(std::span(first).first(31)));
  tokens.rotate(1, second, first);
  EXPECT_EQ(tokens.find(second), 1u);
  EXPECT_EQ(tokens.find(first), 1u) << "until the second is known to have come";
  tokens.confirm(1);
  EXPECT_FALSE(tokens.find(first));
  tokens.forget(1);
  EXPECT_FALSE(tokens.find(second));
}

TEST(InputWindow, RepeatsTheLastInputThatCountedWhoeverWasConnectedThen) {
  const InputPolicy policy;
  scenes::SeatInput first;
  first.axes[0] = 100;
  scenes::SeatInput second;
  second.axes[0] = 200;
  InputWindow window;
  window.say(0, 1, first);
  window.say(0, 2, second);
  EXPECT_EQ(window.close(1, policy).input, first);
  // The connection is lost, and its holder is back before another tick is missed.
  EXPECT_EQ(window.close_lost(2).origin, protocol::Origin::kGiven);
  const protocol::SeatFrame repeated = window.close(3, policy);
  EXPECT_EQ(repeated.origin, protocol::Origin::kRepeated);
  EXPECT_EQ(repeated.input, second);
  // Nobody steers by what was said before a tick that was missed.
  EXPECT_EQ(window.close_lost(4).origin, protocol::Origin::kNeutral);
  EXPECT_EQ(window.close(5, policy).origin, protocol::Origin::kAbsent);
}

class RoomSnapshots : public RoomTest {};

TEST_F(RoomSnapshots, DifferFromWhatTheClientHasAcknowledged) {
  open();
  run(1);
  const PeerId id = join(0, protocol::Mode::kSnapshot);
  const auto welcome = hear(id);
  ASSERT_EQ(only<protocol::SnapshotPart>(welcome).size(), 1u);
  EXPECT_EQ(only<protocol::SnapshotPart>(welcome)[0].tick, 1u);
  run(2);
  EXPECT_EQ(only<protocol::StateDelta>(hear(id))[0].baseline_tick, 0u);
  say(id, protocol::Ack{1});
  run(3);
  EXPECT_EQ(only<protocol::StateDelta>(hear(id))[0].baseline_tick, 1u) << "that of its join counts";
  say(id, protocol::Ack{6});
  say(id, protocol::Ack{3});
  run(3);
  auto delta = only<protocol::StateDelta>(hear(id))[0];
  EXPECT_EQ(delta.tick, 9u);
  EXPECT_EQ(delta.baseline_tick, 6u) << "an older one, said later, is no step back";
  run(200);
  delta = only<protocol::StateDelta>(hear(id))[0];
  EXPECT_EQ(delta.baseline_tick, 0u) << "what nobody acknowledges for 3 s is not kept";
  say(id, protocol::Ack{room_->tick() + 1});
  EXPECT_EQ(refusal(id).reason, "an acknowledgement of tick 210, the last made is 209");
}

/// A client of either profile that acknowledges what it gets decodes every snapshot.
TEST_F(RoomSnapshots, AreReadByAClientOfEitherProfile) {
  open();
  run(1);
  const PeerId player = enter(1);
  std::map<PeerId, protocol::ReceivedStates> received;
  std::map<PeerId, std::uint64_t> deltas;
  for (const auto profile : {protocol::Profile::kExact, protocol::Profile::kQuantised}) {
    const PeerId id = room_->connect();
    protocol::Hello greeting = hello(protocol::kSpectator);
    greeting.mode = protocol::Mode::kSnapshot;
    greeting.profile = profile;
    say(id, greeting);
    const auto parts = only<protocol::SnapshotPart>(hear(id));
    ASSERT_EQ(parts.size(), 1u);
    scenes::Simulation simulation = simulation_of(scene_);
    ASSERT_TRUE(simulation.decode(parts[0].bytes).ok());
    received.try_emplace(id, profile);
    received.at(id).hold(parts[0].tick, parts[0].bytes, protocol::capture(simulation));
    say(id, protocol::Ack{parts[0].tick});
  }
  for (int tick = 0; tick < 150; ++tick) {
    say(player, protocol::Input{room_->tick() + 1, push(tick * 200)});
    run(1);
    (void)hear(player);
    for (auto& [id, states] : received) {
      for (const auto& delta : only<protocol::StateDelta>(hear(id))) {
        EXPECT_EQ(states.take(delta), "");
        ++deltas[id];
        EXPECT_NE(delta.baseline_tick, 0u);
        if (tick % 7 != 0) say(id, protocol::Ack{delta.tick});
      }
    }
  }
  for (const auto& [id, count] : deltas) EXPECT_GE(count, 49u);
  EXPECT_EQ(deltas.size(), 2u);
}

// A client says its inputs for the ticks that it is shown: one who hears nothing says nothing, and
// then nothing wakes the world up.
TEST_F(RoomSnapshots, OfAWorldAtRestAreForWhoHasASeat) {
  open();
  std::map<PeerId, std::size_t> heard;
  for (const std::int32_t seat : {0, protocol::kSpectator}) {
    const PeerId id = room_->connect();
    protocol::Hello greeting = hello(seat);
    greeting.mode = protocol::Mode::kSnapshot;
    greeting.profile = protocol::Profile::kQuantised;
    say(id, greeting);
    say(id, protocol::Ack{only<protocol::SnapshotPart>(hear(id)).at(0).tick});
    heard[id] = 0;
  }
  for (int tick = 0; tick < 200; ++tick) {
    run(1);
    for (auto& [id, count] : heard) {
      for (const auto& delta : only<protocol::StateDelta>(hear(id))) {
        count += tick < 170 ? 0 : 1;
        say(id, protocol::Ack{delta.tick});
      }
    }
  }
  EXPECT_EQ(heard.begin()->second, 10u) << "one every 3 ticks";
  EXPECT_EQ(heard.rbegin()->second, 0u);
}

TEST_F(RoomSnapshots, AreMadeOnceForAll) {
  Limits limits;
  limits.keyframe_ticks = 1'000'000;
  open(limits);
  std::vector<PeerId> ids;
  for (int i = 0; i < 100; ++i)
    ids.push_back(join(protocol::kSpectator, protocol::Mode::kSnapshot));
  for (const PeerId id : ids) (void)hear(id);
  const std::uint64_t before = room_->statistics().encodes;
  for (int tick = 0; tick < 30; ++tick) {
    run(1);
    for (const PeerId id : ids) (void)hear(id);
  }
  EXPECT_EQ(room_->statistics().encodes - before, 10u) << "one every 3 ticks, whoever gets it";
}

}  // namespace
}  // namespace cycloid::server
