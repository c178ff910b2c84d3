#include "protocol/log_format.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "protocol/little_endian.hpp"
#include "protocol/log/records.hpp"
#include "solver/version.hpp"
#include "tests/protocol/samples.hpp"

namespace cycloid::protocol {
namespace {

constexpr std::uint64_t kTicks = 7;

void expect_log_prefix(const Log& log, std::uint64_t ticks) {
  ASSERT_EQ(log.ticks.size(), ticks);
  EXPECT_EQ(log.last_tick, ticks);
  for (std::uint64_t tick = 1; tick <= ticks; ++tick) {
    const LogTick expected = samples::log_tick(tick);
    EXPECT_EQ(log.ticks[tick - 1].frame, expected.frame) << tick;
    EXPECT_EQ(log.ticks[tick - 1].digest, expected.digest);
  }
}

TEST(LogFormat, AWholeLogComesBack) {
  const samples::LogSample sample = samples::log_sample(kTicks, 0x5a17, 100);
  const Log log = read_log(sample.bytes);
  EXPECT_EQ(log.state, LogState::kComplete) << log.reason;
  EXPECT_EQ(log.reason, "");
  EXPECT_EQ(log.good_bytes, sample.bytes.size());
  EXPECT_EQ(log.lost_bytes, 0u);
  const LogHeader wanted = samples::log_header();
  EXPECT_EQ(log.header.scene_digest, wanted.scene_digest);
  EXPECT_EQ(log.header.salt, wanted.salt);
  EXPECT_EQ(log.header.schema, kLogSchema);
  EXPECT_EQ(log.header.tick_rate_millihertz, wanted.tick_rate_millihertz);
  EXPECT_EQ(log.header.start_unix_ns, wanted.start_unix_ns);
  EXPECT_EQ(log.header.log_id, wanted.log_id);
  EXPECT_EQ(log.header.parent_log_id, 0u);
  EXPECT_EQ(log.header.build, wanted.build);
  EXPECT_EQ(log.header.room, wanted.room);
  EXPECT_EQ(log.header.scene_name, wanted.scene_name);
  EXPECT_EQ(log.header.scene, wanted.scene);
  expect_log_prefix(log, kTicks);
  ASSERT_TRUE(log.footer);
  EXPECT_EQ(log.footer->ticks, kTicks);
  EXPECT_EQ(log.footer->digest, 1000 + kTicks);
  EXPECT_EQ(log.footer->keyframes, log.keyframes);
  EXPECT_EQ(log.keyframes.size(), kTicks / 2);
}

TEST(LogFormat, AMatchWithoutTicksIsComplete) {
  EXPECT_EQ(read_log(samples::log_sample(0).bytes).state, LogState::kComplete);
}

/// A kill at any moment leaves a prefix, cut anywhere.
TEST(LogFormat, CutAtEveryByteThePrefixIsGood) {
  const samples::LogSample sample = samples::log_sample(kTicks, 0x5a17, 60);
  for (std::size_t size = sample.ends[0]; size < sample.bytes.size(); ++size) {
    const Log log = read_log(std::span<const std::byte>(sample.bytes).first(size));
    const auto next = std::ranges::upper_bound(sample.ends, size);
    const auto record = static_cast<std::size_t>(next - sample.ends.begin() - 1);
    const bool whole_head = size == sample.ends[0] + kBlockHeadBytes;
    const bool at_end = sample.ends[record] == size || whole_head;
    EXPECT_EQ(log.state, at_end ? LogState::kOpen : LogState::kTorn) << size;
    EXPECT_FALSE(log.footer);
    expect_log_prefix(log, sample.ticks_until[record]);
    EXPECT_EQ(log.good_bytes, whole_head ? size : sample.ends[record]) << size;
    EXPECT_EQ(log.lost_bytes, size - log.good_bytes);
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
  samples::LogSample sample = samples::log_sample(kTicks, 0x5a17, 40);
  const std::size_t last_record = sample.ends[sample.ends.size() - 2];
  for (std::size_t bit = 0; bit < sample.bytes.size() * 8; ++bit) {
    const std::size_t byte = bit / 8;
    sample.bytes[byte] ^= static_cast<std::byte>(1u << (bit % 8));
    const Log log = read_log(sample.bytes);
    LogState expected = byte < last_record ? LogState::kCorrupt : LogState::kTorn;
    if (byte >= 8 && byte < 12) expected = LogState::kIncompatible;
    EXPECT_EQ(log.state, expected) << "byte " << byte << " bit " << bit % 8 << ": " << log.reason;
    EXPECT_FALSE(log.footer);
    if (byte >= sample.ends[0]) {
      const auto next = std::ranges::upper_bound(sample.ends, byte);
      expect_log_prefix(
          log, sample.ticks_until[static_cast<std::size_t>(next - sample.ends.begin() - 1)]);
    }
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
  EXPECT_EQ(log.lost_bytes, sample.bytes.size() - sample.ends[2]);
  expect_log_prefix(log, 2);
}

TEST(LogFormat, ALostRecordIsCorruption) {
  samples::LogSample sample = samples::log_sample(kTicks);
  sample.bytes.erase(sample.bytes.begin() + static_cast<std::ptrdiff_t>(sample.ends[2]),
                     sample.bytes.begin() + static_cast<std::ptrdiff_t>(sample.ends[3]));
  const Log log = read_log(sample.bytes);
  EXPECT_EQ(log.state, LogState::kCorrupt);
  expect_log_prefix(log, 2);
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
  expect_log_prefix(log, 3);
}

TEST(LogFormat, BytesBehindTheFooterAreCorruption) {
  for (const std::byte more : {std::byte{0}, std::byte{0x40}}) {
    samples::LogSample sample = samples::log_sample(kTicks);
    sample.bytes.push_back(more);
    EXPECT_EQ(read_log(sample.bytes).state, LogState::kCorrupt);
  }
}

TEST(LogFormat, AFooterOfAnotherMatchIsCorruption) {
  for (const LogFooter& footer : {LogFooter{1, 4711, {}}, LogFooter{2, 1001, {}}}) {
    Bytes bytes;
    LogEncoder encoder(samples::log_header(), bytes);
    encoder.tick(samples::log_tick(1), bytes);
    encoder.footer(footer, bytes);
    EXPECT_EQ(read_log(bytes).state, LogState::kCorrupt);
  }
}

TEST(LogFormat, OtherVersionsAreNamedWithBothValues) {
  LogHeader header = samples::log_header();
  header.solver_version = solver::kSolverVersion + 1;
  Bytes bytes;
  LogEncoder newer(header, bytes);
  Log log = read_log(bytes);
  EXPECT_EQ(log.state, LogState::kIncompatible);
  EXPECT_EQ(log.reason, "solver version " + std::to_string(solver::kSolverVersion + 1) + ", here " +
                            std::to_string(solver::kSolverVersion) + " (written by GNU 12.2 -O3)");
  header = samples::log_header();
  header.protocol_version = kProtocolVersion + 1;
  bytes.clear();
  LogEncoder other(header, bytes);
  EXPECT_EQ(read_log(bytes).state, LogState::kIncompatible);
  header = samples::log_header();
  header.schema ^= 1;
  bytes.clear();
  LogEncoder records(header, bytes);
  EXPECT_EQ(read_log(bytes).state, LogState::kIncompatible);
  EXPECT_EQ(read_log(bytes).reason.substr(0, 10), "log schema");
}

/// A version in the table is read, one that is not is refused.
TEST(LogFormat, ABitCompatibleSolverVersionIsRead) {
  LogHeader header = samples::log_header();
  header.solver_version = 4;
  Bytes bytes;
  LogEncoder encoder(header, bytes);
  encoder.footer({0, 0, {}}, bytes);
  EXPECT_EQ(scan_log(bytes).state, LogState::kIncompatible);
  const std::array<std::uint32_t, 2> with_four = {4, solver::kSolverVersion};
  const LogSummary log = scan_log(bytes, with_four);
  EXPECT_EQ(log.state, LogState::kComplete) << log.reason;
  EXPECT_EQ(log.header.solver_version, 4u);
  EXPECT_EQ(std::ranges::count(kBitCompatibleSolverVersions, solver::kSolverVersion), 1);
}

/// The first bytes of a log as format 1 wrote it.
TEST(LogFormat, AnOlderFormatIsNamed) {
  samples::LogSample sample = samples::log_sample(1);
  sample.bytes[8] = std::byte{1};
  const Log log = read_log(sample.bytes);
  EXPECT_EQ(log.state, LogState::kIncompatible);
  EXPECT_EQ(log.reason, "log format 1, here 2");
}

TEST(LogFormat, TextThatIsNoUtf8IsADamagedHeader) {
  LogHeader header = samples::log_header();
  header.room = "\xff";
  Bytes bytes;
  LogEncoder encoder(header, bytes);
  EXPECT_EQ(read_log(bytes).state, LogState::kCorrupt);
}

// With checks that fit: each is one form too many, or more than there may be.
TEST(LogFormat, RecordsThatNoWriterMakesAreRefused) {
  const auto reads = [](std::size_t seats, std::vector<int> behind_digest) {
    LogTick tick;
    tick.frame.seats.resize(seats);
    Bytes payload(8);
    for (const int byte : behind_digest) payload.push_back(static_cast<std::byte>(byte));
    return read_tick(payload, tick);
  };
  const int absent = static_cast<int>(SeatFrame{}.origin);
  const int given = static_cast<int>(Origin::kGiven);
  EXPECT_TRUE(reads(0, {1, 0x80, 0x02})) << "256 seats";
  EXPECT_FALSE(reads(0, {1, 0x81, 0x02})) << "257 seats";
  EXPECT_FALSE(reads(3, {1, 3})) << "as many seats as before";
  EXPECT_TRUE(reads(3, {1 << 3, 32, given}));
  EXPECT_FALSE(reads(3, {1 << 3, 32, absent})) << "the origin that it has";
  EXPECT_FALSE(reads(3, {31 << 3, 1, 32, given})) << "few seats, said as many";
  EXPECT_FALSE(reads(3, {1 << 3, 32 | 3 << 6, 2, given})) << "few skipped, said as many";
  EXPECT_TRUE(reads(2, {2, 1, 1, 1}));
  EXPECT_FALSE(reads(2, {2, 1, 1, 2})) << "an event of a seat that is not there";
  std::vector<int> events = {2, 0x81, 0x08};
  for (int i = 0; i < 1025; ++i) events.insert(events.end(), {1, 0});
  EXPECT_FALSE(reads(2, events)) << "too many events";

  Bytes keyframe;
  append_keyframe({1, 2, {SeatFrame{Origin::kGiven, {}}}, {}}, keyframe);
  EXPECT_TRUE(read_keyframe(keyframe));
  keyframe[18] = std::byte{9};
  EXPECT_FALSE(read_keyframe(keyframe)) << "no such origin";
  Bytes footer;
  append_footer({1, 2, {{1, 2, 3}}}, footer);
  EXPECT_TRUE(read_footer(footer));
  footer.push_back({});
  EXPECT_FALSE(read_footer(footer)) << "bytes behind its index";
}

}  // namespace
}  // namespace cycloid::protocol
