#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scenes/catalogue.hpp"

namespace cycloid::scenes {

/// All that is said of a scene, a line each.
inline std::string said(const std::vector<Mistake>& mistakes) {
  std::string text;
  for (const Mistake& mistake : mistakes) text += mistake.path + ": " + mistake.reason + "\n";
  return text;
}
inline std::string said(std::string_view json) {
  return said(from_json(json).mistakes);
}

}  // namespace cycloid::scenes
