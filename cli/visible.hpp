#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace cycloid::cli {

/// The length of the UTF-8 character that begins at `at`, or 0 where none does that XML may hold.
std::size_t character_bytes(std::string_view text, std::size_t at);

/// Such as \x1b.
std::string escaped_byte(char byte);

/// Text from outside for a terminal: what would move its cursor, begin a line or is no UTF-8 is
/// written as \xNN.
std::string visible(std::string_view text);

/// The same of text with lines of its own.
std::string visible_lines(std::string_view text);

}  // namespace cycloid::cli
