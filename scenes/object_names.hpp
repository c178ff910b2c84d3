#pragma once

#include <cstdint>
#include <string>

#include "scenes/scene.hpp"

namespace cycloid::scenes {

/// What a register of a running scene holds: whose it is and under which name.
struct RegisterUse {
  std::string owner;      ///< "seat 1", "character 0 'hero'", "spawn list of seat 0 ('crate')"; ""
                          ///< where the scene has no such register.
  std::string field;      ///< "buttons", "position[1]", "place 3: index"
  bool is_float = false;  ///< The word holds the bits of a float.
};
/// Names register `index` as `build` lays them out.
RegisterUse register_use(const Scene& scene, std::uint32_t index);

/// The scene's own name of what is in a slot of its world, or "" where it has none there: "body",
/// "joint" and so on as solver::visit_arrays calls them. A slot that was freed since (generation
/// not 0) holds something else.
std::string scene_name_of(const Scene& scene, const std::string& kind, std::uint32_t slot,
                          std::uint32_t generation);

}  // namespace cycloid::scenes
