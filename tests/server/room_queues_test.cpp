#include <gtest/gtest.h>

#include <set>

#include "tests/server/room_fixture.hpp"

namespace cycloid::server {
namespace {

using protocol::Refusal;

/// Four hundred balls that fall on a floor, and two seats: a state of several parts.
scenes::Scene crowded_scene() {
  scenes::Scene scene = two_seat_scene();
  for (int i = 0; i < 400; ++i) {
    scenes::SceneBody ball = scene.bodies[1];
    ball.name = "ball-" + std::to_string(i);
    ball.position = {static_cast<float>(i % 20) * 1.1f - 11.0f,
                     0.6f + static_cast<float>(i / 20) * 1.2f, 3.0f};
    scene.bodies.push_back(ball);
  }
  scene.limits.bodies = 512;
  return scene;
}

class RoomQueues : public RoomTest {
 protected:
  std::size_t parts(PeerId id) { return only<protocol::SnapshotPart>(hear(id)).size(); }
};

TEST_F(RoomQueues, AReaderThatStopsIsDroppedAfterThreeChancesAndTheOthersHearAll) {
  open();
  const PeerId good = enter(0);
  const PeerId slow = enter(1);
  std::size_t frames = 0;
  int tick = 0;
  for (; tick < 1000 && !room_->wants_close(slow); ++tick) {
    say(good, protocol::Ping{1});
    say(slow, protocol::Ping{1});
    run(1);
    frames += only<protocol::InputFrame>(hear(good)).size();
  }
  EXPECT_EQ(frames, static_cast<std::size_t>(tick));
  EXPECT_NEAR(tick, 4 * 120, 8) << "two seconds each";
  EXPECT_FALSE(room_->wants_close(good));
  const auto last = hear(slow);
  ASSERT_EQ(last.size(), 1u) << "what it did not take is gone; its last word is why";
  EXPECT_EQ(std::get<protocol::Refused>(last[0]).code, Refusal::kTooSlow);
  EXPECT_EQ(std::get<protocol::Refused>(last[0]).reason,
            "more than 1048576 bytes, or anything for more than 2000 ms, waited for it 4 times in "
            "300 s");
  EXPECT_EQ(room_->statistics().overruns, 4u);
}

TEST_F(RoomQueues, AReaderThatWakesUpIsGivenTheExactState) {
  open();
  const PeerId id = join(0);
  Mirror mirror(scene_);
  mirror.take(hear(id));
  run(150);
  EXPECT_EQ(room_->statistics().overruns, 1u);
  mirror.take(hear(id));
  EXPECT_EQ(mirror.states, 2u);
  EXPECT_TRUE(mirror.frames.empty()) << "the state is newer than what was dropped";
  run(30);
  mirror.take(hear(id));
  EXPECT_EQ(mirror.frames.size(), 30u);
  EXPECT_EQ(mirror.simulation.digest(), room_->digest());
}

TEST_F(RoomQueues, BytesAreBoundedAsWellAsTime) {
  Limits limits;
  limits.queue_bytes_max = 1024;
  open(limits);
  const PeerId id = enter(0);
  std::uint64_t most = 0;
  for (int tick = 0; tick < 60; ++tick) {
    run(1);
    most = std::max(most, room_->statistics().queue_bytes);
  }
  EXPECT_GE(room_->statistics().overruns, 1u);
  EXPECT_GT(most, 512u);
  EXPECT_LE(most, 1024u);
  EXPECT_FALSE(room_->wants_close(id));
}

TEST_F(RoomQueues, AStateGoesOnWhereTicksAreRare) {
  RoomOptions options;
  options.tick_rate_millihertz = 1;
  options.limits.state_parts_per_tick_max = 1;
  open_with(options, crowded_scene());
  const PeerId id = join(0);
  Mirror mirror(scene_);
  const std::int64_t begin = now_;
  std::int64_t takes = 1;
  for (mirror.take(hear(id)); mirror.states == 0 && takes < 100; ++takes) {
    EXPECT_FALSE(room_->has_output(id)) << "its share is gone";
    run(1);
    mirror.take(hear(id));
  }
  EXPECT_EQ(mirror.states, 1u);
  EXPECT_GT(takes, 3) << "or it proves nothing";
  EXPECT_EQ(now_ - begin, (takes - 1) * 100'000'000);
  EXPECT_EQ(room_->tick(), 0u);
}

/// No state is made or held for who does not read, and nothing else beyond the bound.
TEST_F(RoomQueues, AHundredClientsThatNeverReadHoldNothing) {
  Limits limits;
  limits.queue_bytes_max = 4096;
  open(limits, 0, crowded_scene());
  const PeerId good = enter(0);
  std::vector<PeerId> silent;
  for (int i = 0; i < 100; ++i) {
    silent.push_back(join(protocol::kSpectator));
    run(1);
    (void)hear(good);
  }
  const std::uint64_t encodes = room_->statistics().encodes;
  for (int tick = 0; tick < 100; ++tick) {
    run(1);
    (void)hear(good);
    EXPECT_LE(room_->statistics().queue_bytes, 100u * 4096u);
  }
  EXPECT_LE(room_->statistics().encodes - encodes, 2u) << "keyframes only";
  for (int tick = 0; tick < 720; ++tick) {
    say(good, protocol::Ping{1});
    run(1);
    (void)hear(good);
  }
  for (const PeerId id : silent) EXPECT_TRUE(room_->wants_close(id));
  EXPECT_FALSE(room_->wants_close(good));
}

TEST_F(RoomQueues, ASnapshotClientThatReadsNothingHoldsOneSnapshot) {
  Limits limits;
  limits.queue_bytes_max = 4096;
  open(limits);
  const PeerId id = enter(0, protocol::Mode::kSnapshot);
  run(600);
  EXPECT_FALSE(room_->wants_close(id));
  EXPECT_EQ(room_->take_output(id).size(), 1u);
}

TEST_F(RoomQueues, AStateTravelsInPartsBesideTheFrames) {
  Limits limits;
  limits.state_parts_per_tick_max = 2;
  open(limits, 0, crowded_scene());
  run(30);
  const PeerId id = join(0);
  Mirror mirror(scene_);
  int ticks = 0;
  std::size_t most = 0;
  while (mirror.states == 0 && ticks < 100) {
    const auto messages = hear(id);
    EXPECT_FALSE(room_->has_output(id)) << "a spinning writer";
    most = std::max(most, only<protocol::SnapshotPart>(messages).size());
    mirror.take(messages);
    run(1);
    ++ticks;
  }
  EXPECT_EQ(most, 2u);
  EXPECT_GT(ticks, 3);
  EXPECT_EQ(mirror.frames.size(), static_cast<std::size_t>(ticks) - 1) << "those since the state";
  mirror.take(hear(id));
  EXPECT_EQ(mirror.simulation.digest(), room_->digest());
  EXPECT_EQ(room_->tick(), 30u + static_cast<std::uint64_t>(ticks)) << "the room never waits";
}

/// The work of a join is one state, however long the match is.
TEST_F(RoomQueues, AJoinTakesTheSameWhateverTheAgeOfTheMatch) {
  const auto ticks_to_join = [&](int age) {
    open({}, 0, crowded_scene());
    run(age);
    const PeerId id = join(protocol::kSpectator);
    Mirror mirror(scene_);
    std::size_t bytes = 0;
    int ticks = 0;
    while (mirror.states == 0 && ticks < 200) {
      const std::uint64_t before = room_->statistics().bytes_out;
      mirror.take(hear(id));
      bytes += room_->statistics().bytes_out - before;
      run(1);
      ++ticks;
    }
    mirror.take(hear(id));
    EXPECT_EQ(mirror.simulation.digest(), room_->digest());
    return std::pair(ticks, bytes);
  };
  const auto young = ticks_to_join(60);
  const auto old = ticks_to_join(1800);
  EXPECT_LE(std::abs(young.first - old.first), 1);
  EXPECT_NEAR(static_cast<double>(old.second), static_cast<double>(young.second),
              0.25 * static_cast<double>(young.second));
}

TEST_F(RoomQueues, AJoinerThatReadsTooSlowlyIsStartedAgainThreeTimes) {
  Limits limits;
  limits.state_parts_per_tick_max = 1;
  limits.queue_bytes_max = 512;
  limits.resyncs_max = 100;
  open(limits, 0, crowded_scene());
  const PeerId id = join(0);
  std::set<std::uint64_t> begun;
  for (int tick = 0; tick < 1000 && !room_->wants_close(id); ++tick) {
    if (tick % 20 == 0) {
      for (const auto& part : only<protocol::SnapshotPart>(hear(id))) {
        if (part.offset == 0) begun.insert(part.tick);
      }
    }
    run(1);
  }
  EXPECT_EQ(begun.size(), 4u);
  const protocol::Refused refused = refusal(id);
  EXPECT_EQ(refused.code, Refusal::kTooSlow);
  EXPECT_NE(refused.reason.find("4 times within one state"), std::string::npos) << refused.reason;
}

TEST_F(RoomQueues, AStateIsEncodedOnceForAllThatJoinInATick) {
  Limits limits;
  limits.keyframe_ticks = 1000000;
  open(limits);
  run(7);
  const std::uint64_t before = room_->statistics().encodes;
  std::vector<PeerId> ids;
  for (int i = 0; i < 50; ++i) ids.push_back(join(protocol::kSpectator));
  for (const PeerId id : ids) EXPECT_EQ(parts(id), 1u);
  run(1);
  EXPECT_EQ(room_->statistics().encodes, before + 1);
}

TEST_F(RoomQueues, WhoIsToldTheEndHearsAllOfItsStateBefore) {
  Limits limits;
  limits.state_parts_per_tick_max = 1;
  open(limits, 0, crowded_scene());
  run(3);
  const PeerId id = join(0);
  EXPECT_EQ(parts(id), 1u);
  room_->drain("the end");
  const auto messages = hear(id);
  EXPECT_GT(only<protocol::SnapshotPart>(messages).size(), 2u);
  EXPECT_TRUE(std::holds_alternative<protocol::Bye>(messages.back()));
  EXPECT_FALSE(room_->has_output(id));
}

}  // namespace
}  // namespace cycloid::server
