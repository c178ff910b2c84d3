#pragma once

#include "solver/direct/island_solver.hpp"

namespace cycloid::solver {

// What the two halves of the island solver share: island_solver.cpp and island_step.cpp.

/// M^-1 p of one node.
template <int D>
Vec<Dim<D>::kFreedoms, Wide> answer_to(const Vec<Dim<D>::kFreedoms, Wide>& momentum,
                                       const BodyMass<D>& mass) {
  constexpr int kSpin = Dim<D>::kSpin;
  Vec<Dim<D>::kFreedoms, Wide> velocity;
  for (int i = 0; i < D; ++i) velocity[i] = static_cast<Wide>(mass.inverse_mass) * momentum[i];
  for (int i = 0; i < kSpin; ++i) {
    velocity[D + i] = 0.0;
    for (int j = 0; j < kSpin; ++j)
      velocity[D + i] += static_cast<Wide>(mass.inverse_inertia.m[i * kSpin + j]) * momentum[D + j];
  }
  return velocity;
}

/// Of the changed impulses, whose length friction bounds.
template <int D>
Wide square_of_tangents(const IslandRows<D>& group, const IslandRow<D>* row) {
  Wide square = 0.0;
  for (int t = 1; t < group.count; ++t) {
    const Wide tangent = row[t].impulse + row[t].change;
    square += tangent * tangent;
  }
  return square;
}

}  // namespace cycloid::solver
