#pragma once

#include "solver/collision/held_pairs.hpp"
#include "solver/collision/placed_pair.hpp"
#include "solver/state.hpp"

namespace cycloid::solver {

/// The manifold of two shapes at their bodies' poses: points closer than `margin` [m].
/// @param polyhedra  of the world that both shapes belong to.
///
/// Order of candidates is fixed: of equal separations the axis of shape a wins, then the lowest
/// edge index. In space solid.hpp says which. Computed relative to body a, so precision does not
/// depend on the world position.
template <int D>
Manifold<D> collide(const Shape<D>& a, const Pose<D>& pose_a, const Shape<D>& b,
                    const Pose<D>& pose_b, float margin, const Polyhedra& polyhedra);

/// Collides many pairs of one world, while no pose changes.
template <int D>
struct Collider {
  const Shape<D>* shapes;  ///< By slot.
  const Polyhedra& polyhedra;
  int lanes;  ///< A width of Lanes: of equal kinds of pairs so many are collided at once.

  /// manifolds[i] becomes what `collide_held` gives of pairs[i], for i in [0, count), for every
  /// width. @pre count <= kPairGrain; the keys of the pairs ascend.
  void operator()(const PlacedPair<D>* pairs, int count, Manifold<D>* manifolds,
                  PairMemory<D>& memory) const;
};

/// How many pairs are collided by one call.
inline constexpr int kPairGrain = 64;

}  // namespace cycloid::solver
