#include "server/room/delay_controller.hpp"

#include <algorithm>

namespace cycloid::server {

DelayController::DelayController(const DelayPolicy& policy, std::uint32_t ticks,
                                 std::uint32_t tick_rate_millihertz)
    : policy_(policy), ticks_(ticks), pause_ticks_((2ull * tick_rate_millihertz + 999) / 1000) {}

std::optional<std::uint32_t> DelayController::on_tick(const TickInputs& inputs) {
  if (!policy_.adaptive) return std::nullopt;
  ++seen_;
  windows_[0].missed += inputs.missed ? 1 : 0;
  windows_[0].late_ticks = std::max(windows_[0].late_ticks, inputs.late_ticks);
  tight_ += inputs.tight ? 1 : 0;
  ++in_lower_;
  std::uint32_t wanted = ticks_;
  const bool lowers = in_lower_ == kLowerTicks && tight_ <= kTightMax;
  if (in_lower_ == kLowerTicks) in_lower_ = tight_ = 0;
  if (++in_window_ == kWindowTicks) {
    if (std::ranges::count_if(windows_, is_bad) >= 3) wanted = ticks_ + raise_ticks();
    std::shift_right(windows_.begin(), windows_.end(), 1);
    windows_[0] = {};
    in_window_ = 0;
  }
  if (wanted == ticks_ && lowers) wanted = ticks_ - 1;
  return change_to(std::clamp(wanted, policy_.ticks_min, policy_.ticks_max));
}

std::uint32_t DelayController::raise_ticks() const {
  std::uint32_t least = ~0u;
  for (const Window& window : windows_) {
    if (is_bad(window)) least = std::min(least, window.late_ticks);
  }
  return least;
}

std::optional<std::uint32_t> DelayController::change_to(std::uint32_t ticks) {
  if (ticks == ticks_ || seen_ < next_change_) return std::nullopt;
  next_change_ = seen_ + pause_ticks_;
  ticks_ = ticks;
  look_anew();
  return ticks;
}

void DelayController::look_anew() {
  windows_ = {};
  in_window_ = in_lower_ = tight_ = 0;
}

}  // namespace cycloid::server
