#include "solver/collision/four_cornered_lanes.hpp"

namespace cycloid::solver {

template struct FourCornered<1>;
template struct FourCornered<4>;
template struct FourCornered<8>;
template struct FourCornered<16>;

}  // namespace cycloid::solver
