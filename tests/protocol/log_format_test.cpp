#include "protocol/log_format.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/protocol/samples.hpp"

namespace cycloid::protocol {
namespace {

constexpr std::uint64_t kTicks = 5;

/// Whole ticks among the first `bytes` of the sample.
std::size_t whole_ticks(const samples::LogSample& sample, std::size_t bytes) {
  std::size_t ticks = 0;
  for (std::size_t i = 1; i + 1 < sample.ends.size(); ++i) ticks += sample.ends[i] <= bytes ? 1 : 0;
  return ticks;
}

void expect_prefix(const Log& log, std::size_t ticks) {
  ASSERT_EQ(log.ticks.size(), ticks);
  for (std::size_t i = 0; i < ticks; ++i) {
    EXPECT_EQ(log.ticks[i].frame, samples::log_tick(i + 1).frame);
    EXPECT_EQ(log.ticks[i].digest, 1001 + i);
  }
}

TEST(LogFormat, AWholeLogComesBack) {
  const samples::LogSample sample = samples::log_sample(kTicks);
  const Log log = read_log(sample.bytes);
  EXPECT_EQ(log.state, LogState::kComplete) << log.reason;
  EXPECT_EQ(log.reason, "");
  EXPECT_EQ(log.good_bytes, sample.bytes.size());
  EXPECT_EQ(log.header.scene_digest, 0x77u);
  EXPECT_EQ(log.header.salt, 0x5a17u);
  EXPECT_EQ(log.header.scene_name, "two balls");
  EXPECT_EQ(log.header.scene, samples::log_header().scene);
  expect_prefix(log, kTicks);
  ASSERT_TRUE(log.footer);
  EXPECT_EQ(log.footer->ticks, kTicks);
  EXPECT_EQ(log.footer->digest, 1000 + kTicks);
}

TEST(LogFormat, AMatchWithoutTicksIsComplete) {
  EXPECT_EQ(read_log(samples::log_sample(0).bytes).state, LogState::kComplete);
}

/// A kill at any moment leaves a prefix, cut anywhere.
TEST(LogFormat, CutAtEveryByteThePrefixIsGood) {
  const samples::LogSample sample = samples::log_sample(kTicks);
  for (std::size_t size = sample.ends[0]; size < sample.bytes.size(); ++size) {
    const Log log = read_log(std::span<const std::byte>(sample.bytes).first(size));
    const bool at_end = std::ranges::find(sample.ends, size) != sample.ends.end();
    EXPECT_EQ(log.state, at_end ? LogState::kOpen : LogState::kTorn) << size;
    EXPECT_FALSE(log.footer);
    expect_prefix(log, whole_ticks(sample, size));
    EXPECT_EQ(log.good_bytes, sample.ends[log.ticks.size()]) << size;
    EXPECT_FALSE(log.reason.empty());
  }
}

TEST(LogFormat, CutInTheHeaderItIsNoLog) {
  const samples::LogSample sample = samples::log_sample(1);
  for (std::size_t size = 0; size < sample.ends[0]; ++size) {
    const Log log = read_log(std::span<const std::byte>(sample.bytes).first(size));
    EXPECT_EQ(log.state, LogState::kCorrupt) << size;
    EXPECT_EQ(log.good_bytes, 0u);
  }
}

/// Every bit of a small log: no flip goes unnoticed, and each is told apart by where it is. A
/// format version that is not ours is another format.
TEST(LogFormat, EveryBitFlipIsDetectedAndPlaced) {
  samples::LogSample sample = samples::log_sample(kTicks);
  const std::size_t last_record = sample.ends[sample.ends.size() - 2];
  for (std::size_t bit = 0; bit < sample.bytes.size() * 8; ++bit) {
    const std::size_t byte = bit / 8;
    sample.bytes[byte] ^= static_cast<std::byte>(1u << (bit % 8));
    const Log log = read_log(sample.bytes);
    LogState expected = byte < last_record ? LogState::kCorrupt : LogState::kTorn;
    if (byte >= 8 && byte < 12) expected = LogState::kIncompatible;
    EXPECT_EQ(log.state, expected) << "byte " << byte << " bit " << bit % 8 << ": " << log.reason;
    EXPECT_FALSE(log.footer);
    if (byte >= sample.ends[0]) expect_prefix(log, whole_ticks(sample, byte));
    sample.bytes[byte] ^= static_cast<std::byte>(1u << (bit % 8));
  }
}

/// A later record proves that the damage is no interrupted write.
TEST(LogFormat, AZeroedRecordInTheMiddleIsCorruption) {
  samples::LogSample sample = samples::log_sample(kTicks);
  std::fill(sample.bytes.begin() + static_cast<std::ptrdiff_t>(sample.ends[2]),
            sample.bytes.begin() + static_cast<std::ptrdiff_t>(sample.ends[3]), std::byte{0});
  const Log log = read_log(sample.bytes);
  EXPECT_EQ(log.state, LogState::kCorrupt);
  EXPECT_EQ(log.reason, "a damaged record at byte " + std::to_string(sample.ends[2]));
  expect_prefix(log, 2);
}

TEST(LogFormat, ALostRecordIsCorruption) {
  samples::LogSample sample = samples::log_sample(kTicks);
  sample.bytes.erase(sample.bytes.begin() + static_cast<std::ptrdiff_t>(sample.ends[2]),
                     sample.bytes.begin() + static_cast<std::ptrdiff_t>(sample.ends[3]));
  const Log log = read_log(sample.bytes);
  EXPECT_EQ(log.state, LogState::kCorrupt);
  expect_prefix(log, 2);
}

/// What a recycled disk block leaves behind the end: whole records, but of another file.
TEST(LogFormat, ATailOfAnotherLogIsNotTaken) {
  const samples::LogSample other = samples::log_sample(kTicks, 0xbad);
  samples::LogSample sample = samples::log_sample(kTicks);
  sample.bytes.resize(sample.ends[3]);
  sample.bytes.insert(sample.bytes.end(),
                      other.bytes.begin() + static_cast<std::ptrdiff_t>(other.ends[3]),
                      other.bytes.end());
  const Log log = read_log(sample.bytes);
  EXPECT_EQ(log.state, LogState::kTorn);
  EXPECT_EQ(log.good_bytes, sample.ends[3]);
  expect_prefix(log, 3);
}

TEST(LogFormat, BytesBehindTheFooterAreCorruption) {
  samples::LogSample sample = samples::log_sample(kTicks);
  sample.bytes.push_back(std::byte{0});
  EXPECT_EQ(read_log(sample.bytes).state, LogState::kCorrupt);
}

TEST(LogFormat, AFooterOfAnotherMatchIsCorruption) {
  Bytes bytes;
  LogEncoder encoder(samples::log_header(), bytes);
  encoder.tick(samples::log_tick(1), bytes);
  encoder.footer({1, 4711}, bytes);
  EXPECT_EQ(read_log(bytes).state, LogState::kCorrupt);
}

TEST(LogFormat, ATickOutOfOrderIsCorruption) {
  Bytes bytes;
  LogEncoder encoder(samples::log_header(), bytes);
  encoder.tick(samples::log_tick(2), bytes);
  const Log log = read_log(bytes);
  EXPECT_EQ(log.state, LogState::kCorrupt);
  EXPECT_EQ(log.reason.substr(0, 19), "tick 2 instead of 1");
}

TEST(LogFormat, OtherVersionsAreNamedWithBothValues) {
  LogHeader header = samples::log_header();
  header.solver_version = solver::kSolverVersion + 1;
  Bytes bytes;
  LogEncoder newer(header, bytes);
  Log log = read_log(bytes);
  EXPECT_EQ(log.state, LogState::kIncompatible);
  EXPECT_EQ(log.reason, "solver version " + std::to_string(solver::kSolverVersion + 1) + ", here " +
                            std::to_string(solver::kSolverVersion));
  header = samples::log_header();
  header.protocol_version = kProtocolVersion + 1;
  bytes.clear();
  LogEncoder other(header, bytes);
  EXPECT_EQ(read_log(bytes).state, LogState::kIncompatible);
}

}  // namespace
}  // namespace cycloid::protocol
