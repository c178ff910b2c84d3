#pragma once

namespace cycloid::solver {

/// Whether this processor and this build have the kernels of kAvx2Lanes.
bool has_avx2_kernels();

}  // namespace cycloid::solver
