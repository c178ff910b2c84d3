#include <gmock/gmock.h>

#include <random>

#include "protocol/log_format.hpp"
#include "tests/protocol/samples.hpp"

namespace cycloid::protocol {
namespace {

using Step = LogCursor::Step;

/// From every keyframe on, all that follows is as from the start.
TEST(LogCursor, FromEveryKeyframeTheRestIsTheSame) {
  const samples::LogSample sample = samples::log_sample(200, 0x5a17, 700);
  const LogSummary log = scan_log(sample.bytes);
  ASSERT_EQ(log.keyframes.size(), 100u);
  for (const KeyframePlace& place : log.keyframes) {
    LogCursor cursor(sample.bytes, log.start, place);
    ASSERT_EQ(cursor.next(), Step::kKeyframe) << cursor.reason();
    EXPECT_EQ(cursor.keyframe().tick, place.tick);
    EXPECT_EQ(cursor.keyframe().digest, 1000 + place.tick);
    EXPECT_EQ(cursor.keyframe().state, Bytes(700, static_cast<std::byte>(place.tick)));
    std::uint64_t tick = place.tick;
    for (Step step = cursor.next(); step != Step::kEnd; step = cursor.next()) {
      if (step != Step::kTick) continue;
      ASSERT_EQ(cursor.tick().frame, samples::log_tick(++tick).frame);
    }
    EXPECT_EQ(tick, 200u);
    EXPECT_EQ(cursor.state(), LogState::kComplete) << cursor.reason();
  }
}

TEST(LogCursor, KeyframeBeforeIsTheLastOneThatIsNotLater) {
  const LogSummary log = scan_log(samples::log_sample(20, 0x5a17, 10).bytes);
  EXPECT_EQ(log.keyframe_before(1), nullptr);
  EXPECT_EQ(log.keyframe_before(2)->tick, 2u);
  EXPECT_EQ(log.keyframe_before(9)->tick, 8u);
  EXPECT_EQ(log.keyframe_before(1000)->tick, 20u);
}

TEST(LogCursor, APlaceWithoutAKeyframeIsCorrupt) {
  const samples::LogSample sample = samples::log_sample(20, 0x5a17, 10);
  const LogSummary log = scan_log(sample.bytes);
  KeyframePlace place = log.keyframes[3];
  for (const std::uint64_t at : {place.at + 1, std::uint64_t{0}, std::uint64_t{1} << 40}) {
    LogCursor cursor(sample.bytes, log.start, {place.tick, at, place.before});
    EXPECT_EQ(cursor.next(), Step::kEnd);
    EXPECT_EQ(cursor.state(), LogState::kCorrupt) << at;
  }
  place.before ^= 1;
  LogCursor cursor(sample.bytes, log.start, place);
  EXPECT_EQ(cursor.next(), Step::kEnd);
}

/// A log that goes on from tick 41 of another.
Bytes branch(const LogKeyframe& keyframe, bool with_keyframe) {
  LogHeader header = samples::log_header();
  header.parent_log_id = 0x1c;
  header.branch_tick = 41;
  Bytes bytes;
  LogEncoder encoder(header, bytes);
  EXPECT_EQ(encoder.next_tick(), 42u);
  if (with_keyframe) encoder.first_keyframe(keyframe, bytes);
  for (std::uint64_t tick = 42; tick <= 50; ++tick) encoder.tick(samples::log_tick(tick), bytes);
  encoder.footer({50, 1050, {}}, bytes);
  return bytes;
}

TEST(LogCursor, ABranchBeginsWithTheStateOfItsTick) {
  LogKeyframe keyframe{41, 4711, samples::log_tick(41).frame.seats, Bytes(20, std::byte{1})};
  const Log log = read_log(branch(keyframe, true));
  ASSERT_EQ(log.state, LogState::kComplete) << log.reason;
  EXPECT_EQ(log.header.parent_log_id, 0x1cu);
  EXPECT_EQ(log.tick_count(), 9u);
  EXPECT_EQ(log.last_tick, 50u);
  EXPECT_EQ(log.ticks.front().frame, samples::log_tick(42).frame);
  EXPECT_EQ(log.keyframes.front().tick, 41u);
  EXPECT_EQ(read_log(branch(keyframe, false)).state, LogState::kCorrupt);
  keyframe.tick = 40;
  EXPECT_EQ(read_log(branch(keyframe, true)).state, LogState::kCorrupt);
}

/// A branch is nothing without the state that it goes on from, wherever it is cut before that.
TEST(LogCursor, ABranchCutBeforeItsStateIsTorn) {
  const LogKeyframe keyframe{41, 4711, samples::log_tick(41).frame.seats, Bytes(20, std::byte{1})};
  const Bytes whole = branch(keyframe, true);
  const Log log = read_log(whole);
  const std::size_t header_bytes = log.start.header_bytes;
  for (std::size_t size = header_bytes; size < log.keyframes[0].at + 20; ++size) {
    const LogSummary cut = scan_log(std::span<const std::byte>(whole).first(size));
    EXPECT_EQ(cut.state, LogState::kTorn) << size;
    EXPECT_TRUE(cut.keyframes.empty());
  }
}

/// A tick that no match comes to would make readers count without end, or take any memory.
TEST(LogCursor, ABranchTickThatNoMatchHasIsADamagedHeader) {
  for (const std::uint64_t tick : {std::uint64_t{1} << 53, ~std::uint64_t{0}}) {
    LogHeader header = samples::log_header();
    header.branch_tick = tick;
    Bytes bytes;
    append_log_header(header, bytes);
    EXPECT_EQ(read_log(bytes).state, LogState::kCorrupt);
    EXPECT_EQ(read_log(bytes).reason, "a damaged header, at byte 0");
  }
  LogHeader header = samples::log_header();
  header.branch_tick = (std::uint64_t{1} << 53) - 1;
  Bytes bytes;
  append_log_header(header, bytes);
  EXPECT_EQ(read_log(bytes).state, LogState::kTorn);
}

/// What the wire refuses of a frame is in no log.
TEST(LogCursor, ChangesThatNoFrameCanHaveAreCorruption) {
  const auto state_of = [](std::size_t count, std::uint32_t value) {
    LogTick tick = samples::log_tick(1);
    tick.frame.changes.assign(count, {ChangeKind::kInputDelay, value});
    Bytes bytes;
    LogEncoder(samples::log_header(), bytes).tick(tick, bytes);
    return read_log(bytes).state;
  };
  EXPECT_EQ(state_of(kFrameChangesMax, 1), LogState::kOpen);
  EXPECT_EQ(state_of(kFrameChangesMax + 1, 1), LogState::kCorrupt);
  EXPECT_EQ(state_of(1, 0), LogState::kCorrupt);
}

TEST(LogCursor, AKeyframeThatIsNotOfItsTickIsCorruption) {
  Bytes bytes;
  LogEncoder encoder(samples::log_header(), bytes);
  encoder.tick(samples::log_tick(1), bytes);
  encoder.keyframe(1002, Bytes(3), bytes);
  EXPECT_EQ(read_log(bytes).state, LogState::kCorrupt);
  EXPECT_EQ(read_log(bytes).last_tick, 1u);
}

/// Who begins at it would have other inputs than who comes to it by the ticks before.
TEST(LogCursor, AKeyframeWhoseSeatsAreNotThoseOfItsTickIsCorruption) {
  const LogTick tick = samples::log_tick(1);
  LogKeyframe keyframe{1, tick.digest, tick.frame.seats, Bytes(20, std::byte{1})};
  const auto log_with = [&] {
    Bytes bytes;
    LogEncoder encoder(samples::log_header(), bytes);
    encoder.tick(tick, bytes);
    encoder.first_keyframe(keyframe, bytes);
    return scan_log(bytes);
  };
  EXPECT_EQ(log_with().state, LogState::kOpen) << log_with().reason;
  ++keyframe.seats[0].input.buttons;
  const LogSummary log = log_with();
  EXPECT_EQ(log.state, LogState::kCorrupt);
  EXPECT_THAT(log.reason, testing::StartsWith("a keyframe of another match at byte "));
  EXPECT_TRUE(log.keyframes.empty());
}

/// A reader begins at one of them, and would never look at the other.
TEST(LogCursor, TwoKeyframesOfOneTickAreCorruption) {
  const LogKeyframe keyframe{41, 4711, samples::log_tick(41).frame.seats, Bytes(20, std::byte{1})};
  LogHeader header = samples::log_header();
  header.branch_tick = keyframe.tick;
  Bytes bytes;
  LogEncoder encoder(header, bytes);
  encoder.first_keyframe(keyframe, bytes);
  const std::string at = std::to_string(bytes.size());
  encoder.first_keyframe(keyframe, bytes);
  const LogSummary log = scan_log(bytes);
  EXPECT_EQ(log.state, LogState::kCorrupt);
  EXPECT_EQ(log.reason, "a second keyframe of tick 41 at byte " + at);
  EXPECT_EQ(log.keyframes.size(), 1u);
}

TEST(LogCursor, TheDigestOfALogWithoutTicksIsThatOfItsFooter) {
  Bytes bytes;
  LogEncoder(samples::log_header(), bytes).footer({0, 4711, {}}, bytes);
  const LogSummary log = scan_log(bytes);
  EXPECT_EQ(log.state, LogState::kComplete) << log.reason;
  EXPECT_EQ(log.last_digest, 4711u);
}

/// Whatever a room can put into a frame: seats come and go, events of every kind, changes, and
/// every field from any value to any other.
TEST(LogCursor, AnyFrameComesBack) {
  std::mt19937_64 random(3);
  Bytes bytes;
  LogEncoder encoder(samples::log_header(), bytes);
  std::vector<LogTick> ticks;
  for (std::uint64_t tick = 1; tick <= 400; ++tick) {
    LogTick made;
    made.frame.tick = tick;
    made.digest = random();
    const bool same_seats = tick % 7 != 0 && !ticks.empty();
    if (same_seats) made.frame.seats = ticks.back().frame.seats;
    if (!same_seats) made.frame.seats.resize(random() % (scenes::kSeatsMax + 1));
    for (SeatFrame& seat : made.frame.seats) {
      if (random() % 3 != 0) continue;
      seat.origin = static_cast<Origin>(1 + random() % 4);
      for (std::int16_t& axis : seat.input.axes)
        if (random() % 2 == 0) axis = static_cast<std::int16_t>(random());
      seat.input.buttons = static_cast<std::uint16_t>(random());
    }
    const std::size_t events = made.frame.seats.empty() ? 0
                               : tick % 50 == 0         ? kFrameEventsMax
                                                        : random() % 3;
    for (std::size_t i = 0; i < events; ++i)
      made.frame.events.push_back({static_cast<EventKind>(1 + random() % 5),
                                   static_cast<std::uint16_t>(random() % made.frame.seats.size())});
    for (std::size_t i = 0; i < random() % 3; ++i)
      made.frame.changes.push_back(
          {ChangeKind::kInputDelay, static_cast<std::uint32_t>(random() >> random() % 64) | 1u});
    encoder.tick(made, bytes);
    ticks.push_back(std::move(made));
  }
  const Log log = read_log(bytes);
  ASSERT_EQ(log.state, LogState::kOpen) << log.reason;
  ASSERT_EQ(log.ticks.size(), ticks.size());
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    ASSERT_EQ(log.ticks[i].frame, ticks[i].frame) << i;
    ASSERT_EQ(log.ticks[i].digest, ticks[i].digest);
  }
}

}  // namespace
}  // namespace cycloid::protocol
