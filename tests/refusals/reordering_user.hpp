#pragma once

#include "solver/world.hpp"

namespace cycloid::solver {

/// The field that World::create names to a caller whose flags reorder sums; "" where it does not
/// see it.
const char* field_refused_to_a_reordering_user();

}  // namespace cycloid::solver
