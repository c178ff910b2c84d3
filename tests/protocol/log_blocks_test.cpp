#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>
#include <random>

#include "protocol/crc32c.hpp"
#include "protocol/log/chunks.hpp"
#include "protocol/log_format.hpp"
#include "tests/protocol/samples.hpp"

namespace cycloid::protocol {
namespace {

/// Several blocks, with states that go over their ends.
const samples::LogSample& long_sample() {
  static const samples::LogSample kSample = samples::log_sample(3000, 0x5a17, 1500);
  return kSample;
}

std::size_t block_begin(std::size_t block) {
  return long_sample().ends[0] + block * kLogBlockBytes;
}

TEST(LogBlocks, ALongLogComesBack) {
  const samples::LogSample& sample = long_sample();
  ASSERT_GT(sample.bytes.size(), 40 * kLogBlockBytes);
  const Log log = read_log(sample.bytes);
  ASSERT_EQ(log.state, LogState::kComplete) << log.reason;
  for (std::uint64_t tick = 1; tick <= 3000; ++tick)
    ASSERT_EQ(log.ticks[tick - 1].frame, samples::log_tick(tick).frame) << tick;
  EXPECT_EQ(log.keyframes.size(), 1500u);
}

/// Around the ends of blocks every cut leaves what was whole before it.
TEST(LogBlocks, CutAroundTheEndOfABlockThePrefixIsGood) {
  const samples::LogSample& sample = long_sample();
  for (const std::size_t block : {1, 2, 3, 17}) {
    for (std::size_t size = block_begin(block) - 40; size < block_begin(block) + 60; ++size) {
      const LogSummary log = scan_log(std::span<const std::byte>(sample.bytes).first(size));
      const auto next = std::ranges::upper_bound(sample.ends, size);
      const auto record = static_cast<std::size_t>(next - sample.ends.begin() - 1);
      EXPECT_TRUE(log.state == LogState::kOpen || log.state == LogState::kTorn) << size;
      EXPECT_EQ(log.last_tick, sample.ticks_until[record]) << size;
      EXPECT_LE(log.good_bytes, size);
    }
  }
}

TEST(LogBlocks, FlipsAroundTheEndOfABlockAreCorruption) {
  samples::LogSample sample = long_sample();
  for (std::size_t byte = block_begin(2) - 30; byte < block_begin(2) + 60; ++byte) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      sample.bytes[byte] ^= static_cast<std::byte>(1u << bit);
      const LogSummary log = scan_log(sample.bytes);
      EXPECT_EQ(log.state, LogState::kCorrupt) << byte << ": " << log.reason;
      EXPECT_LE(log.good_bytes, byte);
      sample.bytes[byte] ^= static_cast<std::byte>(1u << bit);
    }
  }
}

/// Where a block has no room for another chunk its rest is zeros, which no check covers.
TEST(LogBlocks, FlipsOfTheRestOfABlockAreCorruption) {
  constexpr std::size_t kLeastChunk = kChunkHeadBytes + 1 + kCheckBytes;
  samples::LogSample sample = long_sample();
  int flips = 0;
  for (const std::size_t end : long_sample().ends) {
    const std::size_t rest = kLogBlockBytes - (end - sample.ends[0]) % kLogBlockBytes;
    if (rest >= kLeastChunk || end == sample.bytes.size()) continue;
    for (std::size_t byte = end; byte < end + rest; ++byte, ++flips) {
      sample.bytes[byte] ^= std::byte{1};
      EXPECT_EQ(scan_log(sample.bytes).state, LogState::kCorrupt) << byte;
      sample.bytes[byte] ^= std::byte{1};
    }
  }
  EXPECT_GT(flips, 0);
}

TEST(LogBlocks, ALostOrRepeatedBlockIsCorruption) {
  const samples::LogSample& sample = long_sample();
  const auto at = [&](std::size_t block) {
    return sample.bytes.begin() + static_cast<std::ptrdiff_t>(block_begin(block));
  };
  Bytes lost(sample.bytes.begin(), at(3));
  lost.insert(lost.end(), at(4), sample.bytes.end());
  EXPECT_EQ(scan_log(lost).state, LogState::kCorrupt);
  Bytes repeated(sample.bytes.begin(), at(4));
  repeated.insert(repeated.end(), at(3), sample.bytes.end());
  EXPECT_EQ(scan_log(repeated).state, LogState::kCorrupt);
}

/// What stands behind damage says how much is lost.
TEST(LogBlocks, BehindDamageAGoodBlockSaysHowFarTheMatchWent) {
  samples::LogSample sample = long_sample();
  std::fill_n(sample.bytes.begin() + static_cast<std::ptrdiff_t>(block_begin(1) + 50), 100,
              std::byte{0xaa});
  const LogSummary log = scan_log(sample.bytes);
  EXPECT_EQ(log.state, LogState::kCorrupt);
  ASSERT_TRUE(log.tick_behind);
  EXPECT_GT(*log.tick_behind, 2900u);
  EXPECT_LE(*log.tick_behind, 3001u);
  EXPECT_LT(log.last_tick, 150u);
}

/// A whole block of something else, then only a part of one whose head is damaged, too.
TEST(LogBlocks, AChunkBehindADamagedHeadIsFound) {
  samples::LogSample sample = samples::log_sample(1200);
  const std::size_t begin = sample.ends[0] + kLogBlockBytes;
  ASSERT_GT(sample.bytes.size(), begin + 200);
  ASSERT_LT(sample.bytes.size(), begin + kLogBlockBytes);
  std::fill(sample.bytes.begin() + static_cast<std::ptrdiff_t>(begin - 2000),
            sample.bytes.begin() + static_cast<std::ptrdiff_t>(begin + 40), std::byte{0x55});
  EXPECT_EQ(scan_log(sample.bytes).state, LogState::kCorrupt);
}

/// A file system that had given the file its length, and not its bytes.
TEST(LogBlocks, AnythingBehindATornRecordThatIsOfNoLogIsTorn) {
  const samples::LogSample& sample = long_sample();
  std::mt19937_64 random(1);
  for (const bool zeros : {true, false}) {
    Bytes bytes(sample.bytes.begin(), sample.bytes.begin() + 100000);
    for (int i = 0; i < 300000; ++i)
      bytes.push_back(zeros ? std::byte{0} : static_cast<std::byte>(random()));
    const LogSummary log = scan_log(bytes);
    EXPECT_EQ(log.state, LogState::kTorn) << log.reason;
    EXPECT_GT(log.last_tick, 100u);
  }
}

/// The worst that can stand behind damage: heads of a chunk of 8000 bytes, everywhere. To take the
/// check of each would cost 8000 steps a byte. In processor time of this thread, beside plain
/// checks of the same bytes, so that other work on the machine makes no difference.
TEST(LogBlocks, TheSearchBehindDamageIsLinear) {
  const Bytes whole = samples::log_sample(3).bytes;
  Bytes bytes(whole.begin(), whole.end() - 3);
  for (std::size_t i = 0; i < 8 * kLogBlockBytes; ++i)
    bytes.push_back(std::byte{static_cast<unsigned char>(i % 2 == 0 ? 0x40 : 0x5f)});
  const auto seconds_of = [](const auto& work) {
    const auto now = [] {
      timespec time{};
      (void)::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
      return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
    };
    const double start = now();
    work();
    return now() - start;
  };
  double search_s = 1e9;
  double check_s = 1e9;
  std::uint32_t check = 0;
  for (int round = 0; round < 5; ++round) {
    check_s = std::min(check_s, seconds_of([&] { check ^= crc32c(bytes); }));
    const auto search = [&] { EXPECT_EQ(scan_log(bytes).state, LogState::kTorn); };
    search_s = std::min(search_s, seconds_of(search));
  }
  EXPECT_NE(check, 0u);
  std::printf("the search takes the time of %.0f checks\n", search_s / check_s);
  EXPECT_LT(search_s, 400 * check_s);
}

}  // namespace
}  // namespace cycloid::protocol
