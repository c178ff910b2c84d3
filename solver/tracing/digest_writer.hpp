#pragma once

#ifndef XXH_INLINE_ALL
#define XXH_INLINE_ALL
#endif
#include <xxhash.h>

#include <array>

#include "solver/bytes.hpp"

namespace cycloid::solver {

/// Feeds numbers to XXH3 through a buffer on the stack, as little-endian canonical bits.
class DigestWriter {
 public:
  DigestWriter() { XXH3_64bits_reset(&state_); }

  template <class T>
  void operator()(const T& value) {
    const auto bits = canonical_bits_of(value);
    if (used_ + sizeof bits > buffer_.size()) flush();
    store_little(bits, buffer_.data() + used_);
    used_ += sizeof bits;
  }

  std::uint64_t digest() {
    flush();
    return XXH3_64bits_digest(&state_);
  }

 private:
  void flush() {
    XXH3_64bits_update(&state_, buffer_.data(), used_);
    used_ = 0;
  }

  XXH3_state_t state_;
  std::array<std::byte, 1024> buffer_;
  std::size_t used_ = 0;
};

}  // namespace cycloid::solver
