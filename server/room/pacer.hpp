#pragma once

#include <algorithm>
#include <cstdint>

#include "protocol/lockstep.hpp"

namespace cycloid::server {

/// When the next tick of a room may be made: the schedule, and what holds it up. A tick that was
/// held up, by a wait, a pause or overload, moves all later ones: none is skipped or hurried. And
/// when peers are to be served, which happens with every tick, and without one where none is made
/// for long.
class Pacer {
 public:
  Pacer(std::int64_t now_ns, std::uint32_t rate_millihertz)
      : schedule_(now_ns, rate_millihertz),
        tick_ns_(schedule_.deadline_ns(1) - schedule_.deadline_ns(0)),
        served_ns_(now_ns) {}

  std::int64_t tick_ns() const { return tick_ns_; }
  std::int64_t due_ns(std::uint64_t tick) const { return schedule_.deadline_ns(tick); }

  /// Whether the tick, which is due and lacks an input, goes on waiting. @param ticks_max  from
  /// when it was due.
  bool waits(std::uint64_t tick, std::int64_t now_ns, std::uint32_t ticks_max) {
    const std::int64_t end_ns = due_ns(tick) + tick_ns_ * static_cast<std::int64_t>(ticks_max);
    waiting_ = now_ns < end_ns;
    if (waiting_) poll_ns_ = std::min(end_ns, now_ns + tick_ns_ / kPollsPerTick);
    return waiting_;
  }
  bool waiting() const { return waiting_; }
  /// The tick that waited is made now. Returns by how long it was held up.
  std::int64_t end_wait(std::uint64_t tick, std::int64_t now_ns) {
    waiting_ = false;
    const std::int64_t held_ns = std::max<std::int64_t>(now_ns - due_ns(tick), 0);
    schedule_.delay(held_ns);
    return held_ns;
  }

  void pause(std::int64_t now_ns) {
    paused_ = true;
    paused_ns_ = now_ns;
  }
  bool paused() const { return paused_; }
  /// Returns by how long the match is put off: whole ticks, so that its phase stays.
  std::int64_t resume(std::int64_t now_ns) {
    paused_ = false;
    served_ns_ = now_ns;  // From here on ticks serve.
    const std::int64_t stood_ns = std::max<std::int64_t>(now_ns - paused_ns_, 0);
    const std::int64_t by_ns = (stood_ns + tick_ns_ - 1) / tick_ns_ * tick_ns_;
    schedule_.delay(by_ns);
    return by_ns;
  }

  void delay(std::int64_t by_ns) { schedule_.delay(by_ns); }
  /// The match goes on from an earlier tick, at the time at which it would have gone on anyway.
  void rewind(std::uint64_t from_tick, std::uint64_t to_tick) {
    schedule_.delay(due_ns(from_tick) - due_ns(to_tick));
  }

  /// Peers were served.
  void note_served(std::int64_t now_ns) { served_ns_ = now_ns; }
  /// Whether they are to be served though no tick is made.
  bool serves(std::int64_t now_ns) const { return now_ns >= served_ns_ + kServeNs; }

  /// When to ask again whether `tick` is to be made, or peers to be served.
  std::int64_t next_ns(std::uint64_t tick) const {
    const std::int64_t serves_ns = served_ns_ + kServeNs;
    if (paused_) return serves_ns;
    // A pause while a tick waited has put it off beyond the next look.
    return std::min(waiting_ ? std::max(poll_ns_, due_ns(tick)) : due_ns(tick), serves_ns);
  }

 private:
  /// Of a tick that waits: the last input may come at any moment.
  static constexpr std::int64_t kPollsPerTick = 8;
  /// The longest that peers wait for a tick to serve them: short for a client that must hear a pong
  /// in time, and long enough that at usual rates only ticks count.
  static constexpr std::int64_t kServeNs = 100'000'000;

  protocol::Schedule schedule_;
  std::int64_t tick_ns_;
  bool waiting_ = false;
  bool paused_ = false;
  std::int64_t paused_ns_ = 0;
  std::int64_t poll_ns_ = 0;
  std::int64_t served_ns_;
};

}  // namespace cycloid::server
