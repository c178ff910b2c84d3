#include "server/host/life_cycle.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "server/host/room_clock.hpp"
#include "server/room/pacer.hpp"

namespace cycloid::server {
namespace {

LifeCycle at(LifeStage stage) {
  LifeCycle life;
  const auto apply = [&](LifeAct act) { EXPECT_EQ(life.apply(act), ""); };
  if (stage == LifeStage::kPaused) apply(LifeAct::kPause);
  if (stage == LifeStage::kDraining) apply(LifeAct::kDrain);
  if (stage == LifeStage::kEnded) apply(LifeAct::kEnd);
  return life;
}

TEST(LifeCycle, EveryActInEveryStageIsTakenOrRefused) {
  using S = LifeStage;
  struct Row {
    LifeAct act;
    S after_running, after_paused, after_draining;  ///< kEnded in the last: refused.
    bool running, paused, draining;                 ///< Whether it is taken.
  };
  const Row kRows[] = {
      {LifeAct::kLock, S::kRunning, S::kPaused, S::kDraining, true, true, true},
      {LifeAct::kUnlock, S::kRunning, S::kPaused, S::kDraining, false, false, false},
      {LifeAct::kPause, S::kPaused, S::kPaused, S::kDraining, true, false, false},
      {LifeAct::kResume, S::kRunning, S::kRunning, S::kDraining, false, true, false},
      {LifeAct::kDrain, S::kDraining, S::kDraining, S::kDraining, true, true, false},
      {LifeAct::kEnd, S::kEnded, S::kEnded, S::kEnded, true, true, true},
  };
  for (const Row& row : kRows) {
    const auto expect = [&](S before, S after, bool taken) {
      LifeCycle life = at(before);
      const std::string why = life.apply(row.act);
      EXPECT_EQ(why.empty(), taken) << life_stage_name(before) << ' ' << life_act_name(row.act);
      EXPECT_EQ(life.stage(), after) << life_stage_name(before) << ' ' << life_act_name(row.act);
      if (!taken) {
        EXPECT_NE(why.find(life_act_name(row.act)), std::string::npos) << why;
      }
    };
    expect(S::kRunning, row.after_running, row.running);
    expect(S::kPaused, row.after_paused, row.paused);
    expect(S::kDraining, row.after_draining, row.draining);
    expect(S::kEnded, S::kEnded, false);
  }
}

TEST(LifeCycle, ALockShutsOutNewcomersAlone) {
  LifeCycle life;
  EXPECT_TRUE(life.open());
  EXPECT_EQ(life.apply(LifeAct::kLock), "");
  EXPECT_FALSE(life.open());
  EXPECT_TRUE(life.ticking());
  EXPECT_NE(life.apply(LifeAct::kLock), "");
  EXPECT_EQ(life.apply(LifeAct::kUnlock), "");
  EXPECT_TRUE(life.open());
  EXPECT_EQ(life.apply(LifeAct::kPause), "");
  EXPECT_TRUE(life.open());
  EXPECT_FALSE(life.ticking());
  EXPECT_EQ(life.apply(LifeAct::kDrain), "");
  EXPECT_FALSE(life.open());
  EXPECT_TRUE(life.ticking());
}

TEST(RoomPhases, AreSpreadEvenlyHoweverManyRoomsThereAre) {
  EXPECT_EQ(phase_of_slot(0), 0u);
  EXPECT_EQ(phase_of_slot(1), 0x80000000u);
  EXPECT_EQ(phase_of_slot(2), 0x40000000u);
  EXPECT_EQ(phase_of_slot(3), 0xC0000000u);
  for (std::uint32_t rooms = 1; rooms <= 200; ++rooms) {
    std::vector<std::uint64_t> phases;
    for (std::uint32_t slot = 0; slot < rooms; ++slot) phases.push_back(phase_of_slot(slot));
    std::ranges::sort(phases);
    phases.push_back((std::uint64_t{1} << 32) + phases.front());
    for (std::size_t i = 1; i < phases.size(); ++i) {
      const double gap = static_cast<double>(phases[i] - phases[i - 1]) / 4294967296.0;
      EXPECT_GE(gap * rooms, 0.5) << rooms;
      EXPECT_LE(gap * rooms, 2.0) << rooms;
    }
  }
}

TEST(RoomPhases, HoldWheneverARoomIsMade) {
  constexpr std::uint32_t kRate = 60000;
  constexpr std::int64_t kEpoch = 123'456'789;
  // A second, an hour and a year after the epoch; a tick is no whole number of nanoseconds.
  for (const std::int64_t after : {0ll, 1'000'000'000ll, 3'600'000'000'000ll,
                                   31'536'000'000'000'000ll, 31'536'000'016'666'667ll}) {
    for (std::uint32_t slot = 0; slot < 8; ++slot) {
      const std::int64_t now = kEpoch + after;
      const std::int64_t start = staggered_start_ns(kEpoch, now, kRate, slot);
      EXPECT_GE(start, now);
      EXPECT_LE(start - now, 16'666'667);
      const std::int64_t phase = 16'666'666ll * phase_of_slot(slot) >> 32;
      const protocol::Schedule raster(kEpoch + phase, kRate);
      const auto n = static_cast<std::uint64_t>(static_cast<double>(start - kEpoch) * 60e-9 + 0.25);
      const std::int64_t off = std::min(std::abs(start - raster.deadline_ns(n)),
                                        std::abs(start - raster.deadline_ns(n > 0 ? n - 1 : 0)));
      EXPECT_EQ(off, 0) << after << ' ' << slot;
    }
  }
}

TEST(RoomPauses, PutTheMatchOffByWholeTicks) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  Pacer pacer(7 * kSecond, 60'000);
  const std::int64_t tick = pacer.tick_ns();
  const std::int64_t due = pacer.due_ns(100);
  for (const std::int64_t stood_ns : {std::int64_t{0}, std::int64_t{1}, tick, tick + 1, kSecond}) {
    const std::int64_t before = pacer.due_ns(100);
    pacer.pause(8 * kSecond);
    EXPECT_TRUE(pacer.paused());
    const std::int64_t by_ns = pacer.resume(8 * kSecond + stood_ns);
    EXPECT_FALSE(pacer.paused());
    EXPECT_GE(by_ns, stood_ns);
    EXPECT_LT(by_ns, stood_ns + tick);
    EXPECT_EQ(pacer.due_ns(100), before + by_ns);
    EXPECT_EQ((pacer.due_ns(100) - due) % tick, 0) << "the phase stays";
  }
}

}  // namespace
}  // namespace cycloid::server
