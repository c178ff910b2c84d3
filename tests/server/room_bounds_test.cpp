#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/server/room_fixture.hpp"

namespace cycloid::server {
namespace {

using protocol::Refusal;

/// N on less than 1 kg: within a tick it is faster than a world may hold.
constexpr float kFaultForce = 1e11f;

class RoomBounds : public RoomTest {
 protected:
  void ping(PeerId id, std::uint64_t times) {
    protocol::Bytes burst;
    for (std::uint64_t token = 1; token <= times; ++token) {
      const protocol::Bytes one = protocol::encode(protocol::ClientMessage(protocol::Ping{token}));
      burst.insert(burst.end(), one.begin(), one.end());
    }
    room_->receive(id, burst);
  }
};

TEST_F(RoomBounds, CatchingUpIsBoundedInTicksAndSkipsNone) {
  open();
  run(10);
  now_ += 100 * kTickNs;
  room_->advance();
  EXPECT_EQ(room_->tick(), 18u);
  EXPECT_EQ(count(Notice::Kind::kOverload), 1);
  EXPECT_NEAR(static_cast<double>(room_->statistics().slowed_ns), 92.0 * kTickNs, 2.0 * kTickNs);
  for (int i = 0; i < 3; ++i) room_->advance();
  EXPECT_EQ(room_->tick(), 19u) << "the lost time is not made up for";
  now_ += 100 * kTickNs;
  room_->advance();
  EXPECT_EQ(count(Notice::Kind::kOverload), 1) << "said once";
  run(10);
  for (std::size_t i = 0; i < log_.ticks.size(); ++i) EXPECT_EQ(log_.ticks[i].frame.tick, i + 1);
}

/// The news of an overload must not add to it.
TEST_F(RoomBounds, AnOverloadIsToldOnceASecondWithAllThatWasLost) {
  open();
  const PeerId id = enter(0);
  const auto told_after_a_stall = [&] {
    now_ += 20 * kTickNs;
    room_->advance();
    return only<protocol::RoomNotice>(hear(id));
  };
  EXPECT_EQ(told_after_a_stall().size(), 1u);
  EXPECT_TRUE(told_after_a_stall().empty());
  EXPECT_TRUE(told_after_a_stall().empty());
  const auto notices = told_after_a_stall();  // 60 ticks after the first: a second.
  ASSERT_EQ(notices.size(), 1u);
  EXPECT_EQ(notices[0].kind, protocol::NoticeKind::kSlowed);
  EXPECT_EQ(notices[0].value, room_->statistics().slowed_ns / 1'000'000);
  EXPECT_GT(notices[0].value, 700u) << "ms, of all four";
}

TEST_F(RoomBounds, AStallChangesNoBit) {
  open();
  run(60);
  const std::uint64_t straight = room_->digest();
  log_.ticks.clear();
  open();
  run(7);
  now_ += 20 * kTickNs;
  while (room_->tick() < 60) {
    room_->advance();
    now_ += 3 * kTickNs;
  }
  EXPECT_GE(room_->tick(), 60u);
  EXPECT_EQ(log_.ticks[59].digest, straight);
}

TEST_F(RoomBounds, AShortDelayIsMadeUpFor) {
  open();
  run(1);
  now_ += 5 * kTickNs;
  room_->advance();
  EXPECT_EQ(room_->tick(), 6u);
  EXPECT_EQ(room_->statistics().slowed_ns, 0u);
}

/// Ticks that take three times as long as they last: each call makes one, so that the network is
/// looked after between two, and the match is slowed.
TEST_F(RoomBounds, CatchingUpIsBoundedInTime) {
  open();
  log_.on_tick = [this] { now_ += 3 * kTickNs; };
  now_ += 4 * kTickNs;
  room_->advance();
  EXPECT_EQ(room_->tick(), 1u);
  for (int i = 0; i < 100; ++i) room_->advance();
  EXPECT_EQ(room_->tick(), 101u);
  EXPECT_EQ(count(Notice::Kind::kOverload), 1);
  EXPECT_GT(room_->statistics().slowed_ns, static_cast<std::uint64_t>(150 * kTickNs));
  EXPECT_GE(room_->statistics().worst_tick_ns, static_cast<std::uint64_t>(3 * kTickNs));
}

TEST_F(RoomBounds, WhatIsMoreThanATickHoldsWaitsForTheNext) {
  Limits limits;
  limits.messages_per_tick_max = 4;
  open(limits);
  const PeerId id = join(0);
  run(1);
  (void)hear(id);
  ping(id, 10);
  EXPECT_EQ(only<protocol::Pong>(hear(id)).size(), 4u);
  EXPECT_FALSE(room_->wants_bytes(id));
  run(1);
  EXPECT_EQ(only<protocol::Pong>(hear(id)).size(), 4u);
  run(1);
  EXPECT_EQ(only<protocol::Pong>(hear(id)).size(), 2u);
  EXPECT_TRUE(room_->wants_bytes(id));
  EXPECT_FALSE(room_->wants_close(id));
}

class RareTicks : public RoomBounds {
 protected:
  /// A tick lasts 50 s.
  void open_rare(Limits limits = {}) {
    RoomOptions options;
    options.limits = limits;
    options.tick_rate_millihertz = 20;
    open_with(options);
  }
};

TEST_F(RareTicks, WhatIsMoreThanATickHoldsWaitsFor100Ms) {
  Limits limits;
  limits.messages_per_tick_max = 4;
  open_rare(limits);
  const PeerId id = enter(0);
  run(1);
  const std::int64_t begin = now_;
  ping(id, 10);
  EXPECT_EQ(only<protocol::Pong>(hear(id)).size(), 4u);
  EXPECT_FALSE(room_->wants_bytes(id));
  run(1);
  EXPECT_EQ(only<protocol::Pong>(hear(id)).size(), 4u);
  run(1);
  EXPECT_EQ(only<protocol::Pong>(hear(id)).size(), 2u);
  EXPECT_TRUE(room_->wants_bytes(id));
  EXPECT_EQ(now_ - begin, 200'000'000);
  EXPECT_EQ(room_->tick(), 0u);
}

TEST_F(RareTicks, DeadlinesHoldAllTheSame) {
  open_rare();
  const PeerId greets = room_->connect();
  const PeerId silent = enter(0);
  const PeerId lively = enter(1);
  std::map<PeerId, std::int64_t> closed_ns;
  for (const std::int64_t begin = now_; now_ - begin < 120'000'000'000;) {
    ping(lively, 1);
    run(5);
    (void)hear(lively);
    for (const PeerId id : {greets, silent, lively}) {
      if (room_->wants_close(id)) closed_ns.try_emplace(id, now_ - begin);
    }
  }
  EXPECT_EQ(room_->tick(), 2u);
  ASSERT_EQ(closed_ns.size(), 2u);
  EXPECT_NEAR(static_cast<double>(closed_ns[greets]), 5e9, 0.6e9);
  EXPECT_NEAR(static_cast<double>(closed_ns[silent]), 30e9, 0.6e9);
}

TEST_F(RoomBounds, JoinsOfOneTickAreBoundedAndEveryLeaveHasRoom) {
  open();
  PeerId refused = kNobody;
  for (int i = 0; i < 2000 && refused == kNobody; ++i) {
    const PeerId id = join(0);
    if (room_->wants_close(id)) refused = id;
    if (refused == kNobody) room_->disconnect(id);
  }
  ASSERT_NE(refused, kNobody);
  EXPECT_EQ(refusal(refused).code, Refusal::kRoomFull);
  run(1);
  EXPECT_LE(log_.ticks[0].frame.events.size(), protocol::kFrameEventsMax);
  EXPECT_FALSE(room_->wants_close(join(0)));
}

/// A room full of players who all are lost and then kicked, with as many events before as may be.
TEST_F(RoomBounds, EverySeatCanBeLostAndLeftInTheTickOfTheLastJoin) {
  scenes::Scene scene = two_seat_scene();
  while (scene.seats.size() < scenes::kSeatsMax) {
    scene.seats.push_back(scene.seats[0]);
    scene.seats.back().name = "seat " + std::to_string(scene.seats.size());
  }
  open(one_second_to_resume(), 0, scene);
  std::vector<PeerId> seated = {kNobody};
  while (seated.size() < scenes::kSeatsMax) {
    seated.push_back(join(static_cast<std::int32_t>(seated.size())));
  }
  run(1);
  const auto lose_and_kick = [&](PeerId id, std::size_t seat) {
    room_->disconnect(id);
    EXPECT_TRUE(room_->kick(seat, "gone"));
  };
  PeerId last = join(0);
  for (int i = 0; i < 1000 && !room_->wants_close(last); ++i) {
    lose_and_kick(last, 0);
    last = join(0);
  }
  EXPECT_EQ(refusal(last).code, Refusal::kRoomFull);
  for (std::size_t seat = 1; seat < seated.size(); ++seat) lose_and_kick(seated[seat], seat);
  run(1);
  const std::size_t events = log_.ticks[1].frame.events.size();
  EXPECT_LE(events, protocol::kFrameEventsMax);
  EXPECT_GT(events, protocol::kFrameEventsMax - 4) << "no join was refused without need";
}

TEST_F(RoomBounds, DrainingTellsAllAndClosesTheLog) {
  open();
  const PeerId player = join(0);
  const PeerId silent = room_->connect();
  run(7);
  (void)hear(player);
  room_->drain("SIGTERM");
  EXPECT_EQ(room_->state(), RoomState::kDrained);
  const auto last = hear(player);
  ASSERT_EQ(last.size(), 2u);
  EXPECT_EQ(std::get<protocol::Digest>(last[0]).digest, room_->digest());
  EXPECT_EQ(std::get<protocol::Bye>(last[1]).reason, "SIGTERM");
  EXPECT_TRUE(room_->wants_close(player));
  EXPECT_EQ(refusal(silent).code, Refusal::kDraining);
  ASSERT_TRUE(log_.footer);
  EXPECT_EQ(log_.footer->ticks, 7u);
  EXPECT_EQ(log_.footer->digest, log_.ticks[6].digest);
  run(3);
  EXPECT_EQ(room_->tick(), 7u);
  const PeerId late = room_->connect();
  const protocol::Refused refused = refusal(late);
  EXPECT_EQ(refused.code, Refusal::kDraining);
  EXPECT_EQ(refused.reason, "SIGTERM");
}

TEST_F(RoomBounds, TheWantedTicksAreTheEnd) {
  open({}, 20);
  const PeerId id = enter(0);
  now_ += 100 * kTickNs;
  for (int i = 0; i < 10; ++i) {
    room_->advance();
    now_ += 10 * kTickNs;
  }
  EXPECT_EQ(room_->state(), RoomState::kTicksDone);
  EXPECT_EQ(room_->tick(), 20u);
  const auto messages = hear(id);
  EXPECT_EQ(only<protocol::InputFrame>(messages).size(), 20u);
  EXPECT_TRUE(std::holds_alternative<protocol::Bye>(messages.back()));
}

TEST_F(RoomBounds, AFaultEndsTheMatchAndSaysWhere) {
  scenes::Scene scene = two_seat_scene();
  scene.seats[0].controls[0].value = {kFaultForce, 0.0f, 0.0f};
  open({}, 0, scene);
  const PeerId id = join(0);
  run(5);
  (void)hear(id);
  say(id, protocol::Input{6, push(32767)});
  run(5);
  EXPECT_EQ(room_->state(), RoomState::kFaulted);
  EXPECT_EQ(room_->tick(), 5u);
  const protocol::Refused refused = refusal(id);
  EXPECT_EQ(refused.code, Refusal::kFaulted);
  EXPECT_NE(refused.reason.find("faulted at tick 6"), std::string::npos) << refused.reason;
  EXPECT_NE(refused.reason.find("of body 1"), std::string::npos) << refused.reason;
  EXPECT_EQ(count(Notice::Kind::kFault), 1);
  ASSERT_TRUE(log_.footer);
  EXPECT_EQ(log_.footer->ticks, 5u);
  EXPECT_EQ(refusal(room_->connect()).code, Refusal::kFaulted);
}

TEST_F(RoomBounds, WithoutItsLogTheMatchGoesOnAndSaysSoOnce) {
  open();
  run(3);
  log_.break_down();
  run(5);
  EXPECT_EQ(room_->state(), RoomState::kRunning);
  EXPECT_EQ(room_->tick(), 8u);
  ASSERT_EQ(count(Notice::Kind::kLog), 1);
  EXPECT_NE(notices_[0].text.find("the disk is gone"), std::string::npos);
}

TEST_F(RoomBounds, WithoutItsLogTheMatchEndsWhereThatIsWanted) {
  stop_on_log_error_ = true;
  open();
  const PeerId id = join(0);
  run(3);
  log_.break_down();
  run(5);
  EXPECT_EQ(room_->state(), RoomState::kLogFailed);
  EXPECT_EQ(room_->tick(), 4u);
  EXPECT_TRUE(std::holds_alternative<protocol::Bye>(hear(id).back()));
}

TEST(Histogram, QuantilesAreUpperBoundsWithinAnEighth) {
  Histogram histogram;
  EXPECT_EQ(histogram.quantile(990), 0u);
  for (std::uint64_t value = 1; value <= 100'000; ++value) histogram.add(value);
  for (const std::uint64_t per_mille : {1u, 10u, 500u, 990u, 1000u}) {
    const double exact = 100.0 * static_cast<double>(per_mille);
    const double found = static_cast<double>(histogram.quantile(per_mille));
    EXPECT_GE(found, exact);
    EXPECT_LE(found, exact * 1.125 + 1.0);
  }
  histogram.add(~std::uint64_t{0});
  EXPECT_EQ(histogram.quantile(1000), ~std::uint64_t{0});
}

}  // namespace
}  // namespace cycloid::server
