#pragma once

#include <string>

#include "scenes/scene.hpp"
#include "solver/result.hpp"

namespace cycloid::scenes {

/// A sentence for an error of the solver about a field.
std::string reason_of(const solver::Error& error);

/// The same for an error about a body or one of its shapes, whose kinds say what fields have to be.
std::string reason_of(const solver::Error& error, const SceneBody& body, std::uint32_t dimension);

/// The same for an error about a joint.
std::string reason_of(const solver::Error& error, const SceneJoint& joint, std::uint32_t dimension);

}  // namespace cycloid::scenes
