#pragma once

#include <cstdint>
#include <string>

namespace cycloid::server {

enum class End : std::uint8_t {
  kDrained,   ///< By a signal, the stop token or an admin, or empty for too long.
  kTicks,     ///< All wanted ticks were made.
  kFaulted,   ///< The world entered its fault state.
  kLogError,  ///< The log could not be written and `stop_on_log_error` was set.
};

const char* end_name(End end);

/// How a room was, and how it ended.
struct ServeReport {
  End end = End::kDrained;
  std::string reason;
  std::uint64_t ticks = 0;
  std::uint64_t final_digest = 0;
  std::uint64_t worst_tick_ns = 0;    ///< Longest time of one tick: step, digest and encoding.
  std::uint64_t lateness_p99_ns = 0;  ///< From a tick's deadline to its start; an upper bound.
  std::uint64_t bytes_in = 0;
  std::uint64_t bytes_out = 0;
  std::uint64_t desyncs = 0;
  std::uint64_t clients = 0;   ///< Hellos that were welcomed.
  std::uint64_t refusals = 0;  ///< Connections that were told Refused, by the gate or the room.
  std::uint64_t inputs_late = 0;
  std::uint64_t slowed_ns = 0;  ///< Time by which overload or a pause put the match off.
  bool durable = true;          ///< Whether the log, where there is one, holds all ticks.

  bool good() const { return end == End::kDrained || end == End::kTicks; }
};

}  // namespace cycloid::server
