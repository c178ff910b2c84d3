#include <gtest/gtest.h>

#include "tests/server/room_fixture.hpp"

namespace cycloid::server {
namespace {

using protocol::EventKind;
using Events = std::vector<protocol::FrameEvent>;

class RoomRewind : public RoomTest {};

TEST_F(RoomRewind, TheMatchGoesOnFromTheTickAndAllClientsWithIt) {
  open();
  const PeerId player = join(0);
  const PeerId viewer = join(protocol::kSpectator, protocol::Mode::kSnapshot);
  Mirror mirror(scene_);
  Mirror view(scene_);
  for (std::uint64_t tick = 1; tick <= 200; ++tick) {
    say(player, protocol::Input{tick, push(static_cast<int>(tick) * 100)});
    run(1);
    mirror.take(hear(player));
    view.take(hear(viewer));
  }
  const std::int64_t before = now_;
  ASSERT_TRUE(room_->rewind(130));
  EXPECT_EQ(room_->tick(), 130u);
  EXPECT_EQ(room_->digest(), log_.ticks[129].digest);
  ASSERT_EQ(log_.branches.size(), 1u);
  EXPECT_EQ(log_.branches[0].tick, 130u);
  EXPECT_EQ(log_.branches[0].digest, log_.ticks[129].digest);
  scenes::Simulation branch = simulation_of(scene_);
  ASSERT_TRUE(branch.decode(log_.branches[0].state).ok());
  EXPECT_EQ(branch.digest(), log_.branches[0].digest);

  say(player, protocol::Digest{180, mirror.digests[180]});
  EXPECT_FALSE(room_->wants_close(player)) << "it has not heard of it yet";
  const auto messages = hear(player);
  const auto notices = only<protocol::RoomNotice>(messages);
  ASSERT_EQ(notices.size(), 1u);
  EXPECT_EQ(notices[0].kind, protocol::NoticeKind::kRewound);
  EXPECT_EQ(notices[0].value, 130u);
  mirror.take(messages);
  EXPECT_EQ(mirror.simulation.tick(), 130u);
  view.take(hear(viewer));
  EXPECT_EQ(view.simulation.tick(), 130u);

  run(100);
  EXPECT_EQ(room_->tick(), 230u);
  EXPECT_NEAR(static_cast<double>(now_ - before), 100.0 * kTickNs, 2.0 * kTickNs);
  EXPECT_EQ(room_->statistics().catch_up_ticks, 0u);
  mirror.take(hear(player));
  EXPECT_EQ(mirror.simulation.digest(), room_->digest());
  say(player, protocol::Digest{200, mirror.digests[200]});
  EXPECT_EQ(room_->statistics().desyncs, 0u);
  view.take(hear(viewer));
  EXPECT_EQ(log_.ticks[200].frame.tick, 131u) << "the log goes on with its branch";
  EXPECT_NE(log_.ticks[220].digest, log_.ticks[150].digest) << "without the inputs of the other";
}

TEST_F(RoomRewind, WhatIsNotKeptIsRefusedAndNothingChanges) {
  Limits limits;
  limits.frames_kept_max = 30;
  limits.keyframe_ticks = 10;
  open(limits);
  run(100);
  const std::uint64_t digest = room_->digest();
  EXPECT_FALSE(room_->rewind(100)) << "it is there";
  EXPECT_FALSE(room_->rewind(101));
  EXPECT_FALSE(room_->rewind(60));
  EXPECT_FALSE(room_->rewind(70)) << "its state is kept, but not the frame that made it";
  EXPECT_EQ(room_->tick(), 100u);
  EXPECT_EQ(room_->digest(), digest);
  EXPECT_TRUE(log_.branches.empty());
  EXPECT_TRUE(room_->rewind(75));
  EXPECT_TRUE(room_->rewind(74)) << "and from there again";
  EXPECT_EQ(room_->digest(), log_.ticks[73].digest);
}

TEST_F(RoomRewind, EventsLeadFromWhoSatThereThenToWhoSitsThereNow) {
  open();
  const PeerId stays = enter(0);
  run(5);
  const PeerId leaves = enter(1);
  run(5);
  say(leaves, protocol::Bye{"enough"});
  run(5);
  (void)enter(1);
  run(5);
  ASSERT_TRUE(room_->rewind(8));
  run(1);
  EXPECT_EQ(log_.ticks[20].frame.tick, 9u);
  EXPECT_EQ(log_.ticks[20].frame.events, (Events{{EventKind::kLeave, 1}, {EventKind::kJoin, 1}}));
  ASSERT_EQ(log_.ticks[20].frame.changes.size(), 1u);
  ASSERT_TRUE(room_->rewind(3));
  run(1);
  EXPECT_EQ(log_.ticks[21].frame.events, (Events{{EventKind::kJoin, 1}}));
  EXPECT_EQ(room_->seats()[0].holder, stays);
}

TEST_F(RoomRewind, IsTheSameMatchAgainWhereTheInputsAre) {
  open();
  const PeerId id = enter(0);
  const auto play = [&](std::uint64_t from, std::uint64_t to) {
    for (std::uint64_t tick = from; tick <= to; ++tick) {
      say(id, protocol::Input{tick, push(static_cast<int>(tick % 11) * 900)});
      run(1);
      (void)hear(id);
    }
  };
  play(1, 150);
  const std::uint64_t digest = room_->digest();
  ASSERT_TRUE(room_->rewind(77));
  play(78, 150);
  EXPECT_EQ(room_->digest(), digest);
}

TEST_F(RoomRewind, TheOldestTickIsTheFirstWhoseFrameIsKept) {
  Limits limits;
  limits.frames_kept_max = 30;
  limits.keyframe_ticks = 10;
  open(limits);
  run(107);  // Keeps the frames from 78 on, and the states of 80, 90 and 100.
  for (std::uint64_t tick = 69; tick < 80; ++tick) EXPECT_FALSE(room_->rewind(tick)) << tick;
  ASSERT_TRUE(room_->rewind(80));
  EXPECT_EQ(room_->digest(), log_.ticks[79].digest);
  ASSERT_EQ(log_.branches.size(), 1u);
  EXPECT_EQ(log_.branches[0].tick, 80u);
}

TEST_F(RoomRewind, WithoutADelayNoMoreFramesAreKeptThanTheBoundSays) {
  Limits limits;
  limits.frames_kept_max = 30;
  limits.keyframe_ticks = 20;
  open(limits);
  run(100);  // Keeps the frames from 71 on, and the states of 80 and 100.
  EXPECT_FALSE(room_->rewind(75)) << "the frames from 61 on would lead there";
  EXPECT_TRUE(room_->rewind(85));
}

class RoomBranches : public RoomTest {
 protected:
  /// Plays, and lets the mirror hear; both branches have inputs of their own.
  void play(PeerId id, std::uint64_t to, int force) {
    while (room_->tick() < to) {
      say(id, protocol::Input{room_->tick() + 1, push(force + static_cast<int>(room_->tick()))});
      run(1);
      mirror_->take(hear(id));
    }
  }
  void open_with_mirror() {
    resumable_ = true;
    open();
    mirror_.emplace(scene_);
  }
  /// Joins seat 0 and plays up to a tick.
  PeerId player(std::uint64_t to) {
    const PeerId id = join(0);
    const auto greeting = hear(id);
    secret_ = only<protocol::Welcome>(greeting)[0].resume;
    mirror_->take(greeting);
    play(id, to, 9000);
    return id;
  }
  /// Comes back with the state that it had after a tick; what it is answered.
  std::vector<protocol::ServerMessage> come_back(std::uint64_t tick) {
    const PeerId id = room_->connect();
    protocol::Hello greeting = hello(0);
    greeting.resume = secret_;
    say(id, greeting);
    say(id, protocol::Ack{tick});
    return hear(id);
  }

  std::optional<Mirror> mirror_;
  std::vector<std::byte> secret_;
};

TEST_F(RoomBranches, ADigestOfATickThatWasTakenBackIsNoDesync) {
  open_with_mirror();
  const PeerId id = player(200);
  ASSERT_TRUE(room_->rewind(190));
  const auto on_its_way = hear(id);  // The client has not heard of it yet.
  run(20);
  ASSERT_NE(log_.ticks[209].digest, mirror_->digests[200]) << "tick 200 of the new branch differs";
  say(id, protocol::Digest{200, mirror_->digests[200]});
  EXPECT_EQ(room_->statistics().desyncs, 0u);
  EXPECT_FALSE(room_->wants_close(id));

  mirror_->take(on_its_way);
  play(id, 230, 100);
  say(id, protocol::Digest{230, mirror_->digests[230]});
  EXPECT_EQ(room_->statistics().desyncs, 0u);
  say(id, protocol::Digest{201, 0xbad});
  EXPECT_EQ(room_->statistics().desyncs, 1u) << "what was never taken back is compared as ever";
}

TEST_F(RoomBranches, ADigestOfATickThatWasTakenBackBeforeIsNoDesyncEither) {
  open_with_mirror();
  const PeerId id = player(200);
  ASSERT_TRUE(room_->rewind(100));
  (void)hear(id);
  run(20);
  ASSERT_TRUE(room_->rewind(110));
  (void)hear(id);
  run(95);
  ASSERT_NE(log_.ticks.back().digest, mirror_->digests[200]);
  say(id, protocol::Digest{200, mirror_->digests[200]});
  EXPECT_EQ(room_->statistics().desyncs, 0u);
}

TEST_F(RoomBranches, WhoComesBackWithATickThatWasTakenBackBeforeIsGivenTheState) {
  open_with_mirror();
  room_->disconnect(player(105));
  run(95);
  ASSERT_TRUE(room_->rewind(100));
  run(50);
  ASSERT_TRUE(room_->rewind(130));
  run(10);
  mirror_->take(come_back(105));
  EXPECT_EQ(mirror_->states, 2u) << "when it joined, and now";
  EXPECT_EQ(mirror_->simulation.tick(), 140u);
  EXPECT_EQ(mirror_->simulation.digest(), room_->digest());
}

TEST_F(RoomBranches, NoStateThatWasTakenBackIsGoneOnFrom) {
  Limits limits;
  limits.keyframe_ticks = 10;
  open(limits);
  mirror_.emplace(scene_);
  const PeerId id = player(45);
  ASSERT_TRUE(room_->rewind(5));
  mirror_->take(hear(id));
  play(id, 35, 100);
  ASSERT_TRUE(room_->rewind(33));
  EXPECT_EQ(room_->digest(), mirror_->digests[33]);
}

TEST_F(RoomBranches, WhoComesBackWithATickThatWasTakenBackIsGivenTheState) {
  for (const std::uint64_t lost : {120u, 150u}) {
    open_with_mirror();
    const PeerId id = player(lost);
    room_->disconnect(id);
    run(160 - static_cast<int>(lost));
    ASSERT_TRUE(room_->rewind(130));
    run(170);
    const auto messages = come_back(lost);
    const bool has_state = !only<protocol::SnapshotPart>(messages).empty();
    EXPECT_EQ(has_state, lost > 130) << "tick " << lost;
    mirror_->take(messages);
    EXPECT_EQ(mirror_->simulation.tick(), 300u);
    EXPECT_EQ(mirror_->simulation.digest(), room_->digest()) << "lost after tick " << lost;
  }
}

// Who is welcome with the tick of the state that it holds takes that state for the server's.
TEST_F(RoomBranches, WhoseStateIsOfAnotherBranchIsNotWelcomedWithItsTick) {
  for (const bool says_so_in_time : {true, false}) {
    open_with_mirror();
    const PeerId lost = player(150);
    room_->disconnect(lost);
    run(10);
    ASSERT_TRUE(room_->rewind(130));
    run(20);
    ASSERT_NE(room_->digest(), mirror_->digests[150]);
    const PeerId id = room_->connect();
    protocol::Hello greeting = hello(0);
    greeting.resume = secret_;
    say(id, greeting);
    if (says_so_in_time) say(id, protocol::Ack{150});
    const auto messages = hear(id);
    if (!says_so_in_time) say(id, protocol::Ack{150});
    EXPECT_EQ(only<protocol::Welcome>(messages).at(0).tick, 130u);
    EXPECT_EQ(only<protocol::SnapshotPart>(messages).at(0).tick, 150u);
    mirror_->take(messages);
    run(5);
    mirror_->take(hear(id));
    EXPECT_EQ(mirror_->simulation.digest(), room_->digest());
  }
}

TEST_F(RoomBranches, NoSnapshotDiffersFromAStateThatWasTakenBack) {
  open();
  const PeerId id = enter(protocol::kSpectator, protocol::Mode::kSnapshot);
  run(150);
  (void)hear(id);
  ASSERT_TRUE(room_->rewind(130));
  (void)hear(id);
  run(23);
  EXPECT_EQ(only<protocol::StateDelta>(hear(id)).back().tick, 153u);
  say(id, protocol::Ack{150});  // Said before it had heard of the rewind.
  run(3);
  const auto deltas = only<protocol::StateDelta>(hear(id));
  ASSERT_EQ(deltas.size(), 1u);
  EXPECT_NE(deltas[0].baseline_tick, 150u);
  say(id, protocol::Ack{156});
  run(3);
  EXPECT_EQ(only<protocol::StateDelta>(hear(id))[0].baseline_tick, 156u);
}

/// A client of snapshots that takes in and acknowledges all that it hears.
struct Taker {
  std::uint64_t tick = 0;
  std::uint64_t baseline_tick = 0;  ///< Of the last delta.

  /// @returns what it says.
  std::vector<protocol::Ack> take(const std::vector<protocol::ServerMessage>& messages) {
    std::vector<protocol::Ack> said;
    for (const protocol::ServerMessage& message : messages) {
      if (const auto* delta = std::get_if<protocol::StateDelta>(&message)) {
        tick = delta->tick;
        baseline_tick = delta->baseline_tick;
        said.push_back({tick});
      }
      const auto* part = std::get_if<protocol::SnapshotPart>(&message);
      if (part != nullptr && part->offset + part->bytes.size() == part->total_bytes) {
        tick = part->tick;
        said.push_back({tick});
      }
    }
    return said;
  }
};

TEST_F(RoomBranches, SnapshotsAreBuiltOnWhatIsAcknowledgedOnceTheRewindIsHeard) {
  open();
  const PeerId id = join(protocol::kSpectator, protocol::Mode::kSnapshot);
  Taker taker;
  std::vector<protocol::Ack> on_their_way;
  const auto play = [&](int ticks) {
    for (int i = 0; i < ticks; ++i) {
      run(1);
      for (const protocol::Ack& ack : on_their_way) say(id, ack);
      on_their_way = taker.take(hear(id));
    }
  };
  play(300);
  EXPECT_EQ(taker.baseline_tick, 297u);
  for (const std::uint64_t to : {60u, 30u, 45u}) {
    const std::uint64_t from = room_->tick();
    ASSERT_TRUE(room_->rewind(to));
    play(20);  // What is on its way when it hears of it is of the branch before.
    EXPECT_GT(taker.baseline_tick, to);
    EXPECT_EQ(taker.baseline_tick, taker.tick - 3) << "after the rewind from " << from;
  }
}

TEST_F(RoomRewind, KeyframesGoToALogThatWantsThem) {
  log_.keyframe_ticks = 25;
  open();
  run(60);
  ASSERT_EQ(log_.keyframes.size(), 2u);
  for (const protocol::Snapshot& keyframe : log_.keyframes) {
    scenes::Simulation simulation = simulation_of(scene_);
    ASSERT_TRUE(simulation.decode(keyframe.state).ok());
    EXPECT_EQ(simulation.tick(), keyframe.tick);
    EXPECT_EQ(simulation.digest(), keyframe.digest);
    EXPECT_EQ(keyframe.digest, log_.ticks[keyframe.tick - 1].digest);
  }
}

}  // namespace
}  // namespace cycloid::server
