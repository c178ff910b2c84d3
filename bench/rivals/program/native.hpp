#pragma once

#include "bench/rivals/rival_run.hpp"

namespace cycloid::rivals {

/// The engines that the distribution packages, each with substeps crossed with iterations, where 0
/// is the engine's default; those of the plane, and those of space. An engine takes no part in a
/// scene that it cannot hold, that has seats, or in which something happens besides what the scene
/// says.
std::vector<accuracy::Contender> native_contenders(const std::vector<std::uint32_t>& substeps,
                                                   const std::vector<std::uint32_t>& iterations);

}  // namespace cycloid::rivals
