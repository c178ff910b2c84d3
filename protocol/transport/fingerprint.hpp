#pragma once

#include <openssl/x509.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace cycloid::transport {

/// SHA-256 of a certificate, as `openssl x509 -fingerprint -sha256` has it.
using Fingerprint = std::array<std::uint8_t, 32>;

/// @pre certificate is not null
inline Fingerprint fingerprint_of(const X509* certificate) {
  Fingerprint digest{};
  unsigned bytes = 0;
  X509_digest(certificate, EVP_sha256(), digest.data(), &bytes);
  return digest;
}

/// 64 hexadecimal digits.
inline std::string fingerprint_text(const Fingerprint& fingerprint) {
  std::string text;
  for (const std::uint8_t byte : fingerprint) {
    text += "0123456789abcdef"[byte >> 4];
    text += "0123456789abcdef"[byte & 15];
  }
  return text;
}

/// Digits of either case, with colons between bytes or without; nothing where it is anything else.
inline std::optional<Fingerprint> parse_fingerprint(std::string_view text) {
  Fingerprint fingerprint{};
  std::size_t digits = 0;
  for (const char letter : text) {
    if (letter == ':' && digits % 2 == 0 && digits > 0) continue;
    const std::string_view kDigits = "0123456789abcdefABCDEF";
    std::size_t digit = kDigits.find(letter);
    if (digit == std::string_view::npos || digits == 2 * fingerprint.size()) return {};
    if (digit > 15) digit -= 6;
    fingerprint[digits / 2] = static_cast<std::uint8_t>(fingerprint[digits / 2] << 4 | digit);
    ++digits;
  }
  if (digits != 2 * fingerprint.size()) return {};
  return fingerprint;
}

}  // namespace cycloid::transport
