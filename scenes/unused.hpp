#pragma once

#include <vector>

#include "scenes/catalogue.hpp"

namespace cycloid::scenes {

/// Appends a mistake for each value of a scene that nothing reads: of the other dimension, or of
/// another kind of shape or effect of a control. Whoever wrote it expects it to do something.
/// @pre scene.dimension is 2 or 3.
void check_unused(const Scene& scene, std::vector<Mistake>& mistakes);

}  // namespace cycloid::scenes
