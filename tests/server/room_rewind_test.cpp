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

class RoomDelayed : public RoomTest {
 protected:
  void open_delayed(std::uint64_t ticks) {
    RoomOptions options;
    options.spectator_delay_ticks = ticks;
    options.limits.keyframe_ticks = 7;
    options.limits.keyframe_bytes_max = 1;  // What is needed is kept all the same.
    open_with(options);
  }
  /// The latest tick that any of these messages tells about.
  static std::uint64_t latest(const std::vector<protocol::ServerMessage>& messages) {
    std::uint64_t tick = 0;
    for (const protocol::ServerMessage& message : messages) {
      std::visit(
          [&](const auto& said) {
            if constexpr (requires { said.tick; }) tick = std::max(tick, said.tick);
          },
          message);
    }
    return tick;
  }
};

TEST_F(RoomDelayed, ASpectatorSeesNothingThatIsNewer) {
  open_delayed(50);
  const PeerId player = enter(0);
  run(20);
  const PeerId early = join(protocol::kSpectator);
  std::map<PeerId, Mirror> mirrors;
  mirrors.emplace(early, Mirror(scene_));
  for (int i = 0; i < 200; ++i) {
    say(player, protocol::Input{room_->tick() + 1, push(i * 50)});
    if (i == 100) mirrors.emplace(join(protocol::kSpectator), Mirror(scene_));
    run(1);
    (void)hear(player);
    for (auto& [id, mirror] : mirrors) {
      say(id, protocol::Ping{1});
      const auto messages = hear(id);
      mirror.take(messages);
      const std::uint64_t shown = room_->tick() > 50 ? room_->tick() - 50 : 0;
      ASSERT_LE(latest(messages), shown);
      ASSERT_EQ(mirror.simulation.tick(), shown);
      ASSERT_TRUE(only<protocol::Margin>(messages).empty());
    }
  }
  EXPECT_EQ(mirrors.size(), 2u);
  for (auto& [id, mirror] : mirrors) {
    EXPECT_EQ(mirror.simulation.digest(), log_.ticks[room_->tick() - 51].digest);
  }
}

TEST_F(RoomDelayed, AdminsAndPlayersSeeTheMatchAsItIs) {
  open_delayed(50);
  const PeerId admin = admit(protocol::kSpectator, Role::kAdmin);
  const PeerId player = join(0);
  run(30);
  EXPECT_EQ(only<protocol::Welcome>(hear(admin))[0].tick, 30u);
  EXPECT_EQ(only<protocol::Welcome>(hear(player))[0].tick, 30u);
}

TEST_F(RoomDelayed, ASpectatorOfSnapshotsSeesKeyframesOnly) {
  open_delayed(20);
  const PeerId id = join(protocol::kSpectator, protocol::Mode::kSnapshot);
  Mirror mirror(scene_);
  for (int i = 0; i < 100; ++i) {
    run(1);
    const auto messages = hear(id);
    mirror.take(messages);
    ASSERT_LE(latest(messages) + 20, std::max<std::uint64_t>(room_->tick(), 20));
  }
  EXPECT_GE(mirror.deltas, 8u);
}

TEST_F(RoomDelayed, TheEndShowsNoMoreThanTheDelayDoes) {
  open_delayed(20);
  const PeerId id = enter(protocol::kSpectator);
  run(40);
  room_->drain("over");
  const auto messages = hear(id);
  EXPECT_EQ(latest(messages), 20u);
  EXPECT_TRUE(std::holds_alternative<protocol::Bye>(messages.back()));
}

TEST_F(RoomDelayed, ARewindIsShownOnlyToWhoHasSeenWhatItTookBack) {
  open_delayed(20);
  const PeerId behind = join(protocol::kSpectator);
  Mirror mirror(scene_);
  mirror.take(hear(behind));
  run(100);
  mirror.take(hear(behind));
  EXPECT_EQ(mirror.simulation.tick(), 80u);
  ASSERT_TRUE(room_->rewind(90));
  EXPECT_FALSE(room_->has_output(behind));
  run(40);
  mirror.take(hear(behind));
  EXPECT_EQ(mirror.simulation.tick(), 110u);
  EXPECT_EQ(mirror.states, 1u);
}

}  // namespace
}  // namespace cycloid::server
