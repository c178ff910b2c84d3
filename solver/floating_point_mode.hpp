#pragma once

#include "solver/arithmetic.hpp"
#include "solver/result.hpp"

namespace cycloid::solver {

/// Whether this thread rounds to nearest and keeps subnormal numbers. A library that was linked
/// with -ffast-math switches subnormals off for the whole process when it is loaded.
bool floating_point_mode_is_ieee();

/// Whether worlds compute here as everywhere: kInvalid with field "floating_point_mode" where this
/// thread does not, "floating_point_flags" where the caller or the solver was compiled otherwise.
/// @param caller_rounds_as_written  rounds_as_written() of the caller.
Error check_arithmetic(bool caller_rounds_as_written);

}  // namespace cycloid::solver
