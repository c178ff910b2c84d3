#include <gtest/gtest.h>

#include <deque>
#include <random>

#include "tests/server/room_fixture.hpp"

namespace cycloid::server {
namespace {

DelayPolicy adaptive() {
  DelayPolicy policy;
  policy.adaptive = true;
  return policy;
}

TEST(DelayController, AFixedDelayStays) {
  DelayController controller({}, 2, 60000);
  for (int tick = 0; tick < 1000; ++tick) {
    EXPECT_FALSE(controller.on_tick({true, true, 5}));
  }
  EXPECT_EQ(controller.ticks(), 2u);
}

TEST(DelayController, RisesByWhatWasMissingAndNotInTheFirstTicks) {
  DelayController controller(adaptive(), 2, 60000);
  std::uint64_t raised = 0;
  for (std::uint64_t tick = 1; tick <= 200 && raised == 0; ++tick) {
    if (controller.on_tick({true, true, 6})) raised = tick;
  }
  EXPECT_GE(raised, DelayController::kFirstTicks);
  EXPECT_LE(raised, DelayController::kFirstTicks + DelayController::kWindowTicks);
  EXPECT_EQ(controller.ticks(), 8u);
}

TEST(DelayController, SilenceIsNoReason) {
  DelayController controller(adaptive(), 2, 60000);
  for (int tick = 0; tick < 1000; ++tick) (void)controller.on_tick({true, true, 0});
  EXPECT_EQ(controller.ticks(), 2u);
}

TEST(DelayController, OneSpikeIsNoReason) {
  DelayController controller(adaptive(), 2, 60000);
  for (int tick = 0; tick < 600; ++tick) {
    const bool spike = tick % 300 >= 200 && tick % 300 < 220;
    (void)controller.on_tick({spike, spike, spike ? 12u : 0u});
  }
  EXPECT_EQ(controller.ticks(), 2u);
}

TEST(DelayController, FallsAfterTenGoodSecondsAndToItsLeast) {
  DelayController controller(adaptive(), 4, 60000);
  std::vector<std::uint64_t> changes;
  for (std::uint64_t tick = 1; tick <= 6000; ++tick) {
    if (controller.on_tick({})) changes.push_back(tick);
  }
  EXPECT_EQ(changes, (std::vector<std::uint64_t>{600, 1200, 1800}));
  EXPECT_EQ(controller.ticks(), 1u);
}

TEST(DelayController, DoesNotFallToWhereItWouldRiseAgain) {
  DelayController controller(adaptive(), 4, 60000);
  for (int tick = 0; tick < 6000; ++tick) {
    (void)controller.on_tick({false, tick % 50 == 0, 0});
  }
  EXPECT_EQ(controller.ticks(), 4u) << "2 % would have been missed";
}

class RoomDelay : public RoomTest {
 protected:
  /// A client at the other end of a line, which sends the input of a tick when it has seen the
  /// tick that lies the room's delay before.
  struct Distant {
    PeerId id = kNobody;
    std::deque<std::pair<std::int64_t, protocol::ServerMessage>> down{};
    std::deque<std::pair<std::int64_t, protocol::ClientMessage>> up{};
    std::uint64_t delay_ticks = 0;
    std::uint64_t next = 0;
  };

  void exchange(Distant& client, std::int64_t one_way_ns) {
    for (auto& message : hear(client.id)) {
      client.down.push_back({now_ + one_way_ns, std::move(message)});
    }
    while (!client.down.empty() && client.down.front().first <= now_) {
      const protocol::ServerMessage message = std::move(client.down.front().second);
      client.down.pop_front();
      std::uint64_t seen = 0;
      if (const auto* welcome = std::get_if<protocol::Welcome>(&message)) {
        client.delay_ticks = welcome->input_delay_ticks;
        seen = welcome->tick;
      }
      if (const auto* frame = std::get_if<protocol::InputFrame>(&message)) {
        for (const auto& change : frame->changes) client.delay_ticks = change.value;
        seen = frame->tick;
      }
      if (seen == 0) continue;
      client.next = std::max(client.next, seen);
      for (; client.next <= seen + client.delay_ticks; ++client.next) {
        const protocol::Input input{client.next, push(static_cast<int>(client.next % 100))};
        client.up.push_back({now_ + one_way_ns, input});
      }
    }
    while (!client.up.empty() && client.up.front().first <= now_) {
      say(client.id, client.up.front().second);
      client.up.pop_front();
    }
  }
};

TEST_F(RoomDelay, FollowsALineThatGetsLongerAndEveryChangeIsInAFrame) {
  RoomOptions options;
  options.delay.adaptive = true;
  open_with(options);
  std::array<Distant, 2> clients{Distant{join(0)}, Distant{join(1)}};
  constexpr std::uint64_t kLonger = 1200;
  constexpr std::uint64_t kEnd = 6000;
  std::uint64_t replaced_before_settled = 0;
  std::mt19937 random(7);
  while (room_->tick() < kEnd) {
    now_ += 1'000'000;
    const std::int64_t base_ns = room_->tick() < kLonger ? 20'000'000 : 90'000'000;
    for (Distant& client : clients) {
      exchange(client, base_ns + static_cast<std::int64_t>(random() % 2'000'000));
    }
    if (now_ >= room_->next_deadline_ns()) room_->advance();
    if (room_->tick() == kLonger + 600) {
      replaced_before_settled = room_->statistics().inputs_replaced;
    }
  }
  const std::uint64_t replaced = room_->statistics().inputs_replaced - replaced_before_settled;
  const double settled_inputs = 2.0 * static_cast<double>(kEnd - kLonger - 600);
  EXPECT_LT(static_cast<double>(replaced), 0.01 * settled_inputs) << replaced;
  EXPECT_GT(room_->input_delay_ticks(), 10u);

  std::vector<std::uint64_t> changes;
  std::uint32_t delay = 2;
  for (const protocol::LogTick& tick : log_.ticks) {
    for (const auto& change : tick.frame.changes) {
      EXPECT_EQ(change.kind, protocol::ChangeKind::kInputDelay);
      delay = change.value;
      changes.push_back(tick.frame.tick);
    }
  }
  EXPECT_EQ(delay, room_->input_delay_ticks()) << "the log has the last of them";
  ASSERT_GE(changes.size(), 2u);
  for (std::size_t i = 1; i < changes.size(); ++i) EXPECT_GE(changes[i] - changes[i - 1], 120u);
}

/// Five seconds in which the process is not run.
TEST_F(RoomDelay, ALongStallIsABoundedBurstThatIsSaidAndChangesNoBit) {
  const auto play = [&](bool stalls) {
    log_ = {};
    open();
    const PeerId id = join(0);
    std::vector<protocol::RoomNotice> notices;
    for (std::uint64_t tick = 1; tick <= 300; ++tick) {
      say(id, protocol::Input{tick, push(static_cast<int>(tick) * 50)});
      if (stalls && tick == 100) {
        for (std::uint64_t ahead = tick + 1; ahead <= tick + 20; ++ahead) {
          say(id, protocol::Input{ahead, push(static_cast<int>(ahead) * 50)});
        }
        const std::uint64_t before = room_->tick();
        now_ += 5'000'000'000;
        room_->advance();
        EXPECT_LE(room_->tick() - before, 8u);
        tick = room_->tick();
      } else {
        run(1);
      }
      for (const auto& notice : only<protocol::RoomNotice>(hear(id))) notices.push_back(notice);
    }
    return notices;
  };
  EXPECT_TRUE(play(false).empty());
  const std::vector<protocol::LogTick> straight = log_.ticks;
  const auto notices = play(true);
  ASSERT_EQ(notices.size(), 1u);
  EXPECT_EQ(notices[0].kind, protocol::NoticeKind::kSlowed);
  EXPECT_NEAR(static_cast<double>(notices[0].value), 5000.0 - 8.0 * 16.7, 20.0) << "ms";
  ASSERT_EQ(log_.ticks.size(), straight.size());
  for (std::size_t i = 0; i < straight.size(); ++i) {
    ASSERT_EQ(log_.ticks[i].frame, straight[i].frame);
    ASSERT_EQ(log_.ticks[i].digest, straight[i].digest);
  }
}

/// An hour of ticks at a rate that is no whole number of nanoseconds.
TEST(Pacer, DriftsLessThanANanosecond) {
  const Pacer pacer(0, 60000);
  const std::int64_t hour_ns = 3'600'000'000'000;
  EXPECT_EQ(pacer.due_ns(60 * 3600), hour_ns);
  EXPECT_EQ(pacer.due_ns(60 * 3600 * 24), 24 * hour_ns);
}

}  // namespace
}  // namespace cycloid::server
