#pragma once

#include <rapidcheck.h>

#include "tests/properties/case.hpp"

namespace cycloid::properties {

/// Random cases of one dimension; they shrink to fewer commands with smaller numbers, to one worker
/// and to the first tuning.
rc::Gen<Case> cases(int dimension);

}  // namespace cycloid::properties
