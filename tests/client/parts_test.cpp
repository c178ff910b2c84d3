#include <gtest/gtest.h>

#include "client/replica/replica.hpp"
#include "tests/client/fed.hpp"

namespace cycloid::client {
namespace {

protocol::RoomNotice rewound_to(std::uint64_t tick) {
  protocol::RoomNotice notice;
  notice.kind = protocol::NoticeKind::kRewound;
  notice.value = tick;
  return notice;
}

using ReplicaParts = Fed<Replica>;

TEST_F(ReplicaParts, FramesBetweenThePartsAreCaughtUpWithWhenTheStateIsWhole) {
  for (int i = 0; i < 40; ++i) authority_.frame();
  feed(authority_.welcome(0));
  const auto parts = parts_of(authority_.snapshot(), 1000);
  ASSERT_GT(parts.size(), 20u);
  for (const protocol::SnapshotPart& part : parts) {
    EXPECT_EQ(follower_.progress().phase, Phase::kLoading);
    feed(part);
    if (&part != &parts.back()) feed(authority_.frame());
  }
  EXPECT_EQ(follower_.progress().phase, Phase::kRunning) << follower_.progress().reason;
  EXPECT_EQ(follower_.progress().first_tick, 40u);
  EXPECT_EQ(follower_.progress().last_tick, 40 + parts.size() - 1);
  EXPECT_EQ(follower_.progress().frames, parts.size() - 1);
  EXPECT_EQ(follower_.simulation().digest(), authority_.simulation().digest());
  feed(authority_.frame());
  feed(authority_.digest());
  EXPECT_EQ(follower_.progress().digests_compared, 1u);
  EXPECT_EQ(follower_.progress().mismatches, 0u);
}

TEST_F(ReplicaParts, DigestsBetweenThePartsAreComparedAtTheirTicks) {
  feed(authority_.welcome(0));
  for (const protocol::SnapshotPart& part : parts_of(authority_.snapshot(), 4000)) {
    feed(authority_.frame());
    feed(authority_.digest());
    feed(part);
  }
  EXPECT_GT(follower_.progress().digests_compared, 5u);
  EXPECT_EQ(follower_.progress().digests_compared, follower_.progress().frames);
  EXPECT_EQ(follower_.progress().mismatches, 0u);
}

TEST_F(ReplicaParts, AStateThatBeginsAgainReplacesTheOneBefore) {
  feed(authority_.welcome(0));
  const auto first = parts_of(authority_.snapshot(), 4000);
  feed(first[0]);
  feed(first[1]);
  for (int i = 0; i < 5; ++i) feed(authority_.frame());
  for (const protocol::SnapshotPart& part : parts_of(authority_.snapshot(), 4000)) feed(part);
  EXPECT_EQ(follower_.progress().first_tick, 5u);
  EXPECT_EQ(follower_.simulation().digest(), authority_.simulation().digest());
}

TEST_F(ReplicaParts, AStateThatTakesThePlaceOfDroppedFramesIsFollowedByThoseBehindIt) {
  start();
  for (int i = 0; i < 3; ++i) feed(authority_.frame());
  for (int i = 0; i < 5; ++i) authority_.frame();  // The server has dropped them.
  const auto parts = parts_of(authority_.snapshot(), 4000);
  ASSERT_GT(parts.size(), 4u);
  for (const protocol::SnapshotPart& part : parts) {
    feed(part);
    if (part.offset == 4000 || part.offset == 8000) feed(authority_.frame());
  }
  ASSERT_EQ(follower_.progress().phase, Phase::kRunning) << follower_.progress().reason;
  EXPECT_EQ(follower_.progress().last_tick, 10u);
  EXPECT_EQ(follower_.progress().frames, 5u);
  EXPECT_EQ(follower_.digest(), authority_.simulation().digest());
  feed(authority_.frame());
  EXPECT_EQ(follower_.digest(), authority_.simulation().digest());
}

TEST_F(ReplicaParts, AJoinWhoseStateIsBegunAnewGoesOnFromTheNewOne) {
  feed(authority_.welcome(0));
  feed(parts_of(authority_.snapshot(), 4000).front());
  feed(authority_.frame());
  for (int i = 0; i < 5; ++i) authority_.frame();
  for (const protocol::SnapshotPart& part : parts_of(authority_.snapshot(), 4000)) {
    feed(part);
    if (part.offset == 4000) feed(authority_.frame());
  }
  ASSERT_EQ(follower_.progress().phase, Phase::kRunning) << follower_.progress().reason;
  EXPECT_EQ(follower_.progress().first_tick, 6u);
  EXPECT_EQ(follower_.progress().last_tick, 7u);
  EXPECT_EQ(follower_.digest(), authority_.simulation().digest());
}

TEST_F(ReplicaParts, AGapThatTheStateOnItsWayDoesNotFillEndsTheSession) {
  start();
  for (int i = 0; i < 5; ++i) authority_.frame();
  feed(parts_of(authority_.snapshot(), 4000).front());
  authority_.frame();
  feed(authority_.frame());
  expect_failed("a gap: the frame of tick 7 instead of 1");
}

TEST_F(ReplicaParts, DivergedReplicaIsMendedWhileFramesGoOn) {
  start();
  for (int i = 0; i < 10; ++i) feed(authority_.frame());
  disturb(follower_.simulation());
  feed(authority_.frame());
  feed(authority_.digest());
  ASSERT_TRUE(follower_.diverged());
  for (const protocol::SnapshotPart& part : parts_of(authority_.snapshot(), 4000)) {
    feed(authority_.frame());
    feed(part);
  }
  EXPECT_FALSE(follower_.diverged());
  EXPECT_EQ(follower_.progress().resyncs, 1u);
  EXPECT_EQ(follower_.progress().frames, authority_.simulation().tick());
  EXPECT_EQ(follower_.progress().last_tick, authority_.simulation().tick());
  EXPECT_EQ(follower_.simulation().digest(), authority_.simulation().digest());
}

TEST_F(ReplicaParts, WrongPartsEndTheSessionAndHoldNothing) {
  const auto parts = parts_of(authority_.snapshot(), 4000);
  const auto changed = [&](std::size_t at, auto change) {
    protocol::SnapshotPart part = parts[at];
    change(part);
    return part;
  };
  struct Case {
    const char* words;
    std::size_t before;  ///< Good parts ahead of the wrong one.
    protocol::SnapshotPart part;
  };
  const Case cases[] = {
      {"of 1 to 67108864", 0, changed(0, [](auto& part) { part.total_bytes = 0xffffffff; })},
      {"of 1 to 67108864", 0, changed(0, [](auto& part) { part.total_bytes = 0; })},
      {"holds 0 bytes", 0, changed(0, [](auto& part) { part.bytes.clear(); })},
      {"holds 16385 bytes", 0, changed(0, [](auto& part) { part.bytes.resize(16385); })},
      {"has not begun", 0, parts[1]},
      {"begins at byte 8000 instead of 4000", 1, parts[2]},
      {"of another state", 1, changed(1, [](auto& part) { ++part.tick; })},
      {"of another state", 1, changed(1, [](auto& part) { ++part.digest; })},
      {"of another state", 1, changed(1, [](auto& part) { ++part.total_bytes; })},
      {"ends behind", 1, changed(1, [](auto& part) { part.offset = part.total_bytes - 1; })},
      {"ends behind", 1, changed(1, [](auto& part) { part.offset = 0xffffffff; })},
      {"corrupt", parts.size() - 1,
       changed(parts.size() - 1, [](auto& part) { part.bytes.back() ^= std::byte{0xff}; })},
  };
  for (const Case& wrong : cases) {
    Replica follower(make(), options());
    Outbox out;
    follower.receive(authority_.welcome(0), out);
    for (std::size_t i = 0; i < wrong.before; ++i) follower.receive(parts[i], out);
    ASSERT_EQ(follower.progress().phase, Phase::kLoading);
    follower.receive(wrong.part, out);
    EXPECT_EQ(follower.progress().phase, Phase::kFailed) << wrong.words;
    EXPECT_NE(follower.progress().reason.find(wrong.words), std::string::npos)
        << follower.progress().reason;
  }
}

TEST_F(ReplicaParts, TheLimitOfTheOptionsIsCheckedBeforeAnythingIsKept) {
  FollowerOptions few = options();
  few.snapshot_bytes_max = 10000;
  Replica follower(make(), few);
  follower.receive(authority_.welcome(0), outbox_);
  follower.receive(parts_of(authority_.snapshot()).front(), outbox_);
  EXPECT_EQ(follower.progress().phase, Phase::kFailed);
  EXPECT_NE(follower.progress().reason.find("of 1 to 10000"), std::string::npos);
}

TEST_F(ReplicaParts, FramesThatWaitForTheStateAreBounded) {
  FollowerOptions few = options();
  few.frames_waiting_max = 10;
  Replica follower(make(), few);
  follower.receive(authority_.welcome(0), outbox_);
  for (int i = 0; i < 10; ++i) follower.receive(authority_.frame(), outbox_);
  EXPECT_EQ(follower.progress().phase, Phase::kLoading);
  follower.receive(authority_.frame(), outbox_);
  EXPECT_EQ(follower.progress().phase, Phase::kFailed);
  EXPECT_NE(follower.progress().reason.find("more than 10 frames"), std::string::npos);
}

TEST_F(ReplicaParts, RewoundMatchGoesOnFromTheExactStateOfTheEarlierTick) {
  start();
  protocol::Snapshot earlier;
  for (int i = 0; i < 30; ++i) {
    feed(authority_.frame());
    if (i == 19) earlier = authority_.snapshot();
  }
  ASSERT_TRUE(authority_.simulation().decode(earlier.state).ok());
  feed(rewound_to(20));
  EXPECT_EQ(follower_.progress().phase, Phase::kLoading);
  EXPECT_EQ(follower_.progress().last_tick, 20u);
  outbox_.clear();
  for (const protocol::SnapshotPart& part : parts_of(earlier, 10000)) {
    protocol::InputFrame frame;  // Another history than the one before.
    frame.tick = authority_.simulation().tick() + 1;
    frame.seats.resize(static_cast<std::size_t>(authority_.simulation().seats()));
    for (protocol::SeatFrame& seat : frame.seats) seat.input.axes[0] = -20000;
    std::vector<scenes::SeatInput> inputs;
    for (const protocol::SeatFrame& seat : frame.seats) inputs.push_back(seat.input);
    ASSERT_TRUE(authority_.simulation().step(inputs).ok());
    feed(frame);
    feed(part);
  }
  ASSERT_EQ(follower_.progress().phase, Phase::kRunning) << follower_.progress().reason;
  EXPECT_EQ(follower_.progress().rewinds, 1u);
  EXPECT_EQ(follower_.progress().last_tick, authority_.simulation().tick());
  EXPECT_EQ(follower_.simulation().digest(), authority_.simulation().digest());
  const auto inputs = all_of<protocol::Input>(outbox_);
  ASSERT_FALSE(inputs.empty());
  EXPECT_EQ(inputs.front().tick, authority_.simulation().tick() + 2 - (inputs.size() - 1));
}

TEST_F(ReplicaParts, AnnouncedInputDelayHoldsFromItsFrameOn) {
  start();
  feed(authority_.frame());
  outbox_.clear();
  protocol::InputFrame frame = authority_.frame();
  frame.changes.push_back({protocol::ChangeKind::kInputDelay, 5});
  feed(frame);
  const auto inputs = all_of<protocol::Input>(outbox_);
  ASSERT_FALSE(inputs.empty());
  EXPECT_EQ(inputs.front().tick, 4u);
  EXPECT_EQ(inputs.back().tick, 7u);
  protocol::InputFrame wrong = authority_.frame();
  wrong.changes.push_back({protocol::ChangeKind::kInputDelay, 100000});
  feed(wrong);
  expect_failed("changes the input delay to 100000");
}

TEST_F(ReplicaParts, WhatMySeatHasSaidIsPredictedAlsoAfterAStateThatReplacedTheWorld) {
  FollowerOptions predicting = options();
  predicting.predict_ticks = 8;
  predicting.input = [](int, std::uint64_t tick) {
    scenes::SeatInput input;
    input.axes[0] = tick % 2 == 0 ? 20000 : -20000;
    return input;
  };
  Replica follower(make(), predicting);
  protocol::Welcome welcome = authority_.welcome(0);
  welcome.input_delay_ticks = 6;
  follower.receive(welcome, outbox_);
  follower.receive(authority_.snapshot(), outbox_);
  for (int i = 0; i < 20; ++i) follower.receive(authority_.frame(), outbox_);
  follower.settle();
  protocol::InputFrame newest;
  for (const protocol::SnapshotPart& part : parts_of(authority_.snapshot(), 10000)) {
    newest = authority_.frame();
    follower.receive(newest, outbox_);
    follower.receive(part, outbox_);
  }
  follower.settle();
  ASSERT_EQ(follower.progress().phase, Phase::kRunning) << follower.progress().reason;
  scenes::Simulation& right = authority_.simulation();
  EXPECT_EQ(follower.digest(), right.digest());
  while (right.tick() < newest.tick + 6) {
    std::vector<scenes::SeatInput> inputs;
    for (const protocol::SeatFrame& seat : newest.seats) inputs.push_back(seat.input);
    inputs[0] = predicting.input(0, right.tick() + 1);
    ASSERT_TRUE(right.step(inputs).ok());
  }
  EXPECT_EQ(follower.simulation().tick(), right.tick());
  EXPECT_EQ(follower.simulation().digest(), right.digest());
}

/// Notes what it was told.
struct Watching final : Witness {
  std::vector<std::uint64_t> ticks;
  std::vector<std::uint64_t> digests;
  std::uint64_t diverged_tick = 0;
  std::uint64_t wanted_tick = 0;
  int replacements = 0;
  void confirmed(const scenes::Simulation& simulation) override {
    ticks.push_back(simulation.tick());
    digests.push_back(simulation.digest());
  }
  void replaced(const scenes::Simulation&) override { ++replacements; }
  void diverged(std::uint64_t tick, Outbox& out) override {
    diverged_tick = tick;
    out.emplace_back(protocol::TickDigests{1, digests});
  }
  void wanted(const protocol::StateWanted& wanted, Outbox&) override { wanted_tick = wanted.tick; }
};

TEST_F(ReplicaParts, WitnessSeesConfirmedStatesOnlyWhateverIsPredicted) {
  FollowerOptions predicting = options();
  predicting.predict_ticks = 8;
  const auto witness = std::make_shared<Watching>();
  predicting.witness = witness;
  Replica follower(make(), predicting);
  protocol::Welcome welcome = authority_.welcome(0);
  welcome.input_delay_ticks = 6;
  follower.receive(welcome, outbox_);
  follower.receive(authority_.snapshot(), outbox_);
  std::vector<std::uint64_t> right;
  for (std::uint64_t tick = 1; tick <= 30; ++tick) {
    follower.receive(authority_.frame(), outbox_);
    right.push_back(authority_.simulation().digest());
    follower.settle();
    EXPECT_EQ(follower.simulation().tick(), tick + 6);
  }
  EXPECT_EQ(witness->digests, right);
  EXPECT_EQ(witness->ticks.back(), 30u);
  EXPECT_EQ(witness->replacements, 1);
  follower.receive(protocol::Digest{30, 7}, outbox_);
  EXPECT_EQ(witness->diverged_tick, 30u);
  EXPECT_EQ(all_of<protocol::TickDigests>(outbox_).size(), 1u);
  follower.receive(protocol::StateWanted{9}, outbox_);
  EXPECT_EQ(witness->wanted_tick, 9u);
}

}  // namespace
}  // namespace cycloid::client
