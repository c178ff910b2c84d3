#pragma once

#ifndef XXH_INLINE_ALL
#define XXH_INLINE_ALL
#endif
#include <xxhash.h>

#include <cstddef>
#include <cstdint>

namespace cycloid::solver {

/// What a digest spends its time with, in vectors of W numbers of 4 bytes. Integers throughout, so
/// every width gives the same bits. Compiled for each: digest_kernels.cpp, digest_kernels_avx2.cpp,
/// digest_kernels_avx512.cpp.
template <int W>
struct DigestKernels {
  /// XXH3 of all bytes at once.
  static std::uint64_t whole(const std::byte* bytes, std::size_t size);
  /// XXH3's update, by which it sees them in pieces.
  static void update(XXH3_state_t& state, const std::byte* bytes, std::size_t size);
  /// How many bytes of numbers, from the first on, are canonical as they are: no float of them is
  /// -0 or a NaN. Counted in whole periods of `floats`, of which the last may be cut short.
  ///
  /// @param floats  by number of a period all ones where it is a float, else zero.
  /// @pre `size` and `period` are whole numbers, in bytes. Fastest where a period is whole vectors.
  static std::size_t canonical_bytes(const std::byte* numbers, std::size_t size,
                                     const std::uint32_t* floats, std::size_t period);
};

/// The widest that this processor and this build have.
struct DigestFunctions {
  decltype(&DigestKernels<4>::whole) whole;
  decltype(&DigestKernels<4>::update) update;
  decltype(&DigestKernels<4>::canonical_bytes) canonical_bytes;
};
const DigestFunctions& digest_functions();

}  // namespace cycloid::solver
