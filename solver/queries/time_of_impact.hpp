#pragma once

#include "solver/collision/manifold.hpp"
#include "solver/state.hpp"

namespace cycloid::solver {

/// A body's way: the centre of mass moves straight, the rotation turns at a constant rate.
template <int D>
struct BodySweep {
  Pose<D> start;
  Vec<D> translation = Vec<D>::zero();  ///< m, of the whole way.
  Spin<D> turn = Spin<D>::zero();       ///< rad, of the whole way.
};

template <int D>
Pose<D> pose_at(const BodySweep<D>& sweep, float fraction);

/// How two shapes meet on their ways.
template <int D>
struct Impact {
  bool hit = false;
  float fraction = 1.0f;           ///< Of both ways, 0 to 1.
  Vec<D> normal = Vec<D>::zero();  ///< From a to b, at the impact.
  Vec<D> point = Vec<D>::zero();   ///< On the surface of a, world, m.
  float separation = 0.0f;         ///< m, at the impact.
};

/// The first fraction at which the shapes are `target` [m] apart, within `tolerance`: never later
/// than the true one. Shapes that are closer than that at the start meet at 0 if they approach
/// along their normal, and otherwise not at all. Chain edges are met from their free side only.
///
/// Conservative advancement: along the present separating axis n the gap can close no faster than
/// n . (v_a - v_b) + |w_a| r_a + |w_b| r_b, so the shapes cannot meet before the gap over that; at
/// most 48 such steps, then the last one, which is still before the impact, counts as it. Source:
/// Mirtich, "Impulse-based Dynamic Simulation of Rigid Body Systems" (1996).
/// @pre 0 < tolerance; target >= 0.
template <int D>
Impact<D> time_of_impact(const Shape<D>& a, const BodySweep<D>& sweep_a, const Shape<D>& b,
                         const BodySweep<D>& sweep_b, float target, float tolerance);

}  // namespace cycloid::solver
