#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "server/admission/refill_bucket.hpp"

namespace cycloid::server {

/// What one admitted connection may send. The defaults are 4 times what a client of 120 ticks a
/// second needs that says an input, an acknowledgement and a digest in each.
struct ConnectionRateOptions {
  Rate messages{1500, 3000};
  Rate bytes{262144, 1048576};
  std::uint8_t inputs_per_tick_max = 8;  ///< For one tick: the first and its corrections.
};

/// Counts what a connection sends. Each call returns "" or the reason of a kRateLimited refusal.
class ConnectionRates {
 public:
  /// Inputs further apart than this are counted wrongly; a room takes none further ahead.
  static constexpr std::uint64_t kInputWindowTicks = 128;

  ConnectionRates(const ConnectionRateOptions& options, std::int64_t now_ns);

  /// A whole message has come in.
  std::string take_message(std::uint32_t payload_bytes, std::int64_t now_ns);
  /// It was an input for this tick. @pre the tick lies in the room's window; what lies outside is
  /// dropped there and need not be counted
  std::string take_input(std::uint64_t tick);

 private:
  ConnectionRateOptions options_;
  RefillBucket messages_;
  RefillBucket bytes_;
  std::uint64_t newest_tick_ = 0;
  std::array<std::uint8_t, kInputWindowTicks> inputs_{};  ///< By tick, modulo the window.
};

}  // namespace cycloid::server
