#include "client/replica/lead.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/client/simulated_room.hpp"

namespace cycloid::client {
namespace {

scenes::Scene small_scene() {
  return std::move(*scenes::find("half-pipe").scene);
}

/// Worst margins of the ticks from `from` on that heard of any input.
std::vector<std::int32_t> heard(const SimulatedRoom::Seat& seat, std::size_t from) {
  std::vector<std::int32_t> margins;
  for (std::size_t i = from; i < seat.margins.size(); ++i)
    if (seat.margins[i] != std::numeric_limits<std::int32_t>::max())
      margins.push_back(seat.margins[i]);
  return margins;
}

/// Replaced inputs of ticks from `from` on.
std::size_t replaced_from(const SimulatedRoom::Seat& seat, std::uint64_t from) {
  const auto& ticks = seat.replaced_ticks;
  return static_cast<std::size_t>(
      std::count_if(ticks.begin(), ticks.end(), [from](std::uint64_t at) { return at >= from; }));
}

TEST(Lead, OnLocalhostNoInputIsEverReplaced) {
  const scenes::Scene scene = small_scene();
  SimulatedRoom room(scene, 1);
  room.sit({0, 0}, 2);
  room.run(600);
  const SimulatedRoom::Seat& seat = room.seats()[0];
  EXPECT_EQ(replaced_from(seat, 3), 0u);  // Nobody can speak for ticks before the first lead.
  EXPECT_EQ(seat.client->progress().inputs_replaced, 0u);
  for (const std::int32_t margin : heard(seat, 10)) ASSERT_EQ(margin, 1);
}

TEST(Lead, Converges20TicksTooEarlyAndTooLateToOneOrTwoTicksWithin2Seconds) {
  const scenes::Scene scene = small_scene();
  struct Case {
    std::int64_t rtt_us;
    std::uint32_t delay_ticks;
  };
  // Without jitter a lead of rtt + 3 ticks is right: these begin 20 off, either way.
  for (const Case wrong : {Case{0, 23}, Case{300000, 41}, Case{100000, 29}, Case{333340, 1},
                           Case{400000, 5}, Case{200000, 1}}) {
    SimulatedRoom room(scene, 1);
    room.sit({wrong.rtt_us, 0}, wrong.delay_ticks);
    room.run(120 + 120);
    const SimulatedRoom::Seat& seat = room.seats()[0];
    for (const std::int32_t margin : heard(seat, 120)) {
      ASSERT_GE(margin, 1) << wrong.rtt_us << " us, delay " << wrong.delay_ticks;
      ASSERT_LE(margin, 2) << wrong.rtt_us << " us, delay " << wrong.delay_ticks;
    }
    EXPECT_EQ(replaced_from(seat, 121), 0u) << wrong.rtt_us << " us";
  }
}

TEST(Lead, HoldsUnderAnyRoundTripAndJitter) {
  const scenes::Scene scene = small_scene();
  std::mt19937 random(14);
  for (int i = 0; i < 30; ++i) {
    const auto rtt_us = static_cast<std::int64_t>(random() % 300001);
    const auto jitter_us = static_cast<std::int64_t>(random() % 50001);
    const auto delay = static_cast<std::uint32_t>(1 + random() % 40);
    SimulatedRoom room(scene, static_cast<std::uint32_t>(random()));
    room.sit({rtt_us, jitter_us}, delay);
    room.run(1200);
    const SimulatedRoom::Seat& seat = room.seats()[0];
    SCOPED_TRACE(std::to_string(rtt_us) + " us, jitter " + std::to_string(jitter_us) +
                 " us, delay " + std::to_string(delay));
    EXPECT_LE(replaced_from(seat, 241), 19u) << "of 960: 2 %";
    std::vector<std::int32_t> margins = heard(seat, 240);
    std::sort(margins.begin(), margins.end());
    // The typical input has no more to spare than the jitter of both ways asks for.
    const auto spread = static_cast<std::int32_t>(2 * jitter_us / SimulatedRoom::kTickUs);
    EXPECT_LE(margins[margins.size() / 2], 4 + spread);
    EXPECT_LE(seat.client->progress().lead_ticks, LeadController::kLeadTicksMax);
  }
}

TEST(Lead, RestsWhereNothingHasToMove) {
  LeadController lead;
  lead.start(100, 5);
  for (std::uint64_t tick = 101; tick < 5000; ++tick)
    lead.take({tick, static_cast<std::int32_t>(1 + tick % 2), 1, 0}, tick + 5);
  EXPECT_EQ(lead.lead_ticks(), 5u);
  EXPECT_EQ(lead.changes(), 0u);
}

TEST(Lead, ChangesEverMoreRarelyWhereJitterNeverEnds) {
  LeadController lead;
  lead.start(0, 10);
  std::mt19937 random(3);
  std::uint64_t early_changes = 0;
  for (std::uint64_t tick = 1; tick <= 20000; ++tick) {
    const auto early = static_cast<std::int32_t>(lead.lead_ticks()) - 8 -
                       static_cast<std::int32_t>(random() % 6) - (random() % 100 == 0 ? 4 : 0);
    lead.take({tick, early, 1, 0}, tick + lead.lead_ticks());
    if (tick == 2000) early_changes = lead.changes();
  }
  EXPECT_LE(lead.changes() - early_changes, 60u) << "in 5 minutes";
}

TEST(Lead, RaisesThatNoLoweringLedToDoNotLengthenTheWatch) {
  LeadController lead;
  lead.start(0, 1);
  std::uint64_t tick = 0;
  for (int i = 0; i < 10; ++i) {
    tick += 50;
    lead.take({tick, 0, 1, 0}, tick + lead.lead_ticks());
  }
  const std::uint32_t raised = lead.lead_ticks();
  ASSERT_EQ(raised, 11u) << "by 2 at every second margin";
  const std::uint64_t begin = tick;
  while (lead.lead_ticks() == raised && tick < begin + 1000)
    lead.take({++tick, 10, 1, 0}, tick + raised);
  EXPECT_LE(tick - begin, LeadController::kWatchTicksMin + raised + 4);
  EXPECT_EQ(lead.lead_ticks(), 3u);
}

TEST(Lead, MarginsOfInputsSentBeforeAChangeAreNotHeard) {
  LeadController lead;
  lead.start(0, 2);
  lead.take({1, 0, 0, 1}, 0);
  lead.take({3, -20, 0, 3}, 5);
  EXPECT_EQ(lead.lead_ticks(), 24u);
  for (std::uint64_t tick = 4; tick < 40; ++tick) lead.take({tick, -20, 0, 1}, tick + 24);
  EXPECT_EQ(lead.lead_ticks(), 24u);
}

TEST(Lead, AbsurdMarginsStayInBounds) {
  LeadController lead;
  lead.start(0, 2);
  for (std::uint64_t tick = 1; tick < 1000; ++tick)
    lead.take({tick, std::numeric_limits<std::int32_t>::min(), 1, 1}, tick);
  EXPECT_EQ(lead.lead_ticks(), LeadController::kLeadTicksMax);
  for (std::uint64_t tick = 1000; tick < 9000; ++tick)
    lead.take({tick, std::numeric_limits<std::int32_t>::max(), 1, 0}, tick);
  EXPECT_EQ(lead.lead_ticks(), 1u);
}

TEST(Lead, AnnouncedDelayMovesTheLeadByAsMuch) {
  LeadController lead;
  lead.start(0, 2);
  lead.change_delay(6, 10);
  EXPECT_EQ(lead.lead_ticks(), 6u);
  lead.change_delay(6, 10);
  EXPECT_EQ(lead.changes(), 1u);
  lead.change_delay(1, 10);
  EXPECT_EQ(lead.lead_ticks(), 1u);
}

}  // namespace
}  // namespace cycloid::client
