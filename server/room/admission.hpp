#pragma once

#include <cstdint>
#include <string>

#include "protocol/messages.hpp"

namespace cycloid::server {

/// What a connection may do in a room.
enum class Role : std::uint8_t { kPlayer = 1, kSpectator = 2, kAdmin = 3 };

/// A connection that the gate has let through: who it is, and what it said.
struct Admission {
  protocol::Hello hello;
  Role role = Role::kPlayer;
  std::int32_t seat = protocol::kAnySeat;  ///< Bound by the token; kAnySeat: the wish counts.
  std::string identity;                    ///< Of the token; "" where none was asked for.
  std::string address;                     ///< For the log.
};

}  // namespace cycloid::server
