// Compiled with -mavx512f for CYCLOID_AVX_KERNELS; called only where has_avx512_kernels()
// says so. Every name that this file defines holds the width 528: see
// constraints/contact_kernels_avx2.cpp.
#include "solver/collision/solid_lanes.hpp"

namespace cycloid::solver {

template struct SolidKernels<kAvx512Lanes>;

}  // namespace cycloid::solver
