// Compiled with -mavx2 for CYCLOID_AVX_KERNELS; called only where has_avx2_kernels() says so.
// Every name that this file defines holds the width 264: see constraints/contact_kernels_avx2.cpp.
#include "solver/collision/solid_lanes.hpp"

namespace cycloid::solver {

template struct SolidKernels<kAvx2Lanes>;

}  // namespace cycloid::solver
