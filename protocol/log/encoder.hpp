#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/codec.hpp"
#include "protocol/log/chunks.hpp"
#include "protocol/log/header.hpp"
#include "protocol/log/values.hpp"

namespace cycloid::protocol {

/// The bytes of a log: the header, then ticks, with keyframes between, then the footer. Each call
/// appends to `into`; all of it in order is the file.
class LogEncoder {
 public:
  LogEncoder(const LogHeader& header, Bytes& into);

  /// @pre tick.frame.tick is next_tick(), and the frame is one that a message can carry.
  void tick(const LogTick& tick, Bytes& into);
  /// The exact state after the last tick. @pre the first record of a log with a branch_tick
  void keyframe(std::uint64_t digest, std::span<const std::byte> state, Bytes& into);
  /// As `keyframe`, with the seats of a tick that this log does not hold: to begin a branch.
  void first_keyframe(const LogKeyframe& keyframe, Bytes& into);
  /// Ends the log. The index is the encoder's own.
  void footer(const LogFooter& footer, Bytes& into);

  std::uint64_t next_tick() const { return next_tick_; }
  const std::vector<SeatFrame>& seats() const { return seats_; }  ///< Of the last tick.

 private:
  std::uint64_t next_tick_;
  ChunkWriter chunks_;
  std::vector<SeatFrame> seats_;
  std::vector<KeyframePlace> keyframes_;
  Bytes payload_;
};

}  // namespace cycloid::protocol
