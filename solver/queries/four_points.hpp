#pragma once

#include <array>

#include "solver/dim.hpp"

namespace cycloid::solver {

/// Vertices of a core of the plane, four at a time: what is asked of each of them is asked of four
/// in the time of one, by the same formulas and so to the same bits.
using FourFloats = Lanes<4>;
using FourPoints = Vec<2, FourFloats>;
using CoreVertices = std::array<Vec<2>, Dim<2>::kVertices>;

/// Entries [first, first + 4) as they are.
inline FourPoints load_four(const CoreVertices& from, std::uint32_t first) {
  FourFloats::Raw low;
  FourFloats::Raw high;
  std::memcpy(&low, &from[first], sizeof low);
  std::memcpy(&high, &from[first + 2], sizeof high);
  return {{FourFloats(__builtin_shufflevector(low, high, 0, 2, 4, 6)),
           FourFloats(__builtin_shufflevector(low, high, 1, 3, 5, 7))}};
}

inline void store_four(const FourPoints& points, std::uint32_t first, CoreVertices& to) {
  const FourFloats::Raw low = __builtin_shufflevector(points[0].raw, points[1].raw, 0, 4, 1, 5);
  const FourFloats::Raw high = __builtin_shufflevector(points[0].raw, points[1].raw, 2, 6, 3, 7);
  std::memcpy(&to[first], &low, sizeof low);
  std::memcpy(&to[first + 2], &high, sizeof high);
}

/// The same, and the first entry of all in place of those from `count` on: a copy behind it changes
/// no least of all, of which the first is taken. @pre count > first.
inline FourPoints load_four_of(const CoreVertices& from, std::uint32_t first, std::uint32_t count) {
  FourPoints four = load_four(from, first);
  if (count - first >= 4) return four;
  const FourFloats number(FourFloats::Raw{0.0f, 1.0f, 2.0f, 3.0f});
  const auto is_one = number < FourFloats(static_cast<float>(count - first));
  for (int i = 0; i < 2; ++i) four[i] = select(is_one, four[i], FourFloats(from[0][i]));
  return four;
}

/// The same four times.
inline FourPoints four_of(const Vec<2>& point) {
  return {{FourFloats(point[0]), FourFloats(point[1])}};
}

}  // namespace cycloid::solver
