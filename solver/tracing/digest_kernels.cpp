#include "solver/tracing/digest_kernels.hpp"

#include "solver/instruction_sets.hpp"
#include "solver/tracing/digest_lanes.hpp"

namespace cycloid::solver {

template struct DigestKernels<4>;
extern template struct DigestKernels<kAvx2Lanes>;
extern template struct DigestKernels<kAvx512Lanes>;

const DigestFunctions& digest_functions() {
  static constexpr DigestFunctions kFour{&DigestKernels<4>::update,
                                         &DigestKernels<4>::canonical_bytes};
  static constexpr DigestFunctions kEight{&DigestKernels<kAvx2Lanes>::update,
                                          &DigestKernels<kAvx2Lanes>::canonical_bytes};
  static constexpr DigestFunctions kSixteen{&DigestKernels<kAvx512Lanes>::update,
                                            &DigestKernels<kAvx512Lanes>::canonical_bytes};
  if (has_avx512_kernels()) return kSixteen;
  return has_avx2_kernels() ? kEight : kFour;
}

}  // namespace cycloid::solver
