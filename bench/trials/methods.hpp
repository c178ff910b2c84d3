#pragma once

#include <span>

#include "solver/definitions.hpp"

namespace cycloid::trials {

/// A published method as settings of the one solver.
struct Method {
  const char* name;  ///< "soft-step", the default, comes first.
  solver::Tuning tuning;
};

/// Twelve of them, in the order of the columns of docs/stability.md.
std::span<const Method> methods();

/// What a scene says of the world (thresholds, sleep, continuous collision, particles) with the
/// method's way to solve it; overlap that is left alone (slop) is the scene's too.
solver::Tuning with_method(const solver::Tuning& scene, const solver::Tuning& method);

}  // namespace cycloid::trials
