#pragma once

#include "solver/collision/manifold.hpp"
#include "solver/state.hpp"

namespace cycloid::solver {

/// A planar convex shape in the frame of the collision: a capsule is a hull of two vertices, whose
/// two edges are its two sides; a chain segment is one whose second side does not collide.
struct Hull {
  std::uint32_t count;
  float radius;
  std::array<Vec<2>, 8> vertices;
  std::array<Vec<2>, 8> normals;  ///< Of the edge from vertex i to i + 1.
  std::uint32_t ghosts;           ///< Segment: as in Shape.
  bool one_sided;
};

Hull make_hull(const Shape<2>& shape, const Rotation<2>& rotation, const Vec<2>& position);

// All manifolds below have the normal from the first to the second shape and are relative to body
// a, whose centre is the origin; `a_to_b` is the centre of body b.

Manifold<2> hull_against_ball(const Hull& hull, const Vec<2>& centre, float radius,
                              const Vec<2>& a_to_b, float margin);

/// Separating axes over the edges of both, then the incident edge clipped to the reference edge;
/// where the cores are apart and their closest features are two vertices, the line between them.
/// Source: Gregorius, "The Separating Axis Test between Convex Polyhedra" (GDC 2013), in the plane.
Manifold<2> hull_against_hull(const Hull& a, const Hull& b, const Vec<2>& a_to_b, float margin);

/// The two deepest vertices. `offset` is of the plane through `normal` in the same frame; the
/// normal of the manifold is the half-space's.
Manifold<2> half_space_against_hull(const Vec<2>& normal, float offset, const Hull& hull,
                                    const Vec<2>& a_to_b, float margin);

}  // namespace cycloid::solver
