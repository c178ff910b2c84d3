#pragma once

#include <span>
#include <string_view>

namespace cycloid::scenes {

/// A file of catalogue/, compiled into the library, so that a program needs no files to find.
struct EmbeddedScene {
  std::string_view name;
  std::string_view json;
};

std::span<const EmbeddedScene> embedded_scenes();

}  // namespace cycloid::scenes
