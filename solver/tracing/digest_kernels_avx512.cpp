// Compiled for AVX-512 where CYCLOID_AVX512 is defined; called only where has_avx512_kernels() says
// so. Every name that this file defines holds the width 528: see
// constraints/contact_kernels_avx512.cpp.
#ifndef __clang__
// What GCC 12's own header of intrinsics leaves undefined on purpose, where XXH3 asks for it.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include "solver/tracing/digest_lanes.hpp"

namespace cycloid::solver {

template struct DigestKernels<kAvx512Lanes>;

}  // namespace cycloid::solver
