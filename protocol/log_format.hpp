#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/codec.hpp"
#include "protocol/messages.hpp"

namespace cycloid::protocol {

/// What a log is a log of. The scene travels inside, in its binary form, so that a log alone is
/// the match.
struct LogHeader {
  std::uint32_t protocol_version = kProtocolVersion;
  std::uint32_t solver_version = solver::kSolverVersion;
  std::uint64_t scene_digest = 0;
  std::uint64_t salt = 0;  ///< Makes the checks of this file its own.
  std::string scene_name;
  std::vector<std::byte> scene;
};

/// One tick: the frame and the digest of the world after it.
struct LogTick {
  InputFrame frame;
  std::uint64_t digest = 0;
};

/// A clean close: what the log must end with to be complete.
struct LogFooter {
  std::uint64_t ticks = 0;
  std::uint64_t digest = 0;
};

/// Bytes of a log, in the order header, ticks, footer. Each record ends with a CRC-32C over the
/// salt, the check of the record before and its own bytes, so that no record can be moved, lost
/// or borrowed from another log unnoticed.
class LogEncoder {
 public:
  explicit LogEncoder(const LogHeader& header, Bytes& into);
  void tick(const LogTick& tick, Bytes& into);
  void footer(const LogFooter& footer, Bytes& into);

 private:
  std::uint64_t salt_;
  std::uint32_t check_ = 0;
};

enum class LogState : std::uint8_t {
  kComplete,  ///< Ends with its footer.
  kOpen,      ///< All records whole, no footer: still being written, or the writer was killed.
  kTorn,      ///< The last record is cut or damaged and nothing valid follows: a prefix is good.
  kCorrupt,   ///< A damaged record with valid ones after it, or a damaged header.
  kIncompatible,  ///< Another format, protocol or solver version.
};

struct Log {
  LogState state = LogState::kCorrupt;
  LogHeader header;
  std::vector<LogTick> ticks;  ///< The good prefix.
  std::optional<LogFooter> footer;
  std::uint64_t good_bytes = 0;  ///< Length of the good prefix.
  std::string reason;            ///< What is wrong, at which byte; "" when complete.
};

/// Never fails otherwise than by `state`; allocates at most in proportion to `bytes`.
Log read_log(std::span<const std::byte> bytes);

}  // namespace cycloid::protocol
