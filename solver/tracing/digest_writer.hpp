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
  /// Part of what a digest is: with another number all digests are others.
  static constexpr std::size_t kFewBytes = 512;

  template <class T>
  void operator()(const T& value) {
    const auto bits = canonical_bits_of(value);
    if (used_ + sizeof bits > buffer_.size()) flush();
    store_little(bits, buffer_.data() + used_);
    used_ += sizeof bits;
  }

  /// As each number of each record; more bytes of them than kFewBytes as a digest of their own, for
  /// which they are read where they lie.
  template <class R>
  void records(std::span<const R> records) {
    constexpr std::size_t kBytes = visited_bytes<R>();
    if (records.size() * kBytes > kFewBytes) return (*this)(digest_of(records));
    parts<R>(records);
  }

  /// As each number of that part of each record, which is one of its bases or the record itself.
  template <class Part, class R>
  void parts(std::span<const R> records) {
    if constexpr (kCopiesRecords<Part>)
      while (!records.empty()) records = by_copy<Part>(records);
    else
      for (const R& record : records) visit_words(static_cast<const Part&>(record), *this);
  }

  std::uint64_t digest() {
    if (!is_begun_) return functions_.whole(buffer_.data(), used_);
    flush();
    return XXH3_64bits_digest(&state_);
  }

 private:
  /// From memory where records are canonical there, as most are: to look is cheaper than to copy.
  template <class R>
  std::uint64_t digest_of(std::span<const R> records) const {
    if constexpr (kCopiesRecords<R> && kWordRuns<R>.count == 1) {
      const auto bytes = std::as_bytes(records);
      if (canonical_bytes<R>(bytes) == bytes.size())
        return functions_.whole(bytes.data(), bytes.size());
    }
    DigestWriter of_records;
    of_records.parts<R>(records);
    return of_records.digest();
  }

  /// Of the numbers of so many parts, one behind the other, how many bytes are canonical as they
  /// are; in whole periods.
  template <class Part>
  std::size_t canonical_bytes(std::span<const std::byte> numbers) const {
    if constexpr (float_words<Part>() == RecordWords<Part>{}) return numbers.size();
    return functions_.canonical_bytes(numbers.data(), numbers.size(), kFloatWords<Part>.data(),
                                      sizeof kFloatWords<Part>);
  }

  /// As many parts as the buffer takes. @returns the rest of the records.
  template <class Part, class R>
  std::span<const R> by_copy(std::span<const R> records) {
    constexpr std::size_t kPeriod = sizeof kFloatWords<Part>;
    static_assert(kPeriod <= kBufferBytes);
    if (used_ + kPeriod > buffer_.size()) flush();
    const std::size_t room = (buffer_.size() - used_) / sizeof(Part);
    const auto some = records.first(std::min(records.size(), room));
    const std::span numbers(buffer_.data() + used_, some.size() * sizeof(Part));
    std::byte* at = numbers.data();
    for (const R& record : some)
      at = write_by_copy(std::span(static_cast<const Part*>(&record), 1), at);
    for (std::size_t i = canonical_bytes<Part>(numbers); i < numbers.size(); i += kPeriod)
      make_canonical(numbers.data() + i, std::min(kPeriod, numbers.size() - i) / kWordBytes,
                     kFloatWords<Part>.data());
    used_ += numbers.size();
    return records.subspan(some.size());
  }

  void flush() {
    if (!is_begun_) XXH3_64bits_reset(&state_);
    is_begun_ = true;
    functions_.update(state_, buffer_.data(), used_);
    used_ = 0;
  }

  static constexpr std::size_t kWordBytes = sizeof(std::uint32_t);
  static constexpr std::size_t kBufferBytes = 8192;

  DigestFunctions functions_ = digest_functions();
  XXH3_state_t state_;
  bool is_begun_ = false;
  std::size_t used_ = 0;
  std::array<std::byte, kBufferBytes> buffer_;
};

}  // namespace cycloid::solver
