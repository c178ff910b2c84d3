#pragma once

#include "solver/collision/manifold.hpp"
#include "solver/state.hpp"

namespace cycloid::solver {

/// How far a point is outside of a shape, and the way out.
template <int D>
struct SignedDistance {
  float distance;  ///< m; negative inside.
  Vec<D> normal;   ///< World, unit: the gradient of the distance.
};

/// The exact signed distance of `point` from the surface of `shape`, whose body has this pose.
///
/// `point` and `pose.position` share any frame without rotation: put its origin near the point
/// where digits matter. Of several nearest features the edge, or face, of lowest index gives the
/// normal; on the core of a round shape, which has no direction, it is the edge's normal, a
/// direction across a capsule in space, or the first axis of the body for a ball.
///
/// A segment, and a triangle in space, is solid behind itself, opposite to its normal: behind its
/// span the distance is minus the depth, however deep. Beyond its ends the distance is that to the
/// end and is not negative but for the radius: what lies there belongs to the neighbours in the
/// chain.
///
/// But for the segment seen from behind, distance(y) >= distance(x) + dot(normal(x), y - x) for
/// all x and y, because the shapes are convex; move_particles marches by it.
/// @param polyhedra  of the world; only a hull has its corners there.
/// @pre shape.kind is not kFree.
template <int D>
SignedDistance<D> signed_distance(const Shape<D>& shape, const Pose<D>& pose, const Vec<D>& point,
                                  const Polyhedra& polyhedra = {});

}  // namespace cycloid::solver
