#include "protocol/log/scan.hpp"

#include <algorithm>
#include <utility>

namespace cycloid::protocol {

const KeyframePlace* LogSummary::keyframe_before(std::uint64_t tick) const {
  const KeyframePlace* last = nullptr;
  for (const KeyframePlace& place : keyframes)
    if (place.tick <= tick) last = &place;
  return last;
}

/// @param on_tick  Called with each tick of the good prefix.
template <class OnTick>
static LogSummary scan(std::span<const std::byte> bytes,
                       std::span<const std::uint32_t> solver_versions, OnTick&& on_tick) {
  LogSummary summary;
  ReadHeader read = read_log_header(bytes, solver_versions);
  summary.state = read.state;
  summary.reason = std::move(read.reason);
  summary.start = log_start(read);
  summary.header = std::move(read.header);
  summary.lost_bytes = bytes.size();
  if (read.state != LogState::kOpen) return summary;

  LogCursor cursor(bytes, summary.start);
  for (LogCursor::Step step = cursor.next(); step != LogCursor::Step::kEnd; step = cursor.next()) {
    if (step == LogCursor::Step::kTick) {
      summary.last_digest = cursor.tick().digest;
      on_tick(cursor.tick());
    } else if (step == LogCursor::Step::kKeyframe) {
      summary.last_digest = cursor.keyframe().digest;
      summary.keyframes.push_back(
          {cursor.keyframe().tick, cursor.record_at(), cursor.record_before()});
      summary.keyframe_bytes += cursor.good_bytes() - cursor.record_at();
    } else {
      summary.footer = cursor.footer();
    }
  }
  summary.state = cursor.state();
  summary.reason = cursor.reason();
  summary.last_tick = cursor.last_tick();
  summary.good_bytes = cursor.good_bytes();
  summary.lost_bytes = bytes.size() - summary.good_bytes;
  summary.tick_behind = cursor.tick_behind();
  if (summary.footer && summary.footer->keyframes != summary.keyframes) {
    summary.footer.reset();
    summary.state = LogState::kCorrupt;
    summary.reason = "a footer whose index is not that of the keyframes";
  }
  if (summary.footer) summary.last_digest = summary.footer->digest;
  return summary;
}

LogSummary scan_log(std::span<const std::byte> bytes,
                    std::span<const std::uint32_t> solver_versions) {
  return scan(bytes, solver_versions, [](const LogTick&) {});
}

Log read_log(std::span<const std::byte> bytes) {
  Log log;
  static_cast<LogSummary&>(log) = scan(bytes, kBitCompatibleSolverVersions,
                                       [&](const LogTick& tick) { log.ticks.push_back(tick); });
  return log;
}

}  // namespace cycloid::protocol
