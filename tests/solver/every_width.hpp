#pragma once

#include "solver/lane_widths.hpp"

namespace cycloid::solver {

/// Calls act.template operator()<W>() for these widths, and for those of each instruction set that
/// this processor has.
template <int... kWidths, class Act>
void for_each_width(Act&& act) {
  (act.template operator()<kWidths>(), ...);
  if constexpr (kHasAvxKernels) {
    if (has_avx2_kernels()) act.template operator()<kAvx2Lanes>();
    if (has_avx512_kernels()) act.template operator()<kAvx512Lanes>();
  }
}

}  // namespace cycloid::solver
