// Compiled with -mavx512f for CYCLOID_AVX_KERNELS; called only where has_avx512_kernels()
// says so. Every name that this file defines holds the width 528: see
// constraints/contact_kernels_avx2.cpp.
#include "solver/collision/cornered_ball_lanes.hpp"

namespace cycloid::solver {

template struct FewCornered<kAvx512Lanes>;

}  // namespace cycloid::solver
