#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/log/cursor.hpp"
#include "protocol/log/values.hpp"

namespace cycloid::protocol {

/// What a log is, without its ticks: those are read by a LogCursor.
struct LogSummary {
  LogState state = LogState::kCorrupt;
  LogHeader header;
  LogStart start;
  std::uint64_t last_tick = 0;    ///< Of the good prefix; branch_tick where it has no tick.
  std::uint64_t last_digest = 0;  ///< After it; 0 where no record says one.
  std::vector<KeyframePlace> keyframes;
  std::uint64_t keyframe_bytes = 0;
  std::optional<LogFooter> footer;
  std::uint64_t good_bytes = 0;              ///< Length of the good prefix.
  std::uint64_t lost_bytes = 0;              ///< Behind it.
  std::optional<std::uint64_t> tick_behind;  ///< The match went at least so far, where known.
  std::string reason;                        ///< What is wrong, at which byte; "" when complete.

  std::uint64_t tick_count() const { return last_tick - header.branch_tick; }  ///< In this log.
  /// The last keyframe not after `tick`, or null.
  const KeyframePlace* keyframe_before(std::uint64_t tick) const;
};

/// Reads all of a log and checks it. Never fails otherwise than by `state`; time and memory are in
/// proportion to `bytes`, whatever they claim.
/// @param solver_versions  Whose logs verify here.
LogSummary scan_log(std::span<const std::byte> bytes,
                    std::span<const std::uint32_t> solver_versions = kBitCompatibleSolverVersions);

/// A log with all its ticks in memory, for short ones: a tick of 14 bytes takes up to 3 KiB here.
struct Log : LogSummary {
  std::vector<LogTick> ticks;  ///< The good prefix.
};

/// As scan_log, for short logs.
Log read_log(std::span<const std::byte> bytes);

}  // namespace cycloid::protocol
