// Compiled with -mavx512f for CYCLOID_AVX_KERNELS; called only where has_avx512_kernels()
// says so. Every name that this file defines holds the width 528: see contact_kernels_avx2.cpp.
#include "solver/constraints/contact_sweeps.hpp"

namespace cycloid::solver {

template struct ContactKernels<2, kAvx512Lanes>;
template struct ContactKernels<3, kAvx512Lanes>;

}  // namespace cycloid::solver
