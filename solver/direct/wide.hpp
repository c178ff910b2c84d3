#pragma once

#include "solver/lanes.hpp"

namespace cycloid::solver {

/// The numbers of a factorisation over an island, where the stiffness of what holds is a million
/// times the mass of the lightest body and floats would round that mass away. Nothing of them is
/// state: they start from floats and end as floats. Sums, products and quotients of doubles round
/// the same everywhere that floats do; contraction is off for both.
using Wide = double;

/// Two of them side by side, for what is solved with the same factors at the same time. The lanes
/// never mix, as in Lanes.
struct alignas(16) WidePair {
  typedef Wide Raw __attribute__((vector_size(16)));
  Raw raw;

  WidePair() = default;
  explicit WidePair(Raw both) : raw(both) {}
  explicit WidePair(float both) : raw{both, both} {}
  WidePair(Wide first, Wide second) : raw{first, second} {}

  friend WidePair operator+(WidePair a, WidePair b) { return WidePair(a.raw + b.raw); }
  friend WidePair operator-(WidePair a, WidePair b) { return WidePair(a.raw - b.raw); }
  friend WidePair operator*(Wide a, WidePair b) { return WidePair(Raw{a, a} * b.raw); }
  WidePair& operator+=(WidePair b) { return *this = *this + b; }
  WidePair& operator-=(WidePair b) { return *this = *this - b; }
};

inline Wide magnitude(Wide x) {
  return x < 0.0 ? -x : x;
}

/// To the digits of a float, which is what a direction needs.
inline Wide root(Wide square) {
  return static_cast<Wide>(sqrt(static_cast<float>(square)));
}

}  // namespace cycloid::solver
