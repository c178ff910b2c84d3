#pragma once

#include <cstring>

#include "solver/lanes.hpp"
#include "solver/tracing/digest_kernels.hpp"

namespace cycloid::solver {

/// kLaneCount<W> numbers.
template <int W>
struct NumberVector;
template <>
struct NumberVector<4> {
  typedef std::uint32_t Type __attribute__((vector_size(16)));
};
template <>
struct NumberVector<kAvx2Lanes> {
  typedef std::uint32_t Type __attribute__((vector_size(32)));
};
template <>
struct NumberVector<kAvx512Lanes> {
  typedef std::uint32_t Type __attribute__((vector_size(64)));
};

/// `Numbers` is one number or a vector of them. @returns the highest bit where `word` holds a float
/// that is not canonical. The sum has that bit where the magnitude is a NaN's, above 0x7f800000.
template <class Numbers>
[[gnu::always_inline]] inline Numbers not_canonical(Numbers word, Numbers is_float) {
  constexpr std::uint32_t kSign = 0x80000000u;
  const Numbers magnitude = word & ~kSign;
  // Only of -0 the magnitude less one has the highest bit that the word has, too.
  return ((magnitude + 0x007fffffu) | ((magnitude - 1u) & word)) & is_float;
}

/// What is not canonical, in the highest bits of what is found: of a vector, and of what fills
/// none.
template <int W>
struct FoundFloats {
  typename NumberVector<W>::Type in_vectors{};
  std::uint32_t in_rest = 0;
};

template <class Vector>
[[gnu::always_inline]] inline Vector not_canonical_at(const std::byte* numbers,
                                                      const std::uint32_t* floats, std::size_t at) {
  Vector word;
  Vector is_float;
  std::memcpy(&word, numbers + at, sizeof word);
  std::memcpy(&is_float, floats + at / sizeof(std::uint32_t), sizeof is_float);
  return not_canonical(word, is_float);
}

/// @pre size is of a period, or less.
template <int W>
[[gnu::always_inline]] inline void look_through(const std::byte* numbers, std::size_t size,
                                                const std::uint32_t* floats,
                                                FoundFloats<W>& found) {
  using Vector = typename NumberVector<W>::Type;
  std::size_t at = 0;
  for (; at + sizeof(Vector) <= size; at += sizeof(Vector))
    found.in_vectors |= not_canonical_at<Vector>(numbers, floats, at);
  for (; at < size; at += sizeof(std::uint32_t))
    found.in_rest |= not_canonical_at<std::uint32_t>(numbers, floats, at);
}

template <int W>
[[gnu::always_inline]] inline bool is_any(const FoundFloats<W>& found) {
  std::uint32_t any = found.in_rest;
  for (int lane = 0; lane < kLaneCount<W>; ++lane) any |= found.in_vectors[lane];
  return any >> 31 != 0;
}

template <int W>
void DigestKernels<W>::update(XXH3_state_t& state, const std::byte* bytes, std::size_t size) {
  XXH3_64bits_update(&state, bytes, size);
}

template <int W>
std::size_t DigestKernels<W>::canonical_bytes(const std::byte* numbers, std::size_t size,
                                              const std::uint32_t* floats, std::size_t period) {
  constexpr std::size_t kPeriodsAtOnce = 8;
  const auto after = [&](std::size_t at, std::size_t bytes) {
    return size - at < bytes ? size : at + bytes;
  };
  const auto all_canonical = [&](std::size_t begin, std::size_t end) {
    FoundFloats<W> found;
    for (std::size_t at = begin; at < end; at = after(at, period))
      look_through<W>(numbers + at, after(at, period) - at, floats, found);
    return !is_any(found);
  };
  std::size_t at = 0;
  while (at < size && all_canonical(at, after(at, kPeriodsAtOnce * period)))
    at = after(at, kPeriodsAtOnce * period);
  while (at < size && all_canonical(at, after(at, period))) at = after(at, period);
  return at;
}

}  // namespace cycloid::solver
