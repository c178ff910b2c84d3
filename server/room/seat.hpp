#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "protocol/lockstep.hpp"
#include "protocol/messages.hpp"

namespace cycloid::server {

/// Names a connection for the life of a room; never given out twice.
using PeerId = std::uint64_t;
inline constexpr PeerId kNobody = 0;

/// A seat: who holds it and what was said for the ticks to come.
class Seat {
 public:
  PeerId holder() const { return holder_; }
  void hand_to(PeerId holder) { *this = Seat(holder); }
  void free() { *this = Seat(kNobody); }

  /// Until the tick is made, the last word counts.
  /// @pre `tick` is in the window of inputs.
  void say(std::uint64_t tick, const scenes::SeatInput& input) {
    said_[slot(tick)] = {tick, input};
  }

  /// Closes the input of one tick.
  protocol::SeatFrame close(std::uint64_t tick) {
    const Said& said = said_[slot(tick)];
    if (said.tick == tick) {
      last_ = said.input;
      return {protocol::Origin::kGiven, said.input};
    }
    if (last_) return {protocol::Origin::kRepeated, *last_};
    return {protocol::Origin::kAbsent, {}};
  }

  Seat() = default;

 private:
  explicit Seat(PeerId holder) : holder_(holder) {}

  struct Said {
    std::uint64_t tick = 0;
    scenes::SeatInput input;
  };
  static std::size_t slot(std::uint64_t tick) { return tick % protocol::kInputWindowTicks; }

  PeerId holder_ = kNobody;
  std::array<Said, protocol::kInputWindowTicks> said_{};
  std::optional<scenes::SeatInput> last_;
};

}  // namespace cycloid::server
