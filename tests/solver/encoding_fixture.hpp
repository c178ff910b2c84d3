#pragma once

#include <cstddef>
#include <vector>

#include "solver/encoding.hpp"

namespace cycloid::solver {

inline std::vector<std::byte> bytes_of(const WorldState<2>& state) {
  std::vector<std::byte> bytes;
  encode_state(state, bytes);
  return bytes;
}

}  // namespace cycloid::solver
