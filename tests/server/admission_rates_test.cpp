#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "protocol/text.hpp"
#include "server/admission/refill_bucket.hpp"
#include "server/admission/refusal_log.hpp"
#include "tests/server/admission_fixture.hpp"

namespace cycloid::server {
namespace {

using protocol::Refusal;
__extension__ typedef __int128 Wide;

constexpr std::int64_t kOneSecond_ns = 1'000'000'000;

struct Take {
  std::int64_t at_ns = 0;
  std::uint32_t count = 0;
};

/// The rate, the burst and the times of a case, of very different sizes.
std::uint32_t any_size(std::mt19937_64& random) {
  return 1 + static_cast<std::uint32_t>(random() >> (32 + random() % 31));
}

TEST(RefillBucket, NeverGrantsMoreThanItsBurstAndItsRateInAnyInterval) {
  std::mt19937_64 random(3);
  for (int round = 0; round < 300; ++round) {
    const Rate rate{any_size(random), any_size(random)};
    RefillBucket bucket(rate, 0);
    std::vector<Take> taken;
    std::int64_t now_ns = 0;
    for (int i = 0; i < 100; ++i) {
      now_ns += static_cast<std::int64_t>(random() >> (20 + random() % 40));
      const std::uint32_t count = any_size(random) % (rate.burst + 2u);
      if (bucket.take(count, now_ns)) taken.push_back({now_ns, count});
    }
    for (std::size_t first = 0; first < taken.size(); ++first) {
      Wide sum = 0;
      for (std::size_t last = first; last < taken.size(); ++last) {
        sum += taken[last].count;
        const Wide elapsed_ns = taken[last].at_ns - taken[first].at_ns;
        ASSERT_LE(sum * kOneSecond_ns, Wide{rate.burst} * kOneSecond_ns + elapsed_ns * rate.per_s)
            << "round " << round;
      }
    }
  }
}

TEST(RefillBucket, GrantsExactlyWhatAnUnboundedNumberWould) {
  std::mt19937_64 random(4);
  int granted = 0;
  int refused = 0;
  for (int round = 0; round < 300; ++round) {
    const Rate rate{any_size(random), any_size(random)};
    RefillBucket bucket(rate, 0);
    const Wide capacity = Wide{rate.burst} * kOneSecond_ns;
    Wide level = capacity;
    std::int64_t now_ns = 0;
    for (int i = 0; i < 100; ++i) {
      const auto elapsed_ns = static_cast<std::int64_t>(random() >> (20 + random() % 40));
      now_ns += elapsed_ns;
      level = std::min(capacity, level + Wide{elapsed_ns} * rate.per_s);
      const std::uint32_t count = any_size(random) % (rate.burst + 2u);
      const bool expected = Wide{count} * kOneSecond_ns <= level;
      ASSERT_EQ(bucket.full(now_ns), level == capacity);
      ASSERT_EQ(bucket.has(count, now_ns), expected);
      ASSERT_EQ(bucket.take(count, now_ns), expected) << "round " << round << " step " << i;
      if (expected) level -= Wide{count} * kOneSecond_ns;
      ++(expected ? granted : refused);
    }
  }
  EXPECT_GT(granted, 1000);
  EXPECT_GT(refused, 1000);
}

TEST(RefillBucket, AClockThatGoesBackStandsStill) {
  RefillBucket bucket({1000, 10}, 5 * kOneSecond_ns);
  EXPECT_TRUE(bucket.take(10, 5 * kOneSecond_ns));
  EXPECT_FALSE(bucket.take(1, 0));
  EXPECT_FALSE(bucket.take(1, 5 * kOneSecond_ns));
  EXPECT_TRUE(bucket.take(1, 5 * kOneSecond_ns + 1'000'000));
}

TEST(RefillBucket, WithoutARateHasNoLimit) {
  RefillBucket bucket({0, 0}, 0);
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(bucket.take(4'000'000'000u, 0));
  EXPECT_TRUE(bucket.full(0));
}

TEST(RefusalLog, WritesACauseOnceAndCountsTheRest) {
  RefusalLog log;
  const PeerAddress from = PeerAddress::v4({192, 0, 2, 7});
  EXPECT_TRUE(log.note(Refusal::kTooSlow, from, 0).write);
  for (int i = 0; i < 1000; ++i) EXPECT_FALSE(log.note(Refusal::kTooSlow, from, i).write);
  EXPECT_TRUE(log.note(Refusal::kTokenUsed, from, 0).write);
  EXPECT_TRUE(log.note(Refusal::kTooSlow, PeerAddress::v4({192, 0, 2, 8}), 0).write);
  const RefusalLog::Line later = log.note(Refusal::kTooSlow, from, 60 * kOneSecond_ns);
  EXPECT_TRUE(later.write);
  EXPECT_EQ(later.suppressed, 1000u);
  EXPECT_EQ(log.suppressed_total(), 1000u);
}

TEST(RefusalLog, ManyCausesAreLimitedTogetherAndNoneIsLostFromTheCount) {
  RefusalLogOptions options;
  options.lines = {5, 20};
  options.causes_max = 64;
  RefusalLog log(options);
  std::uint64_t written = 0;
  std::uint64_t suppressed = 0;
  constexpr std::uint32_t kRefusals = 100'000;
  for (std::uint32_t i = 0; i < kRefusals; ++i) {
    const auto byte = [i](int shift) { return static_cast<std::uint8_t>(i >> shift); };
    const PeerAddress from = PeerAddress::v4({10, byte(16), byte(8), byte(0)});
    const RefusalLog::Line line =
        log.note(Refusal::kTooSlow, from, std::int64_t{i} * kOneSecond_ns / 10'000);
    written += line.write ? 1 : 0;
    suppressed += line.suppressed;
  }
  EXPECT_LE(written, 20u + 5u * 10u);
  EXPECT_GE(written, 20u + 5u * 9u);
  EXPECT_EQ(written + log.suppressed_total(), kRefusals);
  EXPECT_LE(suppressed, log.suppressed_total());
}

TEST(RefusalLog, LinesNameTheCodeAndHoldNoControlCharacters) {
  const PeerAddress from = PeerAddress::v4({192, 0, 2, 7});
  EXPECT_EQ(refusal_line(Refusal::kTokenScope, "room \"a\nb\x1b[2J\" is wished", from, 0),
            "refused 192.0.2.7: kTokenScope (15): room \"a?b?[2J\" is wished");
  EXPECT_EQ(refusal_line(Refusal::kTooSlow, "no hello", from, 3),
            "refused 192.0.2.7: kTooSlow (9): no hello (and 3 more since)");
  EXPECT_LT(refusal_line(Refusal::kTooSlow, std::string(5000, 'x'), from, 0).size(), 320u);
  EXPECT_STREQ(protocol::refusal_name(Refusal::kProtocolVersion), "kProtocolVersion");
  EXPECT_STREQ(protocol::refusal_name(protocol::kLastRefusal), "kResyncLimit");
  EXPECT_STREQ(protocol::refusal_name(static_cast<Refusal>(0)), "an unknown code");
  EXPECT_STREQ(protocol::refusal_name(static_cast<Refusal>(23)), "an unknown code");
}

}  // namespace
}  // namespace cycloid::server
