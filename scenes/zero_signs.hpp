#pragma once

#include "scenes/scene.hpp"

namespace cycloid::scenes {

/// Makes every -0 of a scene 0. What is written leaves out fields that equal their default, as -0
/// equals 0, so a file would come back as another scene; readers therefore know only one zero.
void drop_zero_signs(Scene& scene);

}  // namespace cycloid::scenes
