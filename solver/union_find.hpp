#pragma once

#include <algorithm>
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

/// Makes one set of those of two elements. The lower root stays one, so that a set is named by its
/// lowest element, in whatever order its elements were united.
inline void unite(std::vector<std::uint32_t>& parent, std::uint32_t a, std::uint32_t b) {
  a = root_of(parent, a);
  b = root_of(parent, b);
  parent[std::max(a, b)] = std::min(a, b);
}

}  // namespace cycloid::solver
