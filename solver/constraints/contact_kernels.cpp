#include "solver/constraints/contact_sweeps.hpp"

namespace cycloid::solver {

template struct ContactKernels<2, 1>;
template struct ContactKernels<2, 4>;
template struct ContactKernels<3, 1>;
template struct ContactKernels<3, 4>;

}  // namespace cycloid::solver
