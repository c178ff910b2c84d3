#pragma once

#include <array>
#include <cstring>

#include "solver/lanes.hpp"
#include "solver/tracing/digest_kernels.hpp"

namespace cycloid::solver {

/// kLaneCount<W> numbers, as they are and with a sign.
template <int W>
struct NumberVector;
template <>
struct NumberVector<4> {
  typedef std::uint32_t Type __attribute__((vector_size(16)));
  typedef std::int32_t Signed __attribute__((vector_size(16)));
};
template <>
struct NumberVector<kAvx2Lanes> {
  typedef std::uint32_t Type __attribute__((vector_size(32)));
  typedef std::int32_t Signed __attribute__((vector_size(32)));
};
template <>
struct NumberVector<kAvx512Lanes> {
  typedef std::uint32_t Type __attribute__((vector_size(64)));
  typedef std::int32_t Signed __attribute__((vector_size(64)));
};

/// The largest that was met, of each lane or of one number. A float less one is from +infinity on
/// as a number with a sign where it is -0 or a NaN without the sign, and nowhere else; with the
/// sign a NaN is what lies above -infinity.
template <class Numbers, class Signed>
struct LargestFloats {
  Signed less_one{};
  Numbers itself{};

  [[gnu::always_inline]] void meet(Numbers word, Numbers is_float) {
    const Numbers number = word & is_float;
    const auto less = (Signed)(number - 1u);
    less_one = less > less_one ? less : less_one;
    itself = number > itself ? number : itself;
  }
};

/// What was met of all: in vectors, and in what fills none.
template <int W>
struct MetFloats {
  LargestFloats<typename NumberVector<W>::Type, typename NumberVector<W>::Signed> in_vectors;
  LargestFloats<std::uint32_t, std::int32_t> in_rest;
};

template <class Largest, class Numbers>
[[gnu::always_inline]] inline void meet_at(const std::byte* numbers, const std::uint32_t* floats,
                                           std::size_t at, Largest& largest) {
  Numbers word;
  Numbers is_float;
  std::memcpy(&word, numbers + at, sizeof word);
  std::memcpy(&is_float, floats + at / sizeof(std::uint32_t), sizeof is_float);
  largest.meet(word, is_float);
}

/// @pre size is of a period, or less.
template <int W>
[[gnu::always_inline]] inline void look_through(const std::byte* numbers, std::size_t size,
                                                const std::uint32_t* floats, MetFloats<W>& met) {
  using Vector = typename NumberVector<W>::Type;
  using Rest = std::uint32_t;
  std::size_t at = 0;
  for (; at + sizeof(Vector) <= size; at += sizeof(Vector))
    meet_at<decltype(met.in_vectors), Vector>(numbers, floats, at, met.in_vectors);
  for (; at < size; at += sizeof(Rest))
    meet_at<decltype(met.in_rest), Rest>(numbers, floats, at, met.in_rest);
}

template <int W>
[[gnu::always_inline]] inline bool all_canonical(const MetFloats<W>& met) {
  constexpr std::int32_t kInfinity = 0x7f800000;
  constexpr std::uint32_t kMinusInfinity = 0xff800000u;
  const auto others =
      (met.in_vectors.less_one >= kInfinity) | (met.in_vectors.itself > kMinusInfinity);
  std::uint64_t any = met.in_rest.less_one >= kInfinity || met.in_rest.itself > kMinusInfinity;
  std::array<std::uint64_t, sizeof others / sizeof any> in_pairs;
  std::memcpy(in_pairs.data(), &others, sizeof others);
  for (const std::uint64_t pair : in_pairs) any |= pair;
  return any == 0;
}

template <int W>
std::uint64_t DigestKernels<W>::whole(const std::byte* bytes, std::size_t size) {
  return XXH3_64bits(bytes, size);
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
  const auto holds = [&](std::size_t begin, std::size_t end) {
    MetFloats<W> met;
    for (std::size_t at = begin; at < end; at = after(at, period))
      look_through<W>(numbers + at, after(at, period) - at, floats, met);
    return all_canonical<W>(met);
  };
  std::size_t at = 0;
  while (at < size && holds(at, after(at, kPeriodsAtOnce * period)))
    at = after(at, kPeriodsAtOnce * period);
  while (at < size && holds(at, after(at, period))) at = after(at, period);
  return at;
}

}  // namespace cycloid::solver
