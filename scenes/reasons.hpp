#pragma once

#include <string>

#include "scenes/scene.hpp"
#include "solver/result.hpp"

namespace cycloid::scenes {

/// A sentence for an error of the solver about a field.
std::string reason_of(const solver::Error& error);

/// The same for an error about a body, whose shapes say what their points have to be.
std::string reason_of(const solver::Error& error, const SceneBody& body);

}  // namespace cycloid::scenes
