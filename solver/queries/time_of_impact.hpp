#pragma once

#include "solver/collision/manifold.hpp"
#include "solver/state.hpp"

namespace cycloid::solver {

/// A body's way through a tick: the centre of mass moves straight, the rotation turns by a
/// constant spin.
template <int D>
struct BodySweep {
  Pose<D> start;       ///< World, of the centre of mass.
  Vec<D> translation;  ///< m, whole way.
  Spin<D> turn;        ///< rad, whole way; world axes.
};

/// The pose at `fraction` (0 to 1) of the way; at 0 exactly `start`.
template <int D>
Pose<D> pose_at(const BodySweep<D>& sweep, float fraction);

/// What time_of_impact found; without a hit `fraction` is 1.
struct Impact {
  bool hit = false;
  float fraction = 1.0f;
};

/// The earliest fraction of the way at which the separation of two shapes falls to `target` [m]
/// while they approach: there it lies in [target - tolerance, target], and no earlier fraction,
/// and without a hit none at all, has less than target - tolerance.
///
/// - Shapes that start closer than `target`: fraction 0 if their nearest points approach and the
///   way may lead deeper than target - tolerance / 2 (or, where they start below that, deeper by
///   tolerance / 4); no hit if they part or stay; otherwise where they approach later.
/// - A chain's segment or a mesh's triangle is hit on its free side and by the rules of its joints
///   alone (query.hpp); a shape that comes from behind passes it.
/// - Two segments or triangles, two half-spaces, or one of each never hit. @pre a half-space does
///   not turn.
/// - At most 64 steps. Where they do not suffice (a graze while spinning) the impact is reported at
///   the fraction reached, before the true one; shapes that started closer pass.
///
/// Conservative advancement: along the normal between the nearest points the gap of each pair of
/// vertices is bounded from below by a parabola (its speed now, and spin^2 x radius as the greatest
/// change of it), so a step never leads past the impact, and steps converge quadratically.
/// Source: Mirtich, "Impulse-based Dynamic Simulation" (1996), 2.3.2, with speeds per vertex.
/// @param polyhedra  of the world that both shapes belong to.
/// @pre 0 < tolerance < target, finite sweeps.
template <int D>
Impact time_of_impact(const Shape<D>& a, const BodySweep<D>& sweep_a, const Shape<D>& b,
                      const BodySweep<D>& sweep_b, float target, float tolerance,
                      const Polyhedra& polyhedra);

}  // namespace cycloid::solver
