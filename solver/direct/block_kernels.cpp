#include "solver/direct/block_lanes.hpp"

namespace cycloid::solver {

template struct BlockKernels<2, 4>;
template struct BlockKernels<3, 4>;

}  // namespace cycloid::solver
