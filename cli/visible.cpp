#include "cli/visible.hpp"

#include <algorithm>
#include <cstdint>

namespace cycloid::cli {

std::size_t character_bytes(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[at + i]); };
  const unsigned lead = byte(0);
  if (lead < 0x80) {
    const bool held = lead >= 0x20 || lead == '\t' || lead == '\n' || lead == '\r';
    return held && lead != 0x7f ? 1 : 0;
  }
  const std::size_t size = lead < 0xc2   ? 0
                           : lead < 0xe0 ? 2
                           : lead < 0xf0 ? 3
                           : lead < 0xf5 ? 4
                                         : 0;
  if (size == 0 || text.size() - at < size) return 0;
  std::uint32_t code = lead & (0xffu >> (size + 1));
  for (std::size_t i = 1; i < size; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return 0;
    code = code << 6 | (byte(i) & 0x3f);
  }
  const bool overlong = (size == 3 && code < 0x800) || (size == 4 && code < 0x10000);
  const bool surrogate = code >= 0xd800 && code <= 0xdfff;
  const bool control = code < 0xa0;  // Allowed, and bad to read.
  return overlong || surrogate || control || code == 0xfffe || code == 0xffff || code > 0x10ffff
             ? 0
             : size;
}

std::string escaped_byte(char byte) {
  const auto value = static_cast<unsigned char>(byte);
  return {'\\', 'x', "0123456789abcdef"[value >> 4], "0123456789abcdef"[value & 15]};
}

static std::string visible_but(std::string_view text, std::string_view kept) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t size = character_bytes(text, at);
    const bool control = static_cast<unsigned char>(text[at]) < 0x20;
    if (size == 0 || (control && kept.find(text[at]) == std::string_view::npos))
      out += escaped_byte(text[at]);
    else
      out += text.substr(at, size);
    at += std::max<std::size_t>(size, 1);
  }
  return out;
}

std::string visible(std::string_view text) {
  return visible_but(text, "");
}

std::string visible_lines(std::string_view text) {
  return visible_but(text, "\n\t");
}

}  // namespace cycloid::cli
