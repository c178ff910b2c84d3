#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "tests/server/room_fixture.hpp"

namespace cycloid::server {
namespace {

using protocol::Origin;
using protocol::Refusal;

scenes::SeatInput say_all(int axis, std::uint16_t buttons) {
  const auto value = static_cast<std::int16_t>(axis);
  return {{value, value, value, value}, buttons};
}

class RoomInputs : public RoomTest {
 protected:
  const protocol::SeatFrame& seat_of(std::uint64_t tick, std::size_t seat = 0) {
    return log_.ticks[tick - 1].frame.seats[seat];
  }
};

TEST_F(RoomInputs, EachControlIsReplacedByItsOwnPolicy) {
  RoomOptions options;
  options.policy.axes[1] = WhenMissing::kNeutral;
  options.policy.buttons[2] = WhenMissing::kNeutral;
  options.policy.one_shot_buttons = 1u << 5;
  open_with(options);
  const PeerId id = enter(0);
  say(id, protocol::Input{1, say_all(1000, 0xffff)});
  run(3);
  EXPECT_EQ(seat_of(1), (protocol::SeatFrame{Origin::kGiven, say_all(1000, 0xffff)}));
  scenes::SeatInput replaced = say_all(1000, 0xffff & ~(1u << 2) & ~(1u << 5));
  replaced.axes[1] = 0;
  EXPECT_EQ(seat_of(2), (protocol::SeatFrame{Origin::kRepeated, replaced}));
  EXPECT_EQ(seat_of(3), seat_of(2));
  EXPECT_EQ(room_->statistics().inputs_replaced, 2u);
}

TEST_F(RoomInputs, ARoomThatRepeatsNothingSaysNeutral) {
  RoomOptions options;
  options.policy.axes.fill(WhenMissing::kNeutral);
  options.policy.buttons.fill(WhenMissing::kNeutral);
  open_with(options);
  const PeerId id = enter(0);
  say(id, protocol::Input{2, say_all(1000, 0xffff)});
  run(3);
  EXPECT_EQ(seat_of(1).origin, Origin::kAbsent) << "it has said nothing yet";
  EXPECT_EQ(seat_of(3), (protocol::SeatFrame{Origin::kNeutral, {}}));
}

class RoomWaits : public RoomInputs {
 protected:
  void open_waiting(std::uint32_t ticks, SlowPeer slow = SlowPeer::kReplace) {
    RoomOptions options;
    options.policy.axes[0] = WhenMissing::kWaitThenRepeat;
    options.policy.wait_ticks_max = ticks;
    options.slow = slow;
    options.limits.slow_ticks_max = 10;
    open_with(options);
  }
  /// The time goes on by so much, and the room is asked as it wishes.
  void pass(std::int64_t ns) {
    const std::int64_t end = now_ + ns;
    while (room_->next_deadline_ns() <= end) {
      now_ = std::max(now_, room_->next_deadline_ns());
      room_->advance();
    }
    now_ = end;
  }
};

/// From the first input on it is one to wait for, though that came too late.
TEST_F(RoomWaits, WhoseInputsAreAllLateIsWaitedFor) {
  open_waiting(3);
  const PeerId id = enter(0);
  run(2);
  say(id, protocol::Input{1, push(1)});
  pass(3 * kTickNs + kTickNs / 2);
  EXPECT_EQ(room_->tick(), 2u);
  EXPECT_EQ(only<protocol::InputFrame>(hear(id)).size(), 2u);
  say(id, protocol::Input{3, push(1)});
  pass(kTickNs / 4);
  EXPECT_EQ(seat_of(3).origin, Origin::kGiven);
}

TEST_F(RoomWaits, ATickIsHeldForAMissingInputAndThenGoesOn) {
  open_waiting(3);
  const PeerId id = enter(0);
  say(id, protocol::Input{1, push(1)});
  run(1);
  const std::int64_t made = now_;
  pass(4 * kTickNs - 10);
  EXPECT_EQ(room_->tick(), 1u) << "due after one tick time, held for three";
  pass(20);
  EXPECT_EQ(room_->tick(), 2u);
  EXPECT_EQ(seat_of(2).origin, Origin::kRepeated);
  EXPECT_NEAR(static_cast<double>(room_->statistics().waited_ns), 3.0 * kTickNs, 1000.0);
  EXPECT_NEAR(static_cast<double>(now_ - made), 4.0 * kTickNs, 1000.0);
}

TEST_F(RoomWaits, AnInputThatComesMeanwhileIsTakenAndTheScheduleMoves) {
  open_waiting(3);
  const PeerId id = enter(0);
  say(id, protocol::Input{1, push(1)});
  run(1);
  pass(2 * kTickNs);
  EXPECT_EQ(room_->tick(), 1u);
  say(id, protocol::Input{2, push(2)});
  pass(kTickNs / 4);
  EXPECT_EQ(room_->tick(), 2u);
  EXPECT_EQ(seat_of(2), (protocol::SeatFrame{Origin::kGiven, push(2)}));
  say(id, protocol::Input{3, push(3)});
  pass(kTickNs / 2);
  EXPECT_EQ(room_->tick(), 2u) << "a whole tick time after the one that was held";
  pass(kTickNs);
  EXPECT_EQ(room_->tick(), 3u);
  EXPECT_EQ(room_->statistics().catch_up_ticks, 0u);
  const auto margins = only<protocol::Margin>(hear(id));
  ASSERT_FALSE(margins.empty());
  EXPECT_LT(margins.back().early_ticks, 0) << "in time only because the tick has waited";
}

TEST_F(RoomWaits, NobodyIsWaitedForWhoNeverSpokeOrIsGone) {
  open_waiting(3);
  (void)enter(0);
  const PeerId spectator = enter(protocol::kSpectator);
  (void)spectator;
  pass(60 * kTickNs);
  EXPECT_EQ(room_->statistics().waited_ns, 0u);
  EXPECT_GE(room_->tick(), 59u);
}

TEST_F(RoomWaits, ASlowPlayerIsWaitedForOnlySoOftenWhereItIsReplaced) {
  open_waiting(1);
  const PeerId id = enter(0);
  say(id, protocol::Input{1, push(1)});
  run(1);
  pass(21 * kTickNs);
  EXPECT_NEAR(static_cast<double>(room_->tick()), 11.0, 1.0) << "ten ticks of two tick times";
  pass(20 * kTickNs);
  EXPECT_NEAR(static_cast<double>(room_->tick()), 31.0, 1.0) << "and no more";
}

TEST_F(RoomWaits, ASlowPlayerIsWaitedForForEverWhereThatIsThePolicy) {
  open_waiting(1, SlowPeer::kWait);
  const PeerId id = enter(0);
  say(id, protocol::Input{1, push(1)});
  run(1);
  pass(100 * kTickNs);
  EXPECT_NEAR(static_cast<double>(room_->tick()), 51.0, 1.0);
}

TEST_F(RoomWaits, ASlowPlayerBecomesASpectatorWhereThatIsThePolicy) {
  open_waiting(0, SlowPeer::kSpectate);
  const PeerId id = enter(0);
  say(id, protocol::Input{1, push(1)});
  run(13);
  EXPECT_EQ(log_.ticks[11].frame.events,
            (std::vector<protocol::FrameEvent>{{protocol::EventKind::kKick, 0}}));
  EXPECT_FALSE(room_->wants_close(id));
  say(id, protocol::Input{20, push(1)});
  EXPECT_FALSE(room_->wants_close(id)) << "it may not know yet";
  EXPECT_EQ(only<protocol::InputFrame>(hear(id)).size(), 13u) << "it looks on";
  EXPECT_FALSE(room_->wants_close(join(0))) << "the seat is free";
}

TEST_F(RoomWaits, ASlowPlayerIsDroppedWhereThatIsThePolicy) {
  open_waiting(0, SlowPeer::kDrop);
  const PeerId id = enter(0);
  const PeerId other = enter(1);
  say(id, protocol::Input{1, push(1)});
  run(13);
  const protocol::Refused refused = refusal(id);
  EXPECT_EQ(refused.code, Refusal::kTooSlow);
  EXPECT_EQ(refused.reason, "no input in time for 10 ticks, of at most 9");
  EXPECT_FALSE(room_->wants_close(other));
}

TEST_F(RoomInputs, AMarginTellsHowInputsComeAndAtMostEverySixTicks) {
  open();
  const PeerId id = enter(0);
  std::vector<protocol::Margin> margins;
  for (std::uint64_t tick = 1; tick <= 60; ++tick) {
    say(id, protocol::Input{tick + 3, push(1)});
    run(1);
    for (const auto& margin : only<protocol::Margin>(hear(id))) margins.push_back(margin);
  }
  ASSERT_GE(margins.size(), 9u);
  EXPECT_LE(margins.size(), 10u);
  for (const protocol::Margin& margin : margins) {
    EXPECT_EQ(margin.early_ticks, 3);
    EXPECT_EQ(margin.missed, 0u);
    EXPECT_EQ(margin.merged, 6u);
  }
}

TEST_F(RoomInputs, AMissedInputIsToldAtOnceAndALateOneByHowMuch) {
  open();
  const PeerId id = enter(0);
  say(id, protocol::Input{1, push(1)});
  run(1);
  (void)hear(id);
  run(1);
  auto margins = only<protocol::Margin>(hear(id));
  ASSERT_EQ(margins.size(), 1u);
  EXPECT_EQ(margins[0].tick, 2u);
  EXPECT_EQ(margins[0].missed, 1u);
  say(id, protocol::Input{1, push(1)});
  run(1);
  margins = only<protocol::Margin>(hear(id));
  ASSERT_EQ(margins.size(), 1u);
  EXPECT_EQ(margins[0].early_ticks, -2) << "tick 1 was closed when tick 2 was made";
  EXPECT_EQ(margins[0].merged, 0u);
}

TEST_F(RoomInputs, AnInputThatIsTooEarlyIsDroppedAndToldByHowMuch) {
  open();
  const PeerId id = enter(0);
  say(id, protocol::Input{70, push(1)});
  say(id, protocol::Input{protocol::kTickEnd - 1, push(1)});
  run(6);
  const auto margins = only<protocol::Margin>(hear(id));
  ASSERT_EQ(margins.size(), 1u) << "the other is of another time";
  EXPECT_EQ(margins[0].early_ticks, 69);
  EXPECT_EQ(margins[0].merged, 0u);
  EXPECT_EQ(margins[0].missed, 0u);
  run(70);
  EXPECT_EQ(seat_of(70).origin, Origin::kAbsent);
  EXPECT_EQ(room_->statistics().inputs_early, 2u);
}

/// A client on the same machine sends when it sees a tick, with the lead that it is told.
TEST_F(RoomInputs, AClientWithoutDelayMissesNothing) {
  open();
  const PeerId id = join(0);
  std::uint64_t next = 0;
  for (int i = 0; i < 600; ++i) {
    for (const auto& message : hear(id)) {
      if (const auto* welcome = std::get_if<protocol::Welcome>(&message)) {
        next = welcome->tick + welcome->input_delay_ticks;
      }
    }
    for (; next <= room_->tick() + 2; ++next) say(id, protocol::Input{next, push(1)});
    run(1);
  }
  EXPECT_EQ(room_->statistics().inputs_replaced, 0u);
  EXPECT_EQ(room_->statistics().inputs_late, 0u);
}

/// 400 actions for one tick from one client.
TEST_F(RoomInputs, AFloodOfInputsIsRefusedAndNobodyElseNotices) {
  open();
  const PeerId good = enter(1);
  const PeerId bad = enter(0);
  for (int action = 0; action < 400; ++action) say(bad, protocol::Input{3, push(action)});
  say(good, protocol::Input{1, push(5)});
  run(3);
  const protocol::Refused refused = refusal(bad);
  EXPECT_EQ(refused.code, Refusal::kRateLimited);
  EXPECT_EQ(refused.reason, "9 inputs for tick 3, of at most 8");
  EXPECT_EQ(seat_of(1, 1), (protocol::SeatFrame{Origin::kGiven, push(5)}));
  EXPECT_EQ(only<protocol::InputFrame>(hear(good)).size(), 3u);
}

TEST_F(RoomInputs, NewRatesAreOfThoseWhoAreThereToo) {
  Limits limits;
  open(limits);
  const PeerId id = enter(0);
  limits.messages_per_s = 5;
  room_->set_limits(limits);
  for (int i = 0; i < 10; ++i) say(id, protocol::Ping{1});
  EXPECT_FALSE(room_->wants_close(id));
  say(id, protocol::Ping{1});
  EXPECT_EQ(refusal(id).reason, "more than 5 messages a second");
}

TEST_F(RoomInputs, RatesGrowWithTheTicksOfASecond) {
  RoomOptions options;
  options.tick_rate_millihertz = 6'000'000;
  open_with(options);
  const PeerId id = enter(0);
  for (int tick = 0; tick < 18'000 && !room_->wants_close(id); ++tick) {
    say(id, protocol::Input{room_->tick() + 1, push(tick)});
    say(id, protocol::Ping{1});
    run(1);
    (void)hear(id);
  }
  EXPECT_FALSE(room_->wants_close(id)) << "two messages a tick for three seconds";
  for (int tick = 0; tick < 2'000 && !room_->wants_close(id); ++tick) {
    for (int ping = 0; ping < 50; ++ping) say(id, protocol::Ping{1});
    run(1);
    if (!room_->wants_close(id)) (void)hear(id);
  }
  EXPECT_EQ(refusal(id).reason, "more than 24000 messages a second");
}

TEST_F(RoomInputs, MessagesAndBytesOfAConnectionAreRateLimited) {
  Limits limits;
  limits.messages_per_s = 100;
  open(limits);
  const PeerId id = enter(0);
  const PeerId chatty = enter(1);
  for (int tick = 0; tick < 120 && !room_->wants_close(chatty); ++tick) {
    say(id, protocol::Ping{1});
    for (int ping = 0; ping < 10; ++ping) say(chatty, protocol::Ping{1});
    run(1);
    (void)hear(id);
    if (!room_->wants_close(chatty)) (void)hear(chatty);
  }
  const protocol::Refused refused = refusal(chatty);
  EXPECT_EQ(refused.code, Refusal::kRateLimited);
  EXPECT_EQ(refused.reason, "more than 100 messages a second");
  EXPECT_FALSE(room_->wants_close(id));

  limits = {};
  limits.bytes_per_s = 2000;
  open(limits);
  const PeerId wordy = enter(0);
  for (int i = 0; i < 10 && !room_->wants_close(wordy); ++i) {
    say(wordy, protocol::TickDigests{1, std::vector<std::uint64_t>(150)});
  }
  EXPECT_EQ(refusal(wordy).reason, "more than 2000 bytes a second");
}

/// What happened depends on which inputs were in time, and on nothing else: not on their order, nor
/// on what came too late or too early beside them.
TEST_F(RoomInputs, TheMatchDependsOnlyOnWhatWasAccepted) {
  constexpr std::uint64_t kTicks = 40;
  struct Word {
    std::size_t seat;
    std::uint64_t tick;
    std::uint64_t arrives;  ///< Before the tick after this one is made.
  };
  std::mt19937 random(20261121);
  const auto below = [&](std::uint32_t end) { return static_cast<std::uint32_t>(random() % end); };
  for (int round = 0; round < 60; ++round) {
    std::vector<Word> accepted;
    for (std::uint64_t tick = 1; tick <= kTicks; ++tick) {
      for (std::size_t seat = 0; seat < 2; ++seat) {
        if (below(3) != 0) accepted.push_back({seat, tick, 0});
      }
    }
    std::vector<protocol::LogTick> first;
    for (int order = 0; order < 3; ++order) {
      std::vector<Word> words = accepted;
      for (Word& word : words) word.arrives = below(static_cast<std::uint32_t>(word.tick));
      for (int noise = 0; noise < 20; ++noise) {  // Too late, each of them.
        const std::uint64_t tick = 1 + below(kTicks - 2);
        words.push_back({below(2), tick, tick + below(static_cast<std::uint32_t>(kTicks - tick))});
      }
      std::shuffle(words.begin(), words.end(), random);
      log_ = {};
      RoomOptions options;
      options.policy.axes[1] = WhenMissing::kNeutral;
      open_with(options);
      const std::array<PeerId, 2> ids = {enter(0), enter(1)};
      for (std::uint64_t made = 0; made < kTicks; ++made) {
        for (const Word& word : words) {
          if (word.arrives != made) continue;
          const int value = static_cast<int>(word.tick * 700 + word.seat * 91) % 32768;
          say(ids[word.seat], protocol::Input{word.tick, say_all(value, 3)});
        }
        run(1);
        for (const PeerId id : ids) (void)hear(id);
      }
      ASSERT_EQ(log_.ticks.size(), kTicks);
      if (order == 0) first = log_.ticks;
      for (std::size_t i = 0; i < kTicks; ++i) {
        ASSERT_EQ(log_.ticks[i].frame, first[i].frame) << "round " << round;
        ASSERT_EQ(log_.ticks[i].digest, first[i].digest) << "round " << round;
      }
      EXPECT_GT(room_->statistics().inputs_late, 0u);
    }
  }
}

}  // namespace
}  // namespace cycloid::server
