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

/// `Numbers` is one number or a vector of them. @returns the highest bit where `word` holds a float
/// that is not canonical. The sum has that bit where the magnitude is a NaN's, above 0x7f800000.
template <class Numbers>
[[gnu::always_inline]] inline Numbers not_canonical(Numbers word, Numbers is_float) {
  constexpr std::uint32_t kSign = 0x80000000u;
  const Numbers magnitude = word & ~kSign;
  // Only of -0 the magnitude less one has the highest bit that the word has, too.
  return ((magnitude + 0x007fffffu) | ((magnitude - 1u) & word)) & is_float;
}

template <int W>
[[gnu::always_inline]] inline bool is_canonical(const std::byte* numbers, std::size_t size,
                                                const std::uint32_t* floats) {
  using Vector = typename NumberVector<W>::Type;
  const auto load = [](auto& into, const void* from) { std::memcpy(&into, from, sizeof into); };
  Vector found{};
  std::size_t at = 0;
  for (; at + sizeof(Vector) <= size; at += sizeof(Vector)) {
    Vector word;
    Vector is_float;
    load(word, numbers + at);
    load(is_float, floats + at / sizeof(std::uint32_t));
    found |= not_canonical(word, is_float);
  }
  std::uint32_t any = 0;
  for (int lane = 0; lane < kLaneCount<W>; ++lane) any |= found[lane];
  for (; at < size; at += sizeof(std::uint32_t)) {
    std::uint32_t word;
    load(word, numbers + at);
    any |= not_canonical(word, floats[at / sizeof word]);
  }
  return any >> 31 == 0;
}

template <int W>
void DigestKernels<W>::update(XXH3_state_t& state, const std::byte* bytes, std::size_t size) {
  XXH3_64bits_update(&state, bytes, size);
}

template <int W>
std::size_t DigestKernels<W>::canonical_bytes(const std::byte* numbers, std::size_t size,
                                              const std::uint32_t* floats, std::size_t period) {
  std::size_t at = 0;
  while (at < size) {
    const std::size_t next = size - at < period ? size - at : period;
    if (!is_canonical<W>(numbers + at, next, floats)) return at;
    at += next;
  }
  return at;
}

}  // namespace cycloid::solver
