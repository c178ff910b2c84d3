#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace cycloid::solver {

/// Which bodies take part in a tick by themselves (`is_active`), kept from tick to tick: only those
/// that were awake and those that a call has touched are asked again, so that who sleeps costs
/// nothing. A pure cache: with it or without, the answers are a function of the state.
struct ActiveBodies {
  std::vector<std::uint8_t> active;    ///< By body.
  std::vector<std::uint8_t> has_mass;  ///< By body: it can move, and a force moves it.
  std::vector<std::uint32_t> slots;    ///< Of active ones, ascending.
  std::vector<std::uint32_t> to_ask;   ///< Of all that may not be as they were in the last tick.
  std::uint32_t asleep = 0;            ///< Those that have mass and are not active.
  bool is_known = false;               ///< Otherwise all are asked.
  bool is_sorted = true;               ///< Those to ask are.

  /// Something happened that may concern any body, or another state is in place.
  void forget_all() {
    is_known = false;
    to_ask.clear();
  }
  /// Its velocity, force, mass or sleep was changed, or it came, or is about to go.
  void touch(std::uint32_t slot) {
    if (!is_known) return;
    if (to_ask.size() > 2 * active.size() + 64) return forget_all();
    to_ask.push_back(slot);
    is_sorted = false;
  }
  /// Those alone may be otherwise in the next tick. @param awake  ascending
  void ask_next(const std::vector<std::uint32_t>& awake) {
    to_ask.assign(awake.begin(), awake.end());
    is_sorted = true;
  }
  /// What was touched comes in any order, and more than once.
  void sort() {
    if (is_sorted) return;
    is_sorted = true;
    // Total order: equal integers are one and the same, and of those one is left.
    std::sort(to_ask.begin(), to_ask.end());
    to_ask.erase(std::unique(to_ask.begin(), to_ask.end()), to_ask.end());
  }
};

}  // namespace cycloid::solver
