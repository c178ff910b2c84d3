#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/messages.hpp"

namespace cycloid::protocol {

// An InputFrame in few bytes. Numbers are whole, 7 bits a byte, least significant first, in as few
// bytes as they need. In order:
//
//   tick, number of seats
//   of each seat a byte: its origin less one (2 bits), which of its four axes are not zero (4
//   bits),
//     whether its buttons are not zero (1 bit), and a bit that is zero; then those axes, 2 bytes
//     each, least significant first, and those buttons, a number
//   nothing more, where there are neither events nor changes; else
//   number of events, of each its kind (a byte) and its seat (a number)
//   number of changes, of each its kind (a byte) and its value (a number)
//
// A frame has one such form, and only that is read.

/// Appends the frame to `into`. @pre it is one that `unpack_frame` takes.
void pack_frame(const InputFrame& frame, std::vector<std::byte>& into);

/// The frame; or nothing, and `error` says what is wrong with the bytes. Holds at most 12 times as
/// much as they are.
std::optional<InputFrame> unpack_frame(std::span<const std::byte> bytes, std::string& error);

}  // namespace cycloid::protocol
