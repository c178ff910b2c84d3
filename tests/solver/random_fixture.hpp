#pragma once

#include <random>

namespace cycloid::solver {

/// Raw generator words alone: the distributions of <random> differ between libraries.
inline float uniform(std::mt19937& random, float lower, float upper) {
  return lower + (upper - lower) * static_cast<float>(random() >> 8) / 16777216.0f;
}

}  // namespace cycloid::solver
