#pragma once

#include <rapidcheck.h>

#include "tests/properties/case.hpp"

namespace cycloid::properties {

/// Random cases of one dimension; they shrink to fewer commands with smaller numbers, to one worker
/// and to the first tuning.
/// @param crowds  Whether one in thirty begins with a crowd, which does not shrink and so is slow.
rc::Gen<Case> cases(int dimension, bool crowds = true);

}  // namespace cycloid::properties
