#pragma once

#include <algorithm>
#include <array>
#include <cstring>
#include <span>

#include "solver/bytes.hpp"
#include "solver/record_bytes.hpp"
#include "solver/tracing/digest_kernels.hpp"

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
    // In one run the order of numbers is that of memory.
    if constexpr (kCopiesRecords<R> && kWordRuns<R>.count == 1)
      in_memory(records);
    else if constexpr (kCopiesRecords<R>)
      while (!records.empty()) records = by_copy(records);
    else
      for (const R& record : records) visit_words(record, *this);
  }

  std::uint64_t digest() {
    flush();
    return XXH3_64bits_digest(&state_);
  }

 private:
  void raw(std::span<const std::byte> bytes) {
    if (bytes.size() <= kFewBytes) {
      if (used_ + bytes.size() > buffer_.size()) flush();
      if (!bytes.empty()) std::memcpy(buffer_.data() + used_, bytes.data(), bytes.size());
      used_ += bytes.size();
      return;
    }
    flush();
    functions_.update(state_, bytes.data(), bytes.size());
  }

  /// From memory where records are canonical there, as most are: to look is cheaper than to copy.
  template <class R>
  void in_memory(std::span<const R> records) {
    if constexpr (float_words<R>() == RecordWords<R>{}) return raw(std::as_bytes(records));
    while (!records.empty()) {
      const auto bytes = std::as_bytes(records);
      const std::size_t canonical = functions_.canonical_bytes(
          bytes.data(), bytes.size(), kFloatWords<R>.data(), sizeof kFloatWords<R>);
      raw(bytes.first(canonical));
      records = records.subspan(canonical / sizeof(R));
      if (!records.empty()) records = by_copy(records);
    }
  }

  /// A period of records, or what there is of one. @returns the rest.
  template <class R>
  std::span<const R> by_copy(std::span<const R> records) {
    static_assert(sizeof kFloatWords<R> <= kBufferBytes);
    const auto some = records.first(std::min(records.size(), kRecordsPerPeriod));
    if (used_ + some.size_bytes() > buffer_.size()) flush();
    std::byte* at = buffer_.data() + used_;
    write_by_copy(some, at);
    make_canonical(at, some.size() * kRecordWords<R>, kFloatWords<R>.data());
    used_ += some.size_bytes();
    return records.subspan(some.size());
  }

  void flush() {
    functions_.update(state_, buffer_.data(), used_);
    used_ = 0;
  }

  static constexpr std::size_t kBufferBytes = 8192;
  /// What is copied rather than begin an update of XXH3.
  static constexpr std::size_t kFewBytes = 512;

  DigestFunctions functions_ = digest_functions();
  XXH3_state_t state_;
  std::array<std::byte, kBufferBytes> buffer_;
  std::size_t used_ = 0;
};

}  // namespace cycloid::solver
