// Compiled with -mavx2 for CYCLOID_AVX_KERNELS; called only where has_avx2_kernels() says so.
// Every name that this file defines holds the width 264: see contact_kernels_avx2.cpp.
#include "solver/constraints/pin_sweeps.hpp"

namespace cycloid::solver {

template struct PinKernels<2, kAvx2Lanes>;
template struct PinKernels<3, kAvx2Lanes>;

}  // namespace cycloid::solver
