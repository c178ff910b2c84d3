#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "protocol/lockstep.hpp"
#include "protocol/messages.hpp"
#include "server/room/policy.hpp"

namespace cycloid::server {

/// What one seat has said for the ticks to come.
class InputWindow {
 public:
  /// Until the tick is made the last word counts. How many there were for it, this one included.
  /// @pre `tick` is in the window of inputs after `made`.
  std::uint32_t say(std::uint64_t made, std::uint64_t tick, const scenes::SeatInput& input) {
    Said& said = said_[slot(tick)];
    const std::uint32_t words = said.tick == tick ? said.words + 1 : 1;
    said = {tick, static_cast<std::uint32_t>(tick - made - 1), words, input};
    return words;
  }

  /// What was said stands, and who goes on from here has said none of it yet.
  void count_anew() {
    for (Said& said : said_) said.words = 0;
  }

  bool has(std::uint64_t tick) const { return said_[slot(tick)].tick == tick; }
  /// Ticks that were to be made before `tick` when its input came; nothing where none came.
  std::optional<std::uint32_t> early_ticks(std::uint64_t tick) const {
    const Said& said = said_[slot(tick)];
    return said.tick == tick ? std::optional(said.early_ticks) : std::nullopt;
  }
  /// One came too late.
  void note_late() { late_ = true; }
  /// Whether its holder is one to expect inputs of: it gave one, or tried to.
  bool spoke() const { return last_.has_value() || late_; }

  /// Closes the input of one tick; ticks are closed in order.
  protocol::SeatFrame close(std::uint64_t tick, const InputPolicy& policy) {
    const Said& said = said_[slot(tick)];
    if (said.tick == tick) {
      last_ = said.input;
      return {protocol::Origin::kGiven, said.input};
    }
    if (!last_) return {protocol::Origin::kAbsent, {}};
    if (!policy.repeats_any()) return {protocol::Origin::kNeutral, {}};
    return {protocol::Origin::kRepeated, policy.repeated(*last_)};
  }

  /// As `close`, while the seat waits for its holder: what was said in time counts, and nobody
  /// steers by what was said before.
  protocol::SeatFrame close_lost(std::uint64_t tick) {
    const Said& said = said_[slot(tick)];
    if (said.tick == tick) {
      last_ = said.input;  // Its holder may come back before the next tick, and be repeated.
      return {protocol::Origin::kGiven, said.input};
    }
    last_.reset();
    late_ = false;
    return {protocol::Origin::kNeutral, {}};
  }

 private:
  struct Said {
    std::uint64_t tick = 0;
    std::uint32_t early_ticks = 0;
    std::uint32_t words = 0;
    scenes::SeatInput input;
  };
  static std::size_t slot(std::uint64_t tick) { return tick % protocol::kInputWindowTicks; }

  std::array<Said, protocol::kInputWindowTicks> said_{};
  std::optional<scenes::SeatInput> last_;
  bool late_ = false;
};

}  // namespace cycloid::server
