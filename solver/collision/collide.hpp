#pragma once

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

}  // namespace cycloid::solver
