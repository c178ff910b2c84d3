#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "scenes/simulation.hpp"

namespace cycloid::server {

/// What a control says in a tick that closes without its seat's input.
enum class WhenMissing : std::uint8_t {
  kRepeat = 0,           ///< What it said last.
  kNeutral = 1,          ///< Nothing: 0.
  kWaitThenRepeat = 2,   ///< The tick waits for it, `wait_ticks_max` at most.
  kWaitThenNeutral = 3,  ///< Likewise.
};

inline constexpr std::size_t kButtons = 16;

/// What missing inputs are replaced by, for each control of every seat of a room. What a tick held
/// stands in its frame, so that the policy itself need not be known to replay a match.
struct InputPolicy {
  std::array<WhenMissing, scenes::kAxes> axes{};
  std::array<WhenMissing, kButtons> buttons{};
  /// Bit b: button b starts something, and is never repeated whatever `buttons` says.
  std::uint16_t one_shot_buttons = 0;
  /// Tick times that a tick may wait for seated players; used where a control waits.
  std::uint32_t wait_ticks_max = 3;

  static constexpr bool repeats(WhenMissing when) {
    return when == WhenMissing::kRepeat || when == WhenMissing::kWaitThenRepeat;
  }
  static constexpr bool waits_for(WhenMissing when) {
    return when == WhenMissing::kWaitThenRepeat || when == WhenMissing::kWaitThenNeutral;
  }
  bool repeats_axis(std::size_t axis) const { return repeats(axes[axis]); }
  bool repeats_button(std::size_t button) const {
    return repeats(buttons[button]) && (one_shot_buttons >> button & 1u) == 0;
  }

  /// Whether any control is ever repeated; if not, a missing input is neutral and not a repetition.
  bool repeats_any() const {
    for (std::size_t button = 0; button < kButtons; ++button) {
      if (repeats_button(button)) return true;
    }
    return std::any_of(axes.begin(), axes.end(), repeats);
  }
  bool waits() const {
    return wait_ticks_max > 0 && (std::any_of(axes.begin(), axes.end(), waits_for) ||
                                  std::any_of(buttons.begin(), buttons.end(), waits_for));
  }
  /// What stands for a missing input after `last` was given.
  scenes::SeatInput repeated(const scenes::SeatInput& last) const {
    scenes::SeatInput input;
    for (std::size_t axis = 0; axis < axes.size(); ++axis) {
      if (repeats_axis(axis)) input.axes[axis] = last.axes[axis];
    }
    for (std::size_t button = 0; button < kButtons; ++button) {
      const auto bit = static_cast<std::uint16_t>(1u << button);
      if (repeats_button(button))
        input.buttons = static_cast<std::uint16_t>(input.buttons | (last.buttons & bit));
    }
    return input;
  }
};

/// What becomes of a seated player whose inputs stay away for `slow_ticks_max` ticks in a row.
enum class SlowPeer : std::uint8_t {
  kWait = 0,      ///< Its controls are waited for as before, for as long as it stays.
  kReplace = 1,   ///< No tick waits for it any more until it is in time again.
  kSpectate = 2,  ///< It loses its seat and may look on.
  kDrop = 3,      ///< It is sent away with kTooSlow.
};

/// The lead that clients are told to keep: fixed, or following how late their inputs come.
struct DelayPolicy {
  bool adaptive = false;
  std::uint32_t ticks_min = 1;
  std::uint32_t ticks_max = 15;
};

}  // namespace cycloid::server
