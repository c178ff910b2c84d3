#pragma once

#include <cstdint>
#include <cstring>
#if defined(CYCLOID_AVX512_UNIT) || defined(__AVX2__)
#include <immintrin.h>
#elif defined(__SSE2__)
#include <emmintrin.h>
#elif defined(__wasm_simd128__)
#include <wasm_simd128.h>
#endif

#include "solver/arithmetic.hpp"

namespace cycloid::solver {

/// The widths of the kernels that are compiled for AVX2 and for AVX-512: 8 and 16 lanes under names
/// of their own, so that no function compiled with those instructions has the name of one that
/// every processor may run.
inline constexpr int kAvx2Lanes = 256 + 8;
inline constexpr int kAvx512Lanes = 512 + 16;

/// How many lanes a width has.
template <int W>
inline constexpr int kLaneCount = W % 256;

/// The vector of W floats and of W masks. One explicit row per width, because GCC 12 can neither
/// subscript nor overload on a vector type whose size depends on a template parameter.
template <int W>
struct RawLanes;
template <>
struct RawLanes<1> {
  typedef float Float __attribute__((vector_size(4)));
  typedef int Mask __attribute__((vector_size(4)));
};
template <>
struct RawLanes<4> {
  typedef float Float __attribute__((vector_size(16)));
  typedef int Mask __attribute__((vector_size(16)));
};
template <>
struct RawLanes<8> {
  typedef float Float __attribute__((vector_size(32)));
  typedef int Mask __attribute__((vector_size(32)));
};
template <>
struct RawLanes<16> {
  typedef float Float __attribute__((vector_size(64)));
  typedef int Mask __attribute__((vector_size(64)));
};

template <>
struct RawLanes<kAvx2Lanes> : RawLanes<8> {};
template <>
struct RawLanes<kAvx512Lanes> : RawLanes<16> {};

/// W independent floats: the arithmetic of every wide kernel. `Lanes<1>` is the scalar path, so a
/// kernel is written once.
///
/// Lanes never mix (there is no horizontal sum), so a result depends neither on W nor on the
/// target's vector width. `min` and `max` are selects because hardware min and max disagree on
/// signed zero and NaN. There is no fused multiply-add, reciprocal or reciprocal square root:
/// targets round those differently. docs/determinism.md has the measurements.
///
/// Aligned by hand: GCC aligns a vector to no more than the unit's own instruction set asks for,
/// and units of several sets work on the same blocks.
///
/// Always inlined: with AVX a vector is passed in other registers, and the linker would keep one
/// copy of a function for the units of all sets. What counts branches (-fprofile-generate) left one
/// operator as a call, and each run gave other bits.
template <int W>
struct alignas(4 * kLaneCount<W>) Lanes {
  using Raw = typename RawLanes<W>::Float;
  using Mask = typename RawLanes<W>::Mask;
  Raw raw;

  Lanes() = default;
  [[gnu::always_inline]] explicit Lanes(Raw r) : raw(r) {}
  [[gnu::always_inline]] Lanes(float x)
      : raw(x - Raw{}) {}  // NOLINT: the same in every lane; 0 + x would lose -0.

  [[gnu::always_inline]] static Lanes load(const float* from) {
    Lanes lanes;
    std::memcpy(&lanes.raw, from, sizeof lanes.raw);
    return lanes;
  }
  [[gnu::always_inline]] void store(float* to) const { std::memcpy(to, &raw, sizeof raw); }

  [[gnu::always_inline]] friend Lanes operator+(Lanes a, Lanes b) { return Lanes(a.raw + b.raw); }
  [[gnu::always_inline]] friend Lanes operator-(Lanes a, Lanes b) { return Lanes(a.raw - b.raw); }
  [[gnu::always_inline]] friend Lanes operator*(Lanes a, Lanes b) { return Lanes(a.raw * b.raw); }
  [[gnu::always_inline]] friend Lanes operator/(Lanes a, Lanes b) { return Lanes(a.raw / b.raw); }
  [[gnu::always_inline]] friend Lanes operator-(Lanes a) { return Lanes(-a.raw); }
  [[gnu::always_inline]] Lanes& operator+=(Lanes b) { return *this = *this + b; }
  [[gnu::always_inline]] Lanes& operator-=(Lanes b) { return *this = *this - b; }

  [[gnu::always_inline]] friend Mask operator<(Lanes a, Lanes b) { return a.raw < b.raw; }
  [[gnu::always_inline]] friend Mask operator>(Lanes a, Lanes b) { return a.raw > b.raw; }
  [[gnu::always_inline]] friend Mask operator==(Lanes a, Lanes b) { return a.raw == b.raw; }
  [[gnu::always_inline]] friend Lanes max(Lanes a, Lanes b) {
#ifdef CYCLOID_AVX512_UNIT
    // Is that select: where neither is greater it takes the second. Against a constant GCC 12 makes
    // a mask of it, which takes three times as long.
    if constexpr (W == kAvx512Lanes)
      return Lanes(static_cast<Raw>(_mm512_maskz_max_ps(0xffff, a.raw, b.raw)));
#endif
    return Lanes(a.raw > b.raw ? a.raw : b.raw);
  }
  [[gnu::always_inline]] friend Lanes min(Lanes a, Lanes b) {
#ifdef CYCLOID_AVX512_UNIT
    if constexpr (W == kAvx512Lanes)
      return Lanes(static_cast<Raw>(_mm512_maskz_min_ps(0xffff, a.raw, b.raw)));
#endif
    return Lanes(a.raw < b.raw ? a.raw : b.raw);
  }
  [[gnu::always_inline]] friend Lanes select(Mask mask, Lanes yes, Lanes no) {
    return Lanes(mask ? yes.raw : no.raw);
  }
  [[gnu::always_inline]] friend Lanes sqrt(Lanes a) {
#ifdef CYCLOID_AVX512_UNIT
    // Compiled without the vectoriser, which elsewhere makes one instruction of the loop. Masked,
    // because GCC 12 warns of what the other one leaves undefined.
    if constexpr (W == kAvx512Lanes)
      return Lanes(static_cast<Raw>(_mm512_maskz_sqrt_ps(0xffff, a.raw)));
#endif
    for (int lane = 0; lane < kLaneCount<W>; ++lane) a.raw[lane] = __builtin_sqrtf(a.raw[lane]);
    return a;
  }
};

/// The lanes of a mask, a bit each: where a processor has an instruction for it, it is several
/// times as fast.
template <int W>
[[gnu::always_inline]] inline std::uint32_t bits_of(const typename Lanes<W>::Mask& mask) {
#ifdef CYCLOID_AVX512_UNIT
  if constexpr (W == kAvx512Lanes) {
    __m512i lanes;
    std::memcpy(&lanes, &mask, sizeof lanes);
    return _mm512_movepi32_mask(lanes);
  }
#endif
#ifdef __AVX2__
  if constexpr (W == kAvx2Lanes) {
    __m256 lanes;
    std::memcpy(&lanes, &mask, sizeof lanes);
    return static_cast<std::uint32_t>(_mm256_movemask_ps(lanes));
  }
#endif
#ifdef __SSE2__
  if constexpr (W == 4) {
    __m128 lanes;
    std::memcpy(&lanes, &mask, sizeof lanes);
    return static_cast<std::uint32_t>(_mm_movemask_ps(lanes));
  }
#endif
#ifdef __wasm_simd128__
  if constexpr (W == 4) {
    v128_t lanes;
    std::memcpy(&lanes, &mask, sizeof lanes);
    return wasm_i32x4_bitmask(lanes);
  }
#endif
  typename Lanes<W>::Mask own{};
  for (int lane = 0; lane < kLaneCount<W>; ++lane) own[lane] = static_cast<int>(1u << lane);
  const typename Lanes<W>::Mask kept = mask & own;
  if constexpr (W == 1) {
    return static_cast<std::uint32_t>(kept[0]);
  } else {
    std::uint64_t pairs[kLaneCount<W> / 2];
    std::memcpy(pairs, &kept, sizeof pairs);
    std::uint64_t all = 0;
    for (const std::uint64_t pair : pairs) all |= pair;
    return static_cast<std::uint32_t>(all | all >> 32);
  }
}

/// Whether any lane is above 0, and whether all are: beside bits_of the only questions across
/// lanes, because their answers have no order.
template <int W>
[[gnu::always_inline]] inline bool any_above_zero(const Lanes<W>& a) {
  return bits_of<W>(a > Lanes<W>(0.0f)) != 0;
}
template <int W>
[[gnu::always_inline]] inline bool all_above_zero(const Lanes<W>& a) {
  return bits_of<W>(a > Lanes<W>(0.0f)) == (std::uint32_t{1} << kLaneCount<W>)-1;
}

inline float max(float a, float b) {
  return a > b ? a : b;
}
inline float min(float a, float b) {
  return a < b ? a : b;
}
inline float select(bool mask, float yes, float no) {
  return mask ? yes : no;
}
inline float sqrt(float a) {
  return __builtin_sqrtf(a);
}
inline float abs(float a) {
  return a < 0.0f ? -a : a;
}
inline float clamp(float a, float lower, float upper) {
  return max(lower, min(a, upper));
}

}  // namespace cycloid::solver
