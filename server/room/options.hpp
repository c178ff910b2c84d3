#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

namespace cycloid::server {

/// What one room and its peers may use up; docs/protocol.md says what happens at each bound.
/// None may be 0.
struct Limits {
  std::size_t connections_max = 1024;
  std::uint32_t messages_per_tick_max =
      64;  ///< Of one client; what is more waits for the next tick.
  std::size_t queue_bytes_max = std::size_t{1} << 20;  ///< Of one client, snapshots not counted.
  std::chrono::nanoseconds handshake{std::chrono::seconds{5}};  ///< From connection to hello.
  std::chrono::nanoseconds idle{std::chrono::seconds{30}};      ///< Without any message.
  std::uint32_t catch_up_ticks_max = 8;  ///< In one `advance`; a room further behind is slowed.
  std::uint64_t digest_ticks = 60;       ///< Ticks between two digests to lockstep clients.
  std::uint64_t snapshot_ticks = 3;      ///< Ticks between two snapshots to snapshot clients.
  std::uint32_t input_delay_ticks = 2;   ///< The lead that clients are told to keep.
};

}  // namespace cycloid::server
