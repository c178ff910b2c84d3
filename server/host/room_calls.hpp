#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "server/host/act_result.hpp"
#include "server/room/options.hpp"

namespace cycloid::server {

// What the host asks of a room beyond the room's own life: one place, whichever of it a room has.

/// @returns 404 where nobody sits there, 501 where this room takes no seats away.
template <class AnyRoom>
ActResult kick_seat(AnyRoom& room, std::uint16_t seat, const std::string& reason) {
  if constexpr (requires { room.kick(seat, reason); }) {
    if (room.kick(seat, reason)) return {};
    return {404, "seat: nobody sits in " + std::to_string(seat)};
  } else {
    return {501, "kick: rooms of this build cannot take a seat away"};
  }
}

template <class AnyRoom>
ActResult rewind_room(AnyRoom& room, std::uint64_t tick) {
  if constexpr (requires { room.rewind(tick); }) {
    const std::string why = room.rewind(tick);
    return why.empty() ? ActResult{} : ActResult{409, "tick: " + why};
  } else {
    return {501, "rewind: rooms of this build cannot go back"};
  }
}

template <class AnyRoom>
ActResult rotate_room_log(AnyRoom& room) {
  if constexpr (requires { room.rotate_log(); }) {
    const std::string why = room.rotate_log();
    return why.empty() ? ActResult{} : ActResult{409, why};
  } else {
    return {501, "rotate: a log of this build begins at tick 0, so it cannot go on in a new file"};
  }
}

/// The exact state of the last tick, or nothing.
template <class AnyRoom>
std::vector<std::byte> state_of(const AnyRoom& room) {
  std::vector<std::byte> state;
  if constexpr (requires { room.encode_state(state); }) room.encode_state(state);
  return state;
}

template <class AnyRoom>
void limit_room(AnyRoom& room, const Limits& limits) {
  if constexpr (requires { room.set_limits(limits); }) room.set_limits(limits);
}

}  // namespace cycloid::server
