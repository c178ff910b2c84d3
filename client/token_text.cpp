#include "client/token_text.hpp"

#include <cstdint>

#include "protocol/messages.hpp"

namespace cycloid::client {

/// RFC 4648, section 5. @returns 64 where the letter is none.
static std::uint32_t value_of(char letter) {
  if (letter >= 'A' && letter <= 'Z') return static_cast<std::uint32_t>(letter - 'A');
  if (letter >= 'a' && letter <= 'z') return static_cast<std::uint32_t>(letter - 'a') + 26;
  if (letter >= '0' && letter <= '9') return static_cast<std::uint32_t>(letter - '0') + 52;
  if (letter == '-') return 62;
  return letter == '_' ? 63 : 64;
}

std::optional<std::vector<std::byte>> token_from_text(std::string_view text) {
  const bool whole = text.size() % 4 != 1;
  if (text.empty() || !whole || text.size() * 3 / 4 > protocol::kTokenBytesMax) return std::nullopt;
  std::vector<std::byte> token;
  std::uint32_t bits = 0;
  int held = 0;
  for (const char letter : text) {
    const std::uint32_t value = value_of(letter);
    if (value > 63) return std::nullopt;
    bits = bits << 6 | value;
    held += 6;
    if (held < 8) continue;
    held -= 8;
    token.push_back(static_cast<std::byte>(bits >> held & 0xffu));
  }
  const bool rest_is_zero = (bits & ((1u << held) - 1u)) == 0;
  if (!rest_is_zero) return std::nullopt;
  return token;
}

}  // namespace cycloid::client
