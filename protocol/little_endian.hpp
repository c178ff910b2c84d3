#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "solver/bytes.hpp"

namespace cycloid::protocol {

/// Appends an unsigned integer, least significant byte first.
template <class U>
void append_little(U value, std::vector<std::byte>& into) {
  // Not by insert: GCC 12 for 32-bit targets believes that it writes into nothing.
  into.resize(into.size() + sizeof(U));
  solver::store_little(value, into.data() + into.size() - sizeof(U));
}

/// Takes unsigned integers off the front. After the first that is not there, all are 0 and
/// `failed`.
struct LittleReader {
  std::span<const std::byte> bytes;
  bool failed = false;

  template <class U>
  U take() {
    const std::span<const std::byte> from = take_bytes(sizeof(U));
    return failed ? U{0} : solver::load_little<U>(from.data());
  }
  std::span<const std::byte> take_bytes(std::size_t count) {
    failed = failed || bytes.size() < count;
    if (failed) return {};
    const std::span<const std::byte> taken = bytes.first(count);
    bytes = bytes.subspan(count);
    return taken;
  }
};

}  // namespace cycloid::protocol
