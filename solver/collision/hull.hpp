#pragma once

#include "solver/collision/manifold.hpp"
#include "solver/state.hpp"

namespace cycloid::solver {

/// A planar convex shape in the frame of the collision: a capsule is a hull of two vertices, whose
/// two edges are its two sides; a chain segment is one whose second side does not collide.
struct Hull {
  std::uint32_t count;
  float radius;
  // By coordinate, so that lanes take four at once. Up to a multiple of four the first vertex and
  // normal follow the last ones, which changes no minimum; of a segment, its ghosts.
  std::array<float, 8> vertex_x;
  std::array<float, 8> vertex_y;
  std::array<float, 8> normal_x;  ///< Of the edge from vertex i to i + 1.
  std::array<float, 8> normal_y;
  std::uint32_t ghosts;  ///< Segment: as in Shape.
  bool one_sided;

  Vec<2> vertex(std::uint32_t i) const { return {{vertex_x[i], vertex_y[i]}}; }
  Vec<2> normal(std::uint32_t i) const { return {{normal_x[i], normal_y[i]}}; }
};

/// Vectors of the plane, four at a time: of a hull those from `first` on.
using Four = Vec<2, Lanes<4>>;
inline Four four_vertices(const Hull& hull, std::uint32_t first) {
  return {{Lanes<4>::load(&hull.vertex_x[first]), Lanes<4>::load(&hull.vertex_y[first])}};
}
inline Four four_normals(const Hull& hull, std::uint32_t first) {
  return {{Lanes<4>::load(&hull.normal_x[first]), Lanes<4>::load(&hull.normal_y[first])}};
}
inline Four in_each_lane(const Vec<2>& r) {
  return {{Lanes<4>(r[0]), Lanes<4>(r[1])}};
}
template <int kLane>
Lanes<4> each_is(Lanes<4> a) {
  return Lanes<4>(Lanes<4>::Raw{a.raw[kLane], a.raw[kLane], a.raw[kLane], a.raw[kLane]});
}

/// The greatest of four, the first of equals.
struct Greatest {
  std::uint32_t lane;
  float value;
};
inline Greatest greatest_of(Lanes<4> values) {
  float v[4];
  values.store(v);
  const Greatest low = v[1] > v[0] ? Greatest{1, v[1]} : Greatest{0, v[0]};
  const Greatest high = v[3] > v[2] ? Greatest{3, v[3]} : Greatest{2, v[2]};
  return high.value > low.value ? high : low;
}

Hull make_hull(const Shape<2>& shape, const Rotation<2>& rotation, const Vec<2>& position);

// All manifolds below have the normal from the first to the second shape and are relative to body
// a, whose centre is the origin.

Manifold<2> hull_against_ball(const Hull& hull, const Vec<2>& centre, float radius, float margin);

/// Separating axes over the edges of both, then the incident edge clipped to the reference edge;
/// where the cores are apart and their closest features are two vertices, the line between them.
/// Source: Gregorius, "The Separating Axis Test between Convex Polyhedra" (GDC 2013), in the plane.
Manifold<2> hull_against_hull(const Hull& a, const Hull& b, float margin);

/// The two deepest vertices. `offset` is of the plane through `normal` in the same frame; the
/// normal of the manifold is the half-space's.
Manifold<2> half_space_against_hull(const Vec<2>& normal, float offset, const Hull& hull,
                                    float margin);

}  // namespace cycloid::solver
