#pragma once

#include <cstdint>
#include <vector>

#include "scenes/catalogue.hpp"

namespace cycloid::scenes {

/// How much of one limit the parts of a scene take before the first tick.
struct Need {
  const char* name;  ///< Of the limit.
  std::uint32_t solver::Limits::*limit;
  std::uint64_t count = 0;
};

/// All but contacts, which nobody knows beforehand, and registers, which `build` hands out.
std::vector<Need> needs_of(const Scene& scene);

/// The scene's limits. A limit that the scene's own parts exceed is a mistake, said once, and comes
/// back raised, so that the mistakes of all parts are found.
solver::Limits checked_limits(const Scene& scene, std::vector<Mistake>& mistakes);

/// "is 2, and the scene needs 6 from the start"
std::string too_small(std::uint32_t limit, std::uint64_t need);

}  // namespace cycloid::scenes
