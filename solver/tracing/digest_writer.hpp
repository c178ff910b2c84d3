#pragma once

#ifndef XXH_INLINE_ALL
#define XXH_INLINE_ALL
#endif
#include <xxhash.h>

#include <array>
#include <span>

#include "solver/bytes.hpp"
#include "solver/record_bytes.hpp"

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

  /// As each number of each record.
  template <class R>
  void records(std::span<const R> records) {
    if constexpr (kCopiesRecords<R>) {
      // In one run the order of numbers is that of memory, on machines of either byte order.
      if constexpr (kWordRuns<R>.count == 1 && float_words<R>() == RecordWords<R>{})
        return raw(std::as_bytes(records));
      if constexpr (kWordRuns<R>.count == 1) records = as_in_memory(records);
      for (; records.size() >= 4; records = records.subspan(4)) four(records.first(4));
    }
    for (const R& record : records) visit_words(record, *this);
  }

  std::uint64_t digest() {
    flush();
    return XXH3_64bits_digest(&state_);
  }

 private:
  void raw(std::span<const std::byte> bytes) {
    flush();
    if (!bytes.empty()) XXH3_64bits_update(&state_, bytes.data(), bytes.size());
  }

  /// All whole fours of records, from memory where they are canonical there, as most are: to look
  /// is cheaper than to copy. @returns the rest.
  template <class R>
  std::span<const R> as_in_memory(std::span<const R> records) {
    while (records.size() >= 4) {
      std::size_t canonical = 0;
      while (records.size() - canonical >= 4 &&
             is_canonical(std::as_bytes(records.subspan(canonical, 4)), kFloatWords<R>.data()))
        canonical += 4;
      raw(std::as_bytes(records.first(canonical)));
      records = records.subspan(canonical);
      if (records.size() < 4) break;
      four(records.first(4));
      records = records.subspan(4);
    }
    return records;
  }

  template <class R>
  void four(std::span<const R> records) {
    constexpr std::size_t kFourBytes = 4 * sizeof(R);
    static_assert(kFourBytes <= kBufferBytes);
    if (used_ + kFourBytes > buffer_.size()) flush();
    std::byte* at = buffer_.data() + used_;
    write_by_copy(records, at);
    for (std::size_t i = 0; i < kFloatWords<R>.size(); i += 4)
      make_canonical(at + 4 * i, kFloatWords<R>.data() + i);
    used_ += kFourBytes;
  }

  void flush() {
    XXH3_64bits_update(&state_, buffer_.data(), used_);
    used_ = 0;
  }

  XXH3_state_t state_;
  static constexpr std::size_t kBufferBytes = 4096;
  std::array<std::byte, kBufferBytes> buffer_;
  std::size_t used_ = 0;
};

}  // namespace cycloid::solver
