// Compiled for AVX-512 for CYCLOID_AVX_KERNELS; called only where has_avx512_kernels() says
// so. Every name that this file defines holds the width 528: see
// constraints/contact_kernels_avx512.cpp.
#include "solver/tracing/digest_lanes.hpp"

namespace cycloid::solver {

template struct DigestKernels<kAvx512Lanes>;

}  // namespace cycloid::solver
