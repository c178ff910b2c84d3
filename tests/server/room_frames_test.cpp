#include <gtest/gtest.h>

#include "tests/server/room_fixture.hpp"

namespace cycloid::server {
namespace {

using protocol::EventKind;
using protocol::Origin;

class RoomFrames : public RoomTest {
 protected:
  void SetUp() override { open(); }
};

TEST_F(RoomFrames, TheFirstWordsAreWelcomeAndTheExactState) {
  run(5);
  const PeerId id = join(1);
  const auto messages = hear(id);
  ASSERT_EQ(messages.size(), 2u);
  const auto welcome = std::get<protocol::Welcome>(messages[0]);
  EXPECT_EQ(welcome.seat, 1);
  EXPECT_EQ(welcome.seats, 2u);
  EXPECT_EQ(welcome.tick, 5u);
  EXPECT_EQ(welcome.tick_rate_millihertz, 60000u);
  EXPECT_EQ(welcome.input_delay_ticks, 2u);
  EXPECT_EQ(welcome.digest_ticks, 60u);
  EXPECT_TRUE(welcome.resume.empty()) << "a room without random numbers promises nothing";
  const auto state = std::get<protocol::SnapshotPart>(messages[1]);
  EXPECT_EQ(state.tick, 5u);
  EXPECT_EQ(state.digest, room_->digest());
}

TEST_F(RoomFrames, AllClientsHearTheSameFramesAndTheLogHasThem) {
  const PeerId a = enter(0);
  const PeerId b = enter(1);
  const PeerId looker = enter(protocol::kSpectator);
  std::map<PeerId, std::vector<protocol::ServerMessage>> heard;
  for (int tick = 1; tick <= 130; ++tick) {
    say(a, protocol::Input{static_cast<std::uint64_t>(tick), push(tick * 100)});
    if (tick % 3 == 0) say(b, protocol::Input{static_cast<std::uint64_t>(tick), push(-tick)});
    run(1);
    for (const PeerId id : {a, b, looker})
      std::ranges::move(hear(id), std::back_inserter(heard[id]));
  }
  const auto frames = only<protocol::InputFrame>(heard[a]);
  ASSERT_EQ(frames.size(), 130u);
  EXPECT_EQ(only<protocol::InputFrame>(heard[b]), frames);
  EXPECT_EQ(only<protocol::InputFrame>(heard[looker]), frames);
  ASSERT_EQ(log_.ticks.size(), 130u);
  for (std::size_t i = 0; i < frames.size(); ++i) EXPECT_EQ(log_.ticks[i].frame, frames[i]);

  const auto digests = only<protocol::Digest>(heard[a]);
  ASSERT_EQ(digests.size(), 2u);
  EXPECT_EQ(digests[0].tick, 60u);
  EXPECT_EQ(digests[1].tick, 120u);
  EXPECT_EQ(digests[1].digest, log_.ticks[119].digest);
}

/// A client of an earlier minor version has never heard of packed frames.
TEST_F(RoomFrames, ArePackedForThoseWhoKnowThem) {
  const PeerId knows = enter(0);
  const PeerId elder = room_->connect();
  protocol::Hello greeting = hello(1);
  greeting.protocol_minor = 0;
  say(elder, greeting);
  (void)hear(elder);
  run(1);
  const auto size_of = [&](PeerId id) {
    std::size_t bytes = 0;
    for (const Shared& said : room_->take_output(id)) bytes += said->size();
    return bytes;
  };
  const protocol::InputFrame& frame = log_.ticks.back().frame;
  EXPECT_EQ(size_of(knows), protocol::encode_packed(frame).size());
  EXPECT_EQ(size_of(elder), protocol::encode(protocol::ServerMessage(frame)).size());
  run(60);
  const auto heard = only<protocol::InputFrame>(hear(elder));
  EXPECT_EQ(heard, only<protocol::InputFrame>(hear(knows)));
  EXPECT_EQ(heard.size(), 60u);
}

TEST_F(RoomFrames, TheLogHasATickBeforeAnyClient) {
  const PeerId id = enter(0);
  bool heard_early = false;
  log_.on_tick = [&] { heard_early = heard_early || room_->has_output(id); };
  run(1);
  EXPECT_FALSE(heard_early);
  EXPECT_TRUE(room_->has_output(id));
}

TEST_F(RoomFrames, TheOutputOfATickIsOneWrite) {
  const PeerId id = enter(0);
  run(59);
  (void)hear(id);
  run(1);  // A frame and a digest.
  EXPECT_EQ(room_->take_output(id).size(), 1u);
}

TEST_F(RoomFrames, AnInputIsGivenThenRepeatedAndBeforeAllAbsent) {
  const PeerId id = enter(0);
  run(1);
  say(id, protocol::Input{2, push(7)});
  run(2);
  const auto frames = only<protocol::InputFrame>(hear(id));
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[0].seats[0], (protocol::SeatFrame{Origin::kAbsent, {}}));
  EXPECT_EQ(frames[1].seats[0], (protocol::SeatFrame{Origin::kGiven, push(7)}));
  EXPECT_EQ(frames[2].seats[0], (protocol::SeatFrame{Origin::kRepeated, push(7)}));
  for (const auto& frame : frames) {
    EXPECT_EQ(frame.seats[1], (protocol::SeatFrame{Origin::kAbsent, {}}));
  }
}

TEST_F(RoomFrames, ALateInputIsCountedAndChangesNothing) {
  const PeerId id = enter(0);
  run(10);
  say(id, protocol::Input{10, push(32767)});
  say(id, protocol::Input{1, push(32767)});
  run(70);
  EXPECT_EQ(room_->statistics().inputs_late, 2u);
  for (const auto& frame : only<protocol::InputFrame>(hear(id))) {
    EXPECT_EQ(frame.seats[0], (protocol::SeatFrame{Origin::kAbsent, {}})) << frame.tick;
  }
}

TEST_F(RoomFrames, AnInputBeyondTheWindowIsCountedAndChangesNothing) {
  const PeerId id = enter(0);
  say(id, protocol::Input{65, push(1)});
  say(id, protocol::Input{64, push(2)});
  run(66);
  EXPECT_EQ(room_->statistics().inputs_early, 1u);
  const auto frames = only<protocol::InputFrame>(hear(id));
  EXPECT_EQ(frames[63].seats[0], (protocol::SeatFrame{Origin::kGiven, push(2)}));
  EXPECT_EQ(frames[64].seats[0], (protocol::SeatFrame{Origin::kRepeated, push(2)}));
}

TEST_F(RoomFrames, UntilTheTickTheLastWordCounts) {
  const PeerId id = enter(0);
  say(id, protocol::Input{1, push(1)});
  say(id, protocol::Input{1, push(2)});
  run(1);
  EXPECT_EQ(only<protocol::InputFrame>(hear(id))[0].seats[0].input, push(2));
}

TEST_F(RoomFrames, JoinAndLeaveAreEventsOfTheNextFrame) {
  const PeerId watcher = enter(protocol::kSpectator);
  const PeerId player = enter(1);
  run(2);
  say(player, protocol::Input{3, push(9)});
  run(1);
  say(player, protocol::Bye{"enough"});
  EXPECT_TRUE(room_->wants_close(player));
  run(2);
  const auto frames = only<protocol::InputFrame>(hear(watcher));
  ASSERT_EQ(frames.size(), 5u);
  EXPECT_EQ(frames[0].events, (std::vector<protocol::FrameEvent>{{EventKind::kJoin, 1}}));
  EXPECT_TRUE(frames[1].events.empty());
  EXPECT_EQ(frames[2].seats[1].origin, Origin::kGiven);
  EXPECT_EQ(frames[3].events, (std::vector<protocol::FrameEvent>{{EventKind::kLeave, 1}}));
  EXPECT_EQ(frames[3].seats[1], (protocol::SeatFrame{Origin::kAbsent, {}}));
  EXPECT_TRUE(frames[4].events.empty());
}

TEST_F(RoomFrames, AConnectionThatIsGoneLeavesItsSeatToTheNext) {
  const PeerId first = enter(0);
  say(first, protocol::Input{1, push(5)});
  run(1);
  room_->disconnect(first);
  const PeerId second = enter(0);
  EXPECT_FALSE(room_->wants_close(second));
  run(1);
  const auto frames = only<protocol::InputFrame>(hear(second));
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_EQ(frames[0].events,
            (std::vector<protocol::FrameEvent>{{EventKind::kLeave, 0}, {EventKind::kJoin, 0}}));
  EXPECT_EQ(frames[0].seats[0].origin, Origin::kAbsent) << "the input of another was repeated";
}

TEST_F(RoomFrames, WhoJoinsInTheMiddleHasTheSameDigests) {
  const PeerId early = join(0);
  Mirror first(scene_);
  first.take(hear(early));
  Mirror second(scene_);
  PeerId late = kNobody;
  for (std::uint64_t tick = 1; tick <= 200; ++tick) {
    say(early, protocol::Input{tick, push(static_cast<int>(tick % 7) * 4000 - 12000)});
    if (tick == 77) late = join(1);
    if (late != kNobody) say(late, protocol::Input{tick, push(-9000)});
    run(1);
    first.take(hear(early));
    if (late != kNobody) second.take(hear(late));
  }
  ASSERT_EQ(first.frames.size(), 200u);
  ASSERT_EQ(second.frames.size(), 123u) << "its state is that of the tick at which it first reads";
  for (const auto& [tick, digest] : second.digests) {
    EXPECT_EQ(digest, first.digests[tick]) << tick;
    EXPECT_EQ(digest, log_.ticks[tick - 1].digest) << tick;
  }
  EXPECT_EQ(first.simulation.digest(), room_->digest());
}

TEST_F(RoomFrames, ASnapshotClientHearsTheLatestStateOnly) {
  const PeerId id = join(0, protocol::Mode::kSnapshot);
  ASSERT_EQ(hear(id).size(), 2u);
  run(2);
  EXPECT_FALSE(room_->has_output(id));
  run(8);
  const auto messages = hear(id);
  ASSERT_EQ(messages.size(), 1u) << "snapshots that were not sent are replaced";
  EXPECT_EQ(std::get<protocol::StateDelta>(messages[0]).tick, 9u);
  EXPECT_EQ(std::get<protocol::StateDelta>(messages[0]).digest, log_.ticks[8].digest);
}

TEST_F(RoomFrames, APingIsAnsweredWithTheTick) {
  const PeerId id = enter(0);
  run(4);
  (void)hear(id);
  say(id, protocol::Ping{99});
  const auto pongs = only<protocol::Pong>(hear(id));
  ASSERT_EQ(pongs.size(), 1u);
  EXPECT_EQ(pongs[0].token, 99u);
  EXPECT_EQ(pongs[0].tick, 4u);
}

}  // namespace
}  // namespace cycloid::server
