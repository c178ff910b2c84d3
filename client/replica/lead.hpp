#pragma once

#include <cstdint>

#include "protocol/lockstep.hpp"
#include "protocol/messages.hpp"

namespace cycloid::client {

/// Chooses how many ticks ahead of the last frame a client sends its inputs, so that the worst of
/// them reaches the server 1 to 2 ticks before its tick is closed.
///
/// A margin speaks of inputs that were sent before it could be heard, so after each change the lead
/// stands until a margin tells of inputs sent since. It is raised at once when an input came with
/// less than a tick to spare. It is lowered only by what every input of a watch had to spare, and
/// each time that this proves wrong, by a raise after it, watches are twice as long from then on:
/// so jitter moves it up soon and down late. Integers only; no clock: time is the server's ticks.
class LeadController {
 public:
  /// What a lowered or raised lead aims at, and what is left alone: 1 to kEarlyTicksWanted.
  static constexpr std::int32_t kEarlyTicksWanted = 2;
  static constexpr std::uint32_t kLeadTicksMax = protocol::kInputWindowTicks;
  static constexpr std::uint64_t kWatchTicksMin = 16;
  static constexpr std::uint64_t kWatchTicksMax = 1024;

  /// Begins anew, with the lead that the server asks for, at the state of `tick`.
  void start(std::uint64_t tick, std::uint32_t delay_ticks);
  /// The room's delay has changed: the lead moves by as much. `sent_tick` is the last tick for
  /// which an input was sent.
  void change_delay(std::uint32_t delay_ticks, std::uint64_t sent_tick);
  /// Nothing is learnt where no input was sent yet (`sent_tick` 0) or none has come in.
  void take(const protocol::Margin& margin, std::uint64_t sent_tick);

  std::uint32_t lead_ticks() const { return lead_; }
  std::uint64_t changes() const { return changes_; }

 private:
  void move(std::int64_t by_ticks, std::uint64_t settles_tick);

  std::uint32_t delay_ = 0;
  std::uint32_t lead_ = 1;
  std::uint64_t margin_tick_ = 0;   ///< Of the last margin, where the next one's inputs begin.
  std::uint64_t settles_tick_ = 0;  ///< From here on margins tell of the lead as it is now.
  bool watching_ = false;
  bool lowered_ = false;  ///< Since the last raise.
  std::uint64_t watch_begin_ = 0;
  std::int32_t watch_worst_ = 0;
  std::uint64_t watch_ticks_ = kWatchTicksMin;
  std::uint64_t changes_ = 0;
};

}  // namespace cycloid::client
