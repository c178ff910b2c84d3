#pragma once

#include <cstdint>
#include <string>

#include "protocol/messages.hpp"

namespace cycloid::protocol {

/// A digest as it is always written: 16 hexadecimal digits.
std::string hex16(std::uint64_t value);

/// Text from outside for a line of a log: control characters are replaced, so that nothing in it
/// may look like another line or move a cursor.
std::string printable(std::string text);

/// "given", "repeated", "absent", "neutral".
const char* origin_name(Origin origin);
/// "join", "leave", "kick", "lost", "resume".
const char* event_kind_name(EventKind kind);
/// "input_delay".
const char* change_kind_name(ChangeKind kind);
/// "kTokenExpired"; "an unknown code" for a number that is none.
const char* refusal_name(Refusal code);

}  // namespace cycloid::protocol
