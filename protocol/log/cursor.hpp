#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "protocol/log/chunks.hpp"
#include "protocol/log/header.hpp"
#include "protocol/log/values.hpp"

namespace cycloid::protocol {

/// What reading the records needs of a header.
struct LogStart {
  std::uint64_t salt = 0;
  std::uint64_t branch_tick = 0;
  std::size_t header_bytes = 0;
  std::uint32_t check = 0;
};

/// @pre the header is good
LogStart log_start(const ReadHeader& read);

/// Reads a log record by record. Holds one tick and one keyframe, never the whole match: a tick of
/// a few bytes may have 256 seats.
class LogCursor {
 public:
  enum class Step : std::uint8_t { kTick, kKeyframe, kFooter, kEnd };

  /// At the first record. `bytes` is the log from its header on, or a good prefix of it, and must
  /// outlive the cursor.
  LogCursor(std::span<const std::byte> bytes, const LogStart& start);
  /// At a keyframe: the first step is kKeyframe, or kEnd and corrupt where none stands there.
  LogCursor(std::span<const std::byte> bytes, const LogStart& start, const KeyframePlace& place);

  /// The next record. After kEnd it is kEnd again.
  Step next();

  const LogTick& tick() const { return tick_; }  ///< Of the last kTick.
  const LogKeyframe& keyframe() const { return keyframe_; }
  const LogFooter& footer() const { return footer_; }
  std::uint64_t record_at() const { return record_at_; }  ///< Byte of the last record.
  std::uint32_t record_before() const { return record_before_; }

  std::uint64_t last_tick() const { return last_tick_; }
  std::uint64_t good_bytes() const { return good_bytes_; }
  /// Of all that was read; @pre the last step was kEnd.
  LogState state() const { return state_; }
  /// What is wrong, at which byte; "" when complete.
  const std::string& reason() const { return reason_; }
  /// What good blocks behind the damage say of the match, where it is corrupt.
  std::optional<std::uint64_t> tick_behind() const { return tick_behind_; }

 private:
  Step end(LogState state, const std::string& reason);
  std::string no_keyframe() const;
  Step damaged();
  Step take_tick(std::span<const std::byte> payload);
  Step take_keyframe(std::span<const std::byte> payload);
  Step take_footer(std::span<const std::byte> payload);
  Step take(RecordKind kind, std::span<const std::byte> payload);

  std::span<const std::byte> bytes_;
  ChunkReader chunks_;
  Bytes parts_;  ///< Of a record in several chunks.
  LogTick tick_;
  LogKeyframe keyframe_;
  LogFooter footer_;
  std::uint64_t last_tick_ = 0;
  std::optional<std::uint64_t> last_digest_;  ///< None before the first record.
  std::uint64_t branch_tick_ = 0;
  std::uint64_t record_at_ = 0;
  std::uint32_t record_before_ = 0;
  std::uint64_t good_bytes_ = 0;
  bool stands_on_keyframe_ = false;  ///< That of the last tick was read.
  bool footed_ = false;
  bool ended_ = false;
  LogState state_ = LogState::kOpen;
  std::string reason_;
  std::optional<std::uint64_t> tick_behind_;
};

}  // namespace cycloid::protocol
