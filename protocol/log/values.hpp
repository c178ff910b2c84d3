#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "protocol/log/schema.hpp"
#include "protocol/messages.hpp"
#include "solver/version.hpp"

namespace cycloid::protocol {

/// What a log is a log of. The scene travels inside, in its binary form, so that a log alone is
/// the match. Nothing here is read from a clock or from chance: the caller says it.
struct LogHeader {
  std::uint32_t protocol_version = kProtocolVersion;
  std::uint32_t solver_version = solver::kSolverVersion;
  std::uint64_t scene_digest = 0;
  std::uint64_t salt = 0;  ///< Makes the checks of this file its own.
  std::uint32_t schema = kLogSchema;
  std::uint32_t tick_rate_millihertz = 0;  ///< 0: that of the scene.
  std::int64_t start_unix_ns = 0;          ///< When the match began; 0: nobody says.
  std::uint64_t log_id = 0;
  std::uint64_t parent_log_id = 0;  ///< The log that this one goes on from; 0: none.
  std::uint64_t branch_tick = 0;    ///< Ticks made before, below 2^53; if any, a keyframe first.
  std::string build;                ///< Compiler and flags of the writer.
  std::string room;
  std::string scene_name;
  std::vector<std::byte> scene;
};

/// One tick: the frame and the digest of the world after it.
struct LogTick {
  InputFrame frame;
  std::uint64_t digest = 0;
};

/// The exact state after a tick, from which reading can begin.
struct LogKeyframe {
  std::uint64_t tick = 0;
  std::uint64_t digest = 0;
  std::vector<SeatFrame> seats;  ///< As the frame of that tick had them.
  std::vector<std::byte> state;  ///< Simulation::encode.
};

/// Where a keyframe lies.
struct KeyframePlace {
  std::uint64_t tick = 0;
  std::uint64_t at = 0;      ///< Byte of its first chunk.
  std::uint32_t before = 0;  ///< The check of the chunk before it.
  friend bool operator==(const KeyframePlace&, const KeyframePlace&) = default;
};

/// A clean close: what the log must end with to be complete.
struct LogFooter {
  std::uint64_t ticks = 0;  ///< The last tick.
  std::uint64_t digest = 0;
  std::vector<KeyframePlace> keyframes = {};  ///< Filled in by the encoder.
};

enum class LogState : std::uint8_t {
  kComplete,  ///< Ends with its footer.
  kOpen,      ///< All records whole, no footer: still being written, or the writer was killed.
  kTorn,      ///< The last record is cut or damaged and nothing valid follows: a prefix is good.
  kCorrupt,   ///< A damaged record with valid ones after it, or a damaged header.
  kIncompatible,  ///< Another format, protocol, schema or solver version.
};

}  // namespace cycloid::protocol
