#pragma once

#include <string>
#include <vector>

#include "bench/runner/measure.hpp"

namespace cycloid::bench {

/// Draws FOLDER/growth.svg: time per step and body over the number of bodies, a curve for each
/// engine and kind of scene. @param results  of the growth scenes.
/// @returns "" or why it could not.
std::string draw_growth(const std::vector<SceneResult>& results, const std::string& folder);

}  // namespace cycloid::bench
