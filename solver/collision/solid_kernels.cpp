#include "solver/collision/solid_lanes.hpp"

namespace cycloid::solver {

template struct SolidKernels<4>;

}  // namespace cycloid::solver
