#pragma once

namespace cycloid::solver {

/// Whether this thread rounds to nearest and keeps subnormal numbers. A library that was linked
/// with -ffast-math switches subnormals off for the whole process when it is loaded.
bool floating_point_mode_is_ieee();

/// Whether the solver itself was compiled with flags that let it round each operation as written.
bool solver_rounds_as_written();

}  // namespace cycloid::solver
