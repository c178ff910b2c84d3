#pragma once

#include "solver/lanes.hpp"

namespace cycloid::solver {

/// The numbers of a factorisation over an island, where the stiffness of what holds is a million
/// times the mass of the lightest body and floats would round that mass away. Nothing of them is
/// state: they start from floats and end as floats. Sums, products and quotients of doubles round
/// the same everywhere that floats do; contraction is off for both.
using Wide = double;

inline Wide magnitude(Wide x) {
  return x < 0.0 ? -x : x;
}

/// To the digits of a float, which is what a direction needs.
inline Wide root(Wide square) {
  return static_cast<Wide>(sqrt(static_cast<float>(square)));
}

}  // namespace cycloid::solver
