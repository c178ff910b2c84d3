#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "protocol/log_format.hpp"

namespace cycloid::server {

/// Where a room hands its ticks, in order, each before any client hears of it.
class LogSink {
 public:
  virtual ~LogSink() = default;
  virtual void tick(const protocol::LogTick& tick) = 0;
  virtual void close(const protocol::LogFooter& footer) = 0;
  /// Whether `keyframe` is to follow this tick.
  virtual bool wants_keyframe(std::uint64_t tick) const {
    (void)tick;
    return false;
  }
  /// The exact state after the last tick that was handed over.
  virtual void keyframe(std::uint64_t tick, std::uint64_t digest,
                        std::span<const std::byte> state) {
    (void)tick, (void)digest, (void)state;
  }
  /// The match goes on from after this earlier tick, which left this exact state: the next tick to
  /// be handed over is the one after it, and what was handed over behind it is another branch.
  virtual void branch(const protocol::LogTick& from, std::span<const std::byte> state) {
    (void)from, (void)state;
  }
  /// False once a tick could not be kept; never true again.
  virtual bool durable() const = 0;
  virtual std::string error() const = 0;
};

}  // namespace cycloid::server
