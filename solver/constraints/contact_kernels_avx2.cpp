// Compiled with -mavx2 for CYCLOID_AVX_KERNELS; called only where has_avx2_kernels() says so.
// Every name that this file defines holds the width 264, so that no other file uses it by accident:
// tests/determinism/gate reads the object.
#include "solver/constraints/contact_sweeps.hpp"

namespace cycloid::solver {

template struct ContactKernels<2, kAvx2Lanes>;
template struct ContactKernels<3, kAvx2Lanes>;

}  // namespace cycloid::solver
