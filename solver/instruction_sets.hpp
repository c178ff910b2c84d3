#pragma once

namespace cycloid::solver {

/// Whether this processor and this build have the kernels of kAvx2Lanes.
bool has_avx2_kernels();
/// The same of kAvx512Lanes.
bool has_avx512_kernels();

}  // namespace cycloid::solver
