#include "solver/tracing/digest_kernels.hpp"

#include "solver/instruction_sets.hpp"
#include "solver/tracing/digest_lanes.hpp"

namespace cycloid::solver {

template struct DigestKernels<4>;
extern template struct DigestKernels<kAvx2Lanes>;

const DigestFunctions& digest_functions() {
  static constexpr DigestFunctions kFour{&DigestKernels<4>::update,
                                         &DigestKernels<4>::canonical_bytes};
  static constexpr DigestFunctions kEight{&DigestKernels<kAvx2Lanes>::update,
                                          &DigestKernels<kAvx2Lanes>::canonical_bytes};
  return has_avx2_kernels() ? kEight : kFour;
}

}  // namespace cycloid::solver
