#include "solver/collision/bounds_lanes.hpp"

namespace cycloid::solver {

template struct BoundsKernels<2, 4>;
template struct BoundsKernels<3, 4>;

}  // namespace cycloid::solver
