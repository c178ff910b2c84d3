#include "solver/tracing/digest_kernels.hpp"

#include "solver/lane_widths.hpp"
#include "solver/tracing/digest_lanes.hpp"

namespace cycloid::solver {

template struct DigestKernels<4>;
extern template struct DigestKernels<kAvx2Lanes>;
extern template struct DigestKernels<kAvx512Lanes>;

template <int W>
static constexpr DigestFunctions kFunctionsOf{&DigestKernels<W>::whole, &DigestKernels<W>::update,
                                              &DigestKernels<W>::canonical_bytes};

const DigestFunctions& digest_functions() {
  return at_widest([]<int W>() -> const DigestFunctions& { return kFunctionsOf<W>; });
}

}  // namespace cycloid::solver
