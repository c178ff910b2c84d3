#include "solver/constraints/pin_sweeps.hpp"

namespace cycloid::solver {

template struct PinKernels<2, 1>;
template struct PinKernels<2, 4>;
template struct PinKernels<3, 1>;
template struct PinKernels<3, 4>;

}  // namespace cycloid::solver
