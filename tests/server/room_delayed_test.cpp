#include <gtest/gtest.h>

#include "tests/server/room_fixture.hpp"

namespace cycloid::server {
namespace {

class RoomDelayed : public RoomTest {
 protected:
  void open_delayed(std::uint64_t ticks) {
    RoomOptions options;
    options.spectator_delay_ticks = ticks;
    options.limits.keyframe_ticks = 7;
    options.limits.keyframe_bytes_max = 1;  // What is needed is kept all the same.
    open_with(options);
  }
  /// It is 20 ticks behind a match of 75, has seen tick 55, and says that its state of 54 is wrong:
  /// the state kept of tick 49 would be a step back, so none comes yet.
  PeerId spectator_whose_state_is_due() {
    open_delayed(20);
    const PeerId id = enter(protocol::kSpectator);
    run(75);
    EXPECT_EQ(only<protocol::InputFrame>(hear(id)).back().tick, 55u);
    say(id, protocol::Digest{54, 0xbad});
    EXPECT_FALSE(room_->has_output(id));
    return id;
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

TEST_F(RoomDelayed, ARewindAnnouncesTheKeptStateThatComes) {
  RoomOptions options;
  options.spectator_delay_ticks = 20;
  options.limits.keyframe_ticks = 7;
  open_with(options);
  const PeerId id = enter(protocol::kSpectator);
  run(100);
  (void)hear(id);
  ASSERT_TRUE(room_->rewind(75));
  const auto messages =
      hear(id);  // It may see tick 55; of the states that are kept 49 is before it.
  ASSERT_EQ(only<protocol::RoomNotice>(messages).size(), 1u);
  EXPECT_EQ(only<protocol::RoomNotice>(messages)[0].value, 49u);
  ASSERT_FALSE(only<protocol::SnapshotPart>(messages).empty());
  EXPECT_EQ(only<protocol::SnapshotPart>(messages)[0].tick, 49u);
  const auto frames = only<protocol::InputFrame>(messages);
  ASSERT_EQ(frames.size(), 6u);
  EXPECT_EQ(frames[0].tick, 50u);
}

TEST_F(RoomDelayed, AStateThatMendsIsNotOlderThanTheFramesBefore) {
  const PeerId id = spectator_whose_state_is_due();
  run(1);
  const auto messages = hear(id);
  ASSERT_FALSE(only<protocol::SnapshotPart>(messages).empty());
  EXPECT_EQ(only<protocol::SnapshotPart>(messages)[0].tick, 56u);
  run(1);
  const auto frames = only<protocol::InputFrame>(hear(id));
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_EQ(frames[0].tick, 57u);
}

TEST_F(RoomDelayed, ARewindIsToldToWhoseStateIsDueForTheFramesThatItHasSeen) {
  const PeerId id = spectator_whose_state_is_due();
  ASSERT_TRUE(room_->rewind(50));
  const auto notices = only<protocol::RoomNotice>(hear(id));
  ASSERT_EQ(notices.size(), 1u) << "it has seen five frames that were taken back";
  EXPECT_EQ(notices[0].kind, protocol::NoticeKind::kRewound);
}

TEST_F(RoomDelayed, ARewindIsToldToWhoWasToldToGoOnFromALaterTick) {
  for (const auto mode : {protocol::Mode::kLockstep, protocol::Mode::kSnapshot}) {
    RoomOptions options;
    options.spectator_delay_ticks = 20;
    options.limits.keyframe_ticks = 7;
    open_with(options);
    const PeerId id = enter(protocol::kSpectator, mode);
    run(75);
    (void)hear(id);
    ASSERT_TRUE(room_->rewind(45));
    ASSERT_TRUE(room_->rewind(19));
    const auto messages = hear(id);
    const auto notices = only<protocol::RoomNotice>(messages);
    ASSERT_EQ(notices.size(), 2u);
    EXPECT_EQ(notices[0].value, 21u) << "of which it has no state yet";
    EXPECT_EQ(notices[1].value, 0u);
    EXPECT_EQ(only<protocol::SnapshotPart>(messages).at(0).tick, 0u);
  }
}

TEST_F(RoomDelayed, WhoWaitsForAKeptStateIsNotSlow) {
  RoomOptions options;
  options.spectator_delay_ticks = 20;
  options.limits.keyframe_ticks = 60;
  options.limits.queue_age = std::chrono::milliseconds(100);
  open_with(options);
  const PeerId id = enter(protocol::kSpectator);
  for (int i = 0; i < 85; ++i) {
    run(1);
    (void)hear(id);
  }
  say(id, protocol::Digest{64, 0xbad});
  run(54);
  EXPECT_FALSE(room_->has_output(id));
  run(1);
  EXPECT_EQ(room_->statistics().overruns, 0u);
  const auto parts = only<protocol::SnapshotPart>(hear(id));
  ASSERT_FALSE(parts.empty());
  EXPECT_EQ(parts[0].tick, 120u);
}

TEST_F(RoomDelayed, ADigestThatARewindOvertookIsNoMistake) {
  open_delayed(20);
  const PeerId id = enter(protocol::kSpectator);
  run(100);
  (void)hear(id);
  ASSERT_TRUE(room_->rewind(90));
  say(id, protocol::Digest{80, log_.ticks[79].digest});
  EXPECT_FALSE(room_->wants_close(id)) << "it had seen that tick";
  say(id, protocol::Digest{81, 0xbad});
  EXPECT_TRUE(room_->wants_close(id)) << "and never that one";
}

TEST_F(RoomDelayed, ADigestOfAPlayerWhoLooksOnSinceIsNoMistake) {
  RoomOptions options;
  options.spectator_delay_ticks = 50;
  options.slow = SlowPeer::kSpectate;
  options.limits.slow_ticks_max = 5;
  open_with(options);
  const PeerId id = enter(0);
  say(id, protocol::Input{1, push(1)});
  run(10);
  ASSERT_EQ(room_->seats()[0].state, SeatState::kFree);
  say(id, protocol::Digest{5, log_.ticks[4].digest});
  EXPECT_FALSE(room_->wants_close(id)) << "it saw that tick as a player";
  say(id, protocol::Digest{11, 0xbad});
  EXPECT_EQ(refusal(id).code, protocol::Refusal::kBadMessage);
}

TEST_F(RoomDelayed, AnAdminWhoLooksOnSinceSeesTheMatchAsItIs) {
  RoomOptions options;
  options.spectator_delay_ticks = 50;
  options.slow = SlowPeer::kSpectate;
  options.limits.slow_ticks_max = 5;
  open_with(options);
  const PeerId admin = admit(0, Role::kAdmin);
  const PeerId player = admit(1, Role::kPlayer);
  for (const PeerId id : {admin, player}) {
    (void)hear(id);
    say(id, protocol::Input{1, push(1)});
  }
  run(80);
  for (const std::size_t seat : {0u, 1u}) {
    EXPECT_EQ(room_->seats()[seat].state, SeatState::kFree);
  }
  EXPECT_EQ(only<protocol::InputFrame>(hear(player)).back().tick, 30u);
  EXPECT_EQ(only<protocol::InputFrame>(hear(admin)).back().tick, 80u);
}

TEST_F(RoomDelayed, APlayerOfSnapshotsWhoLooksOnSinceSeesNothingOlder) {
  RoomOptions options;
  options.spectator_delay_ticks = 50;
  options.slow = SlowPeer::kSpectate;
  options.limits.slow_ticks_max = 30;
  options.limits.keyframe_ticks = 7;
  open_with(options);
  const PeerId id = enter(0, protocol::Mode::kSnapshot);
  say(id, protocol::Input{1, push(1)});
  std::uint64_t seen = 0;
  for (int i = 0; i < 200; ++i) {
    run(1);
    for (const auto& delta : only<protocol::StateDelta>(hear(id))) {
      EXPECT_GT(delta.tick, seen);
      seen = delta.tick;
    }
    const bool plays = room_->seats()[0].state == SeatState::kHeld;
    EXPECT_EQ(plays, room_->tick() <= 30);
    EXPECT_TRUE(room_->tick() != 31 || seen == 30) << "as a player all that there is";
  }
  EXPECT_EQ(seen, 147u) << "the state kept of what it may see";
}

}  // namespace
}  // namespace cycloid::server
