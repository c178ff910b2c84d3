#pragma once

#include <cstdint>
#include <string>

#include "protocol/messages.hpp"

namespace cycloid::server {

/// Why a client is sent away that announced a message of such a size. @pre it is 0, or over the
/// most.
inline protocol::Refused wrong_size(std::uint32_t announced_bytes, std::uint32_t bytes_max) {
  using protocol::Refusal;
  return {announced_bytes == 0 ? Refusal::kBadMessage : Refusal::kTooLarge,
          "a message of " + std::to_string(announced_bytes) + " bytes, of 1 to " +
              std::to_string(bytes_max)};
}

}  // namespace cycloid::server
