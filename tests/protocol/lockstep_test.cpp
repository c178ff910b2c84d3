#include "protocol/lockstep.hpp"

#include <gtest/gtest.h>

namespace cycloid::protocol {
namespace {

TEST(InputWindow, HoldsTheNextSixtyFourTicks) {
  EXPECT_EQ(timing(100, 99), Timing::kLate);
  EXPECT_EQ(timing(100, 100), Timing::kLate);
  EXPECT_EQ(timing(100, 101), Timing::kInTime);
  EXPECT_EQ(timing(100, 164), Timing::kInTime);
  EXPECT_EQ(timing(100, 165), Timing::kEarly);
  EXPECT_EQ(timing(0, ~std::uint64_t{0}), Timing::kEarly);
  EXPECT_EQ(timing(~std::uint64_t{0}, 1), Timing::kLate);
}

TEST(Schedule, SixtyHertzIsExactAfterAMonth) {
  const Schedule schedule(5, 60'000);
  EXPECT_EQ(schedule.deadline_ns(0), 5);
  EXPECT_EQ(schedule.deadline_ns(1), 5 + 16'666'666);
  EXPECT_EQ(schedule.deadline_ns(2), 5 + 33'333'333);
  EXPECT_EQ(schedule.deadline_ns(3), 5 + 50'000'000);
  const std::uint64_t month_s = 30ull * 24 * 3600;
  EXPECT_EQ(schedule.deadline_ns(month_s * 60),
            5 + static_cast<std::int64_t>(month_s) * 1'000'000'000);
}

TEST(Schedule, ADelayMovesAllDeadlines) {
  Schedule schedule(0, 1'000'000);
  schedule.delay(7);
  EXPECT_EQ(schedule.deadline_ns(10), 10'000'007);
}

}  // namespace
}  // namespace cycloid::protocol
