#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <utility>

#include "solver/bytes.hpp"
#include "solver/visit.hpp"

namespace cycloid::solver {

/// How arrays of records become bytes and back: number by number anywhere, and by copies where
/// memory holds the numbers as the encoding does. Both give the same bytes.

/// The numbers of a record of 4-byte numbers.
template <class R>
inline constexpr std::size_t kRecordWords = visited_bytes<R>() / sizeof(std::uint32_t);
template <class R>
using RecordWords = std::array<std::uint32_t, kRecordWords<R>>;

/// Numbers that follow one another in memory and in the encoding alike; all counted in numbers.
struct WordRun {
  std::size_t memory = 0;    ///< Where it begins in a record in memory,
  std::size_t encoding = 0;  ///< and in an encoded one.
  std::size_t words = 0;
};

/// How a record in memory becomes an encoded one: few copies as a rule, or one. None where it has
/// numbers of 8 bytes or padding. Each number is given its place as its value to find out.
template <class R>
struct WordRuns {
  std::array<WordRun, 4> runs{};
  std::size_t count = 0;  ///< 0: number by number.
};

template <class R>
constexpr WordRuns<R> word_runs() {
  WordRuns<R> found;
  if constexpr (sizeof(R) == visited_bytes<R>() && alignof(R) == alignof(std::uint32_t)) {
    R record{};
    std::uint32_t place = 0;
    visit_words(record, [&](auto& value) {
      value = std::bit_cast<std::remove_reference_t<decltype(value)>>(place++);
    });
    const auto encoding_of = std::bit_cast<RecordWords<R>>(record);
    for (std::size_t i = 0; i < encoding_of.size(); ++i) {
      if (i > 0 && encoding_of[i] == encoding_of[i - 1] + 1) {
        ++found.runs[found.count - 1].words;
        continue;
      }
      if (found.count == found.runs.size()) return {};
      found.runs[found.count++] = {i, encoding_of[i], 1};
    }
  }
  return found;
}
template <class R>
inline constexpr WordRuns<R> kWordRuns = word_runs<R>();
static_assert(kWordRuns<Body<2>>.count == 1 && kWordRuns<Body<3>>.count == 1);
static_assert(kWordRuns<Contact<2>>.count == 1 && kWordRuns<Contact<3>>.count == 1);
static_assert(kWordRuns<Joint<2>>.count == 1 && kWordRuns<Joint<3>>.count == 1);
static_assert(kWordRuns<Particle<2>>.count == 1 && kWordRuns<Particle<3>>.count == 1);
static_assert(kWordRuns<Shape<2>>.count == 2 && kWordRuns<Shape<3>>.count > 0);
static_assert(kWordRuns<Link>.count == 1 && kWordRuns<std::uint32_t>.count == 1);

/// Whether this machine copies such records instead of writing their numbers.
template <class R>
inline constexpr bool kCopiesRecords =
    kWordRuns<R>.count > 0 && std::endian::native == std::endian::little;

/// Calls copy(run) for each run of R, whose lengths the compiler knows.
template <class R, class Copy>
void for_each_run(Copy&& copy) {
  [&]<std::size_t... kRun>(std::index_sequence<kRun...>) {
    (copy(std::integral_constant<std::size_t, kRun>{}), ...);
  }
  (std::make_index_sequence<kWordRuns<R>.count>{});
}

/// Writes records number by number, on any machine; returns the end of what it wrote.
template <class R>
std::byte* write_by_number(std::span<const R> records, std::byte* to) {
  for (const R& record : records)
    visit_words(record, [&](const auto& value) {
      const auto bits = bits_of(value);
      store_little(bits, to);
      to += sizeof bits;
    });
  return to;
}

/// The same bytes as `write_by_number`, by copies. @pre kCopiesRecords<R>
template <class R>
std::byte* write_by_copy(std::span<const R> records, std::byte* to) {
  constexpr std::size_t kWord = sizeof(std::uint32_t);
  if constexpr (kWordRuns<R>.count == 1) {
    if (!records.empty()) std::memcpy(to, records.data(), records.size_bytes());
  } else {
    for (const R& record : records) {
      const auto* from = std::as_bytes(std::span(&record, 1)).data();
      for_each_run<R>([&](auto i) {
        constexpr WordRun kRun = kWordRuns<R>.runs[decltype(i)::value];
        std::memcpy(to + kWord * kRun.encoding, from + kWord * kRun.memory, kWord * kRun.words);
      });
      to += sizeof(R);
    }
    return to;
  }
  return to + records.size_bytes();
}

template <class R>
std::byte* write_records(std::span<const R> records, std::byte* to) {
  if constexpr (kCopiesRecords<R>)
    return write_by_copy(records, to);
  else
    return write_by_number(records, to);
}

template <class R>
void read_by_number(ByteReader& read, std::span<R> records) {
  for (R& record : records) visit_words(record, read);
}

/// @pre kCopiesRecords<R>, and the bytes of all records are there.
template <class R>
void read_by_copy(ByteReader& read, std::span<R> records) {
  constexpr std::size_t kWord = sizeof(std::uint32_t);
  const std::byte* from = read.bytes.data();
  for (R& record : records) {
    auto* to = std::as_writable_bytes(std::span(&record, 1)).data();
    for_each_run<R>([&](auto i) {
      constexpr WordRun kRun = kWordRuns<R>.runs[decltype(i)::value];
      std::memcpy(to + kWord * kRun.memory, from + kWord * kRun.encoding, kWord * kRun.words);
    });
    from += sizeof(R);
  }
  read.bytes = read.bytes.subspan(records.size_bytes());
}

template <class R>
void read_records(ByteReader& read, std::span<R> records) {
  if constexpr (kCopiesRecords<R>)
    read_by_copy(read, records);
  else
    read_by_number(read, records);
}

/// All ones where a number of a record is a float, else zero.
template <class R>
constexpr RecordWords<R> float_words() {
  RecordWords<R> words{};
  std::size_t at = 0;
  R record{};
  visit_words(record, [&](auto& value) {
    words[at++] = std::is_floating_point_v<std::remove_reference_t<decltype(value)>> ? ~0u : 0u;
  });
  return words;
}

/// How many records a period of `kFloatWords` has: whole vectors of numbers, of 16 at the widest.
inline constexpr std::size_t kRecordsPerPeriod = 16;

/// `float_words` of a period of records, one after the other.
template <class R>
alignas(64) inline constexpr auto kFloatWords = [] {
  std::array<std::uint32_t, kRecordsPerPeriod * kRecordWords<R>> words{};
  for (std::size_t i = 0; i < words.size(); ++i) words[i] = float_words<R>()[i % kRecordWords<R>];
  return words;
}();

/// `canonical_bits_of` of the floats among so many numbers in memory; the others stay. Integers
/// throughout, so that no target's floating point takes part.
inline void make_canonical(std::byte* numbers, std::size_t count, const std::uint32_t* floats) {
  for (std::size_t i = 0; i < count; ++i) {
    std::byte* at = numbers + i * sizeof(std::uint32_t);
    std::uint32_t word;
    std::memcpy(&word, at, sizeof word);
    const std::uint32_t magnitude = word & 0x7fffffffu;
    const std::uint32_t of_float = magnitude > 0x7f800000u ? 0x7fc00000u : word;
    word = floats[i] == 0 ? word : magnitude == 0 ? 0u : of_float;
    std::memcpy(at, &word, sizeof word);
  }
}

}  // namespace cycloid::solver
