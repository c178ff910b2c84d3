#include "protocol/log/cursor.hpp"

#include <utility>

#include "protocol/log/records.hpp"

namespace cycloid::protocol {

using Found = ChunkReader::Found;

static std::string at_byte(std::uint64_t at) {
  return " at byte " + std::to_string(at);
}

LogStart log_start(const ReadHeader& read) {
  return {read.header.salt, read.header.branch_tick, read.bytes, read.check};
}

LogCursor::LogCursor(std::span<const std::byte> bytes, const LogStart& start)
    : bytes_(bytes),
      chunks_(bytes, start.salt, start.header_bytes, start.header_bytes, start.check),
      last_tick_(start.branch_tick),
      branch_tick_(start.branch_tick),
      good_bytes_(start.header_bytes) {}

LogCursor::LogCursor(std::span<const std::byte> bytes, const LogStart& start,
                     const KeyframePlace& place)
    : bytes_(bytes), last_tick_(place.tick), branch_tick_(place.tick), good_bytes_(place.at) {
  if (place.at < start.header_bytes || place.at >= bytes.size()) {
    (void)end(LogState::kCorrupt, "no keyframe" + at_byte(place.at));
    return;
  }
  const auto at = static_cast<std::size_t>(place.at);  // Below the log's size, as was just seen.
  chunks_ = ChunkReader(bytes, start.salt, start.header_bytes, at, place.before);
}

LogCursor::Step LogCursor::end(LogState state, const std::string& reason) {
  ended_ = true;
  state_ = state;
  reason_ = reason;
  return Step::kEnd;
}

/// Of a branch whose first record is not the state that it goes on from.
std::string LogCursor::no_keyframe() const {
  return "no keyframe of tick " + std::to_string(branch_tick_) + at_byte(good_bytes_);
}

LogCursor::Step LogCursor::damaged() {
  const ChunkReader::Behind behind = chunks_.behind();
  tick_behind_ = behind.tick;
  if (behind.any) return end(LogState::kCorrupt, "a damaged record" + at_byte(chunks_.at()));
  return end(LogState::kTorn, "a cut or damaged last record" + at_byte(chunks_.at()));
}

LogCursor::Step LogCursor::next() {
  if (ended_) return Step::kEnd;
  LogChunk chunk;
  std::optional<RecordKind> kind;
  parts_.clear();
  do {
    const Found found = chunks_.next(chunk);
    if (footed_ && (found != Found::kEnd || chunks_.at() != good_bytes_))
      return end(LogState::kCorrupt, "bytes after the footer" + at_byte(good_bytes_));
    if (found == Found::kOutOfOrder)
      return end(LogState::kCorrupt, "a block out of order" + at_byte(chunks_.at()));
    if (found == Found::kDamage) return damaged();
    if (found == Found::kEnd && kind)
      return end(LogState::kTorn, "a cut last record" + at_byte(record_at_));
    if (found == Found::kEnd && footed_) return end(LogState::kComplete, "");
    if (found == Found::kEnd) {
      good_bytes_ = chunks_.good();
      if (branch_tick_ != 0 && !last_digest_) return end(LogState::kTorn, no_keyframe());
      return end(LogState::kOpen, "no footer" + at_byte(good_bytes_));
    }
    if (kind && *kind != chunk.kind)
      return end(LogState::kCorrupt, "a record without its end" + at_byte(record_at_));
    if (!kind) {
      record_at_ = chunk.at;
      record_before_ = chunk.before;
    }
    kind = chunk.kind;
    if (chunks_.take_block_tick().value_or(last_tick_ + 1) != last_tick_ + 1)
      return end(LogState::kCorrupt, "a block of another tick" + at_byte(chunk.at));
    if (chunk.more || !parts_.empty())
      parts_.insert(parts_.end(), chunk.payload.begin(), chunk.payload.end());
  } while (chunk.more);
  return take(*kind, parts_.empty() ? chunk.payload : std::span<const std::byte>(parts_));
}

LogCursor::Step LogCursor::take(RecordKind kind, std::span<const std::byte> payload) {
  if (branch_tick_ != 0 && !last_digest_ && kind != RecordKind::kKeyframe)
    return end(LogState::kCorrupt, no_keyframe());
  const Step step = kind == RecordKind::kTick       ? take_tick(payload)
                    : kind == RecordKind::kKeyframe ? take_keyframe(payload)
                                                    : take_footer(payload);
  if (step != Step::kEnd) good_bytes_ = chunks_.good();
  return step;
}

LogCursor::Step LogCursor::take_tick(std::span<const std::byte> payload) {
  if (!read_tick(payload, tick_))
    return end(LogState::kCorrupt, "a tick with values out of range" + at_byte(record_at_));
  tick_.frame.tick = ++last_tick_;
  last_digest_ = tick_.digest;
  stands_on_keyframe_ = false;
  return Step::kTick;
}

LogCursor::Step LogCursor::take_keyframe(std::span<const std::byte> payload) {
  auto keyframe = read_keyframe(payload);
  if (keyframe && stands_on_keyframe_ && keyframe->tick == last_tick_)
    return end(LogState::kCorrupt,
               "a second keyframe of tick " + std::to_string(last_tick_) + at_byte(record_at_));
  const bool first = !last_digest_;
  const bool fits =
      keyframe && keyframe->tick == last_tick_ &&
      (first || (keyframe->digest == *last_digest_ && keyframe->seats == tick_.frame.seats));
  if (!fits) return end(LogState::kCorrupt, "a keyframe of another match" + at_byte(record_at_));
  keyframe_ = std::move(*keyframe);
  stands_on_keyframe_ = true;
  last_digest_ = keyframe_.digest;
  tick_.frame.seats = keyframe_.seats;
  return Step::kKeyframe;
}

LogCursor::Step LogCursor::take_footer(std::span<const std::byte> payload) {
  auto footer = read_footer(payload);
  const bool fits = footer && footer->ticks == last_tick_ &&
                    footer->digest == last_digest_.value_or(footer->digest);
  if (!fits) return end(LogState::kCorrupt, "a footer of another match" + at_byte(record_at_));
  footer_ = std::move(*footer);
  footed_ = true;
  return Step::kFooter;
}

}  // namespace cycloid::protocol
