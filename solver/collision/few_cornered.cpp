#include "solver/collision/cornered_ball_lanes.hpp"

namespace cycloid::solver {

template struct FewCornered<1>;
template struct FewCornered<4>;

}  // namespace cycloid::solver
