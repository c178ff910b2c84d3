#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

namespace cycloid::solver {

/// The unsigned integer with the bits of a number; enumerators by their underlying value.
template <class T>
auto bits_of(T value) {
  if constexpr (sizeof(T) == 8) {
    return std::bit_cast<std::uint64_t>(value);
  } else {
    static_assert(sizeof(T) == 4);
    return std::bit_cast<std::uint32_t>(value);
  }
}

/// The bits, with both zeros made one and every NaN made one: NaN payloads differ between targets,
/// and a lone sign of zero shows in the next value that depends on it.
template <class T>
auto canonical_bits_of(T value) {
  if constexpr (std::is_floating_point_v<T>) {
    if (value == 0.0f) return std::uint32_t{0};
    if (value != value) return std::uint32_t{0x7fc00000u};
  }
  return bits_of(value);
}

/// Little-endian, whatever the host.
template <class U>
void store_little(U value, std::byte* to) {
  for (std::size_t i = 0; i < sizeof(U); ++i) to[i] = static_cast<std::byte>(value >> (8 * i));
}
template <class U>
U load_little(const std::byte* from) {
  U value = 0;
  for (std::size_t i = 0; i < sizeof(U); ++i)
    value |= static_cast<U>(static_cast<U>(from[i]) << (8 * i));
  return value;
}

/// Reads numbers one by one; after the first that is not there, everything is zero and `failed`.
struct ByteReader {
  std::span<const std::byte> bytes;
  bool failed = false;

  template <class T>
  void operator()(T& value) {
    using U = decltype(bits_of(value));
    if (failed || bytes.size() < sizeof(U)) {
      failed = true;
      value = T{};
      return;
    }
    value = std::bit_cast<T>(load_little<U>(bytes.data()));
    bytes = bytes.subspan(sizeof(U));
  }
};

}  // namespace cycloid::solver
