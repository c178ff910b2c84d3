#include "solver/instruction_sets.hpp"

namespace cycloid::solver {

bool has_avx2_kernels() {
#ifdef CYCLOID_AVX_KERNELS  // See lane_widths.hpp.
  return __builtin_cpu_supports("avx2") != 0;
#else
  return false;
#endif
}

bool has_avx512_kernels() {
#ifdef CYCLOID_AVX_KERNELS
  return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512vl") != 0 &&
         __builtin_cpu_supports("avx512dq") != 0;
#else
  return false;
#endif
}

}  // namespace cycloid::solver
