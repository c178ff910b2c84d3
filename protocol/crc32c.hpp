#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace cycloid::protocol {

namespace detail {

constexpr std::array<std::uint32_t, 256> make_crc32c_table() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < table.size(); ++i) {
    std::uint32_t value = i;
    for (int bit = 0; bit < 8; ++bit) value = (value >> 1) ^ ((value & 1) != 0 ? 0x82f63b78u : 0u);
    table[i] = value;
  }
  return table;
}

inline constexpr auto kCrc32cTable = make_crc32c_table();

}  // namespace detail

/// CRC-32C (Castagnoli). `crc` is that of the bytes before, 0 for none: the check of a whole is
/// found piece by piece. One table and no instruction set, because the packaged crc32c library has
/// no WebAssembly build and a log record is small. Source: RFC 3720, section 12.1 and B.4.
constexpr std::uint32_t crc32c(std::span<const std::byte> bytes, std::uint32_t crc = 0) {
  crc = ~crc;
  for (const std::byte byte : bytes) {
    crc = (crc >> 8) ^ detail::kCrc32cTable[(crc ^ static_cast<std::uint32_t>(byte)) & 0xffu];
  }
  return ~crc;
}

}  // namespace cycloid::protocol
