#pragma once

// Refuses builds whose arithmetic is not the one that is promised. Here and not in a source,
// because whoever includes the solver compiles its inline functions, and of two compiled copies the
// linker keeps one, for everybody. docs/determinism.md, "What is refused".
#ifndef CYCLOID_FREE_ARITHMETIC  // Only `./dev cost` sets it, to measure what this costs.
#if defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__) || \
    defined(__NO_SIGNED_ZEROS__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error \
    "Cycloid refuses -ffast-math and its parts (-Ofast, -funsafe-math-optimizations, \
-ffinite-math-only): equal inputs would not give equal bits. Remove it or add -fno-fast-math."
#endif
#if defined(__FLT_EVAL_METHOD__) && __FLT_EVAL_METHOD__ != 0
#error \
    "Cycloid refuses x87 arithmetic, which rounds floats to more bits or twice: \
on 32-bit x86 add -msse2 -mfpmath=sse."
#endif
#if defined(__GNUC__) && !defined(__clang__)
// Its vectoriser fuses c * x - s * y, s * x + c * y in spite of -ffp-contract=off, where it can.
#if defined(__FMA__) || defined(__FMA4__)
#error \
    "Cycloid refuses GCC with FMA, which it uses in spite of -ffp-contract=off: \
add -mno-fma -mno-fma4."
#endif
// CYCLOID_AVX512_UNIT: kernels that solver/CMakeLists.txt compiles without the vectoriser; their
// objects hold no fused operation, which tests/determinism/gate reads from them.
#if defined(__AVX512F__) && !defined(CYCLOID_AVX512_UNIT)
#error \
    "Cycloid refuses GCC with AVX-512, which holds fused operations that GCC uses in spite of \
-ffp-contract=off and -mno-fma: add -mno-avx512f, or build with Clang."
#endif
#if defined(__ARM_FEATURE_COMPLEX) || defined(__ARM_FEATURE_SVE)
#error \
    "Cycloid refuses GCC for ARMv8.3 and later or SVE, whose fused complex multiply-add it uses in \
spite of -ffp-contract=off: build with -march=armv8.2-a or lower, or with Clang."
#endif
#endif
#endif

namespace cycloid::solver {

/// Hides a value from the optimiser, so that what is done with it is done by the processor, now.
inline float opaque(float value) {
  asm("" : "+m"(value));
  return value;
}

#ifdef CYCLOID_FREE_ARITHMETIC
/// Defined by the program that measures, and by no other: no other links.
extern const bool kMeasuresFreeArithmetic;
#endif

/// Whether the code into which this is inlined rounds each operation, in the order in which it is
/// written: false under -ffp-contract=fast on a processor that fuses, and where sums are reordered.
/// No macro tells of these flags. @pre the thread rounds to nearest.
[[gnu::always_inline]] inline bool rounds_as_written() {
#ifdef CYCLOID_FREE_ARITHMETIC
  return kMeasuresFreeArithmetic;
#else
  const float factor = opaque(0x1.001p0f);
  const float square = opaque(0x1.002p0f);  // Rounded; the exact one has 2^-24 more.
  const float large = opaque(0x1p24f);
  const float lost = (large + opaque(1.0f)) - large;
  return opaque(factor * factor - square) == 0.0f && opaque(lost) == 0.0f;
#endif
}

}  // namespace cycloid::solver
