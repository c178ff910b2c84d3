#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "server/room/policy.hpp"

namespace cycloid::server {

/// How the inputs of one tick came, of all seats that were seated and had ever spoken.
struct TickInputs {
  bool missed = false;  ///< One was waited for or replaced.
  bool tight = false;   ///< One was missed, or would have been with one tick less of lead.
  /// Ticks by which the latest of those that came since the tick before came too late; 0: none did.
  std::uint32_t late_ticks = 0;
};

/// Chooses the input delay of a room from how its inputs come.
///
/// Raised when three of the last four windows of 15 ticks were bad: at least two of their ticks
/// missed an input, and inputs did come, only too late. By the least lateness of those windows, so
/// that one spike is no reason, and at least by 1. Lowered by 1 when at most 1 % of the last 600
/// ticks would have missed an input with one tick less. At most one change in two seconds, none in
/// the first 100 ticks. Source: the rule of keeperfx (#5150), which looks at packets and not at
/// windows, and lowers by what was missed and not by what would have been.
class DelayController {
 public:
  static constexpr std::uint32_t kWindowTicks = 15;
  static constexpr std::uint32_t kMissedPerWindowMin = 2;
  static constexpr std::uint32_t kLowerTicks = 600;
  static constexpr std::uint32_t kTightMax = kLowerTicks / 100;
  static constexpr std::uint64_t kFirstTicks = 100;

  /// @pre ticks > 0, tick_rate_millihertz > 0.
  DelayController(const DelayPolicy& policy, std::uint32_t ticks,
                  std::uint32_t tick_rate_millihertz);

  std::uint32_t ticks() const { return ticks_; }
  /// The new delay, where this tick is a reason for one; never with a fixed policy.
  std::optional<std::uint32_t> on_tick(const TickInputs& inputs);
  /// Other players than before: what was seen says nothing any more.
  void look_anew();

 private:
  struct Window {
    std::uint32_t missed = 0;
    std::uint32_t late_ticks = 0;
  };
  static bool is_bad(const Window& window) {
    return window.missed >= kMissedPerWindowMin && window.late_ticks > 0;
  }
  std::optional<std::uint32_t> change_to(std::uint32_t ticks);
  std::uint32_t raise_ticks() const;

  DelayPolicy policy_;
  std::uint32_t ticks_;
  std::uint64_t pause_ticks_;  ///< Between two changes.
  std::uint64_t seen_ = 0;
  std::uint64_t next_change_ = kFirstTicks;
  std::array<Window, 4> windows_{};  ///< The newest first.
  std::uint32_t in_window_ = 0;
  std::uint32_t in_lower_ = 0;
  std::uint32_t tight_ = 0;
};

}  // namespace cycloid::server
