#pragma once

#include <random>

#include "solver/constraints/rows.hpp"

namespace cycloid::solver {

/// What the tests of Jacobians against central differences share.

inline constexpr float kDifference = 2.0e-3f;      ///< Of a freedom, to either side, m or rad.
inline constexpr float kSlopeTolerance = 2.0e-3f;  ///< Relative, of slopes above 1.

template <int N>
Vec<N> random_vec(std::mt19937& random, float size) {
  std::uniform_real_distribution<float> in(-size, size);
  Vec<N> v;
  for (int i = 0; i < N; ++i) v[i] = in(random);
  return v;
}

/// The entry of one of the 2 (D + spin) freedoms; those of a first, positions before turns.
template <int D>
float entry(const Row<D>& row, int freedom) {
  const bool of_b = freedom >= Dim<D>::kFreedoms;
  const int i = freedom % Dim<D>::kFreedoms;
  if (i < D) return of_b ? row.linear_b[i] : row.linear_a[i];
  return of_b ? row.angular_b[i - D] : row.angular_a[i - D];
}

}  // namespace cycloid::solver
