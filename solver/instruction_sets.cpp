#include "solver/instruction_sets.hpp"

namespace cycloid::solver {

bool has_avx2_kernels() {
#ifdef CYCLOID_AVX2  // Set by solver/CMakeLists.txt where the units of kAvx2Lanes have the flag.
  return __builtin_cpu_supports("avx2") != 0;
#else
  return false;
#endif
}

}  // namespace cycloid::solver
