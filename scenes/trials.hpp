#pragma once

#include <span>

#include "scenes/scene.hpp"

namespace cycloid::scenes {

/// A scene in which some published method fails: the rows of docs/stability.md. `find` knows them
/// by name, but they are not part of `catalogue()`: what happens in them is judged, not remembered.
struct Trial {
  int row;              ///< In docs/stability.md; several trials may share one.
  const char* name;     ///< "trial-stack-30"
  std::uint32_t ticks;  ///< How long it takes to show.
  Scene (*make)();
};

/// All of them, by row.
std::span<const Trial> trials();

}  // namespace cycloid::scenes
