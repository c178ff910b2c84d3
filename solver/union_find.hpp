#pragma once

#include <cstdint>
#include <vector>

namespace cycloid::solver {

/// The root of the set that an element belongs to, where each points to another of its set or, the
/// root, to itself. Halves the path on the way, which changes no result.
inline std::uint32_t root_of(std::vector<std::uint32_t>& parent, std::uint32_t element) {
  while (parent[element] != element) {
    parent[element] = parent[parent[element]];
    element = parent[element];
  }
  return element;
}

}  // namespace cycloid::solver
