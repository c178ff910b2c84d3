#include "solver/bodies/body_lanes.hpp"
#include "solver/bodies/passing_lanes.hpp"
#include "solver/bodies/turn_lanes.hpp"

namespace cycloid::solver {

template struct BodyKernels<1>;
template struct BodyKernels<4>;

}  // namespace cycloid::solver
