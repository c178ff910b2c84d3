#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace cycloid::solver {

/// Below so many, comparing takes less time than counting.
inline constexpr std::size_t kRadixSortMin = 256;

/// Of a digit: 2048 counters lie in the nearest cache.
inline constexpr int kRadixSortBits = 11;

/// One pass of a radix sort: `to` has the things by one digit of their numbers, those with the same
/// digit in their order before.
template <class T, class NumberOf>
void sort_by_digit(int shift, NumberOf&& number_of, const std::vector<T>& from,
                   std::vector<T>& to) {
  constexpr std::uint32_t kDigits = 1u << kRadixSortBits;
  std::uint32_t next[kDigits] = {};
  const auto digit_of = [&](const T& thing) { return (number_of(thing) >> shift) & (kDigits - 1); };
  for (const T& thing : from) ++next[digit_of(thing)];
  std::uint32_t begin = 0;
  for (std::uint32_t& count : next) {
    const std::uint32_t end = begin + count;
    count = begin;
    begin = end;
  }
  for (const T& thing : from) to[next[digit_of(thing)]++] = thing;
}

/// Sorts by numbers that are at most `most`, and leaves those of one number in the order that they
/// had.
/// @param number_of  Of a thing, a std::uint32_t.
/// @param room  As long as `things`, of any contents; left with others.
template <class T, class NumberOf>
void radix_sort(std::uint32_t most, NumberOf&& number_of, std::vector<T>& room,
                std::vector<T>& things) {
  for (int shift = 0; shift < 32 && most >> shift != 0; shift += kRadixSortBits) {
    sort_by_digit(shift, number_of, things, room);
    things.swap(room);
  }
}

}  // namespace cycloid::solver
