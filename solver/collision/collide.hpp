#pragma once

#include "solver/collision/hull.hpp"
#include "solver/collision/manifold.hpp"
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

/// Collides pair after pair, while no pose changes. What a pair has of its shape a alone is made
/// once for pairs in a row that share it. Gives what `collide` gives.
template <int D>
class Collider {
 public:
  Manifold<D> operator()(const Shape<D>& a, const Pose<D>& pose_a, const Shape<D>& b,
                         const Pose<D>& pose_b, float margin, const Polyhedra& polyhedra) {
    return collide(a, pose_a, b, pose_b, margin, polyhedra);
  }
};
template <>
class Collider<2> {
 public:
  Manifold<2> operator()(const Shape<2>& a, const Pose<2>& pose_a, const Shape<2>& b,
                         const Pose<2>& pose_b, float margin, const Polyhedra& polyhedra);

 private:
  const Shape<2>* shape_ = nullptr;  ///< Whose hull it is.
  Hull hull_;
};

}  // namespace cycloid::solver
