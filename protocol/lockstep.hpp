#pragma once

#include <cstdint>

namespace cycloid::protocol {

/// How many ticks ahead a seat may speak; it bounds what the server keeps for a seat.
inline constexpr std::uint64_t kInputWindowTicks = 64;

enum class Timing : std::uint8_t {
  kInTime,
  kLate,   ///< Its tick is made.
  kEarly,  ///< Beyond the window.
};

/// Of an input for `tick` when `made` is the last tick made: in time for made + 1 to
/// made + kInputWindowTicks.
constexpr Timing timing(std::uint64_t made, std::uint64_t tick) {
  if (tick <= made) return Timing::kLate;
  return tick - made <= kInputWindowTicks ? Timing::kInTime : Timing::kEarly;
}

/// When ticks are due: tick n, n * 10^12 / rate ns after the start, rounded down. In integers and
/// from the start, so that no error adds up: exact for ever at 60 Hz, whose tick is no whole number
/// of nanoseconds.
class Schedule {
 public:
  /// @pre rate_millihertz > 0.
  constexpr Schedule(std::int64_t start_ns, std::uint32_t rate_millihertz)
      : start_ns_(start_ns), rate_(rate_millihertz) {}

  /// No overflow before 10^14 ticks at 60 Hz.
  constexpr std::int64_t deadline_ns(std::uint64_t tick) const {
    const std::uint64_t whole = kNanosecondsIn1000s / rate_;
    const std::uint64_t rest = kNanosecondsIn1000s % rate_;
    return start_ns_ + static_cast<std::int64_t>(tick * whole + tick * rest / rate_);
  }

  /// Moves every deadline by so much.
  constexpr void delay(std::int64_t by_ns) { start_ns_ += by_ns; }

 private:
  static constexpr std::uint64_t kNanosecondsIn1000s = 1'000'000'000'000;
  std::int64_t start_ns_;
  std::uint64_t rate_;
};

}  // namespace cycloid::protocol
