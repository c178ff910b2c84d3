#pragma once

#include "solver/collision/manifold.hpp"
#include "solver/solids/polyhedron.hpp"
#include "solver/state.hpp"

namespace cycloid::solver {

/// A box, hull or triangle in the frame of the collision. Corners and normals are placed; faces and
/// half-edges are those of the polyhedron, whose own frame nothing here refers to.
///
/// A triangle is a solid of two faces: face 0 is its free side, face 1 its back.
struct Solid {
  ShapeKind kind;
  Vec<3> centre;  ///< A point inside.
  std::uint32_t vertex_count;
  std::uint32_t face_count;
  std::uint32_t edge_count;  ///< Half-edges.
  const PolyhedronFace* faces;
  const PolyhedronEdge* edges;
  std::array<Vec<3>, kHullVerticesMax> vertices;
  std::array<Vec<3>, kHullFacesMax> normals;
  /// Box: unit axes and half extents, so that its 15 axes need no walk over edges.
  Vec<3> axes[3];
  Vec<3> half;
  std::uint32_t ghosts;    ///< Triangle: as in Shape.
  Vec<3> ghost_points[3];  ///< Triangle: the far corner of the neighbour across edge i.

  float offset(std::uint32_t face) const {
    return dot(normals[face], vertices[edges[faces[face].edge].origin]);
  }
};

/// The topology of a box whose corner i lies on the positive side of axis k where bit k of i is
/// set, and whose face 2 k + s looks along axis k, negatively for s = 0; of a triangle.
PolyhedronView box_topology();
PolyhedronView triangle_topology();

/// Places a box, hull or triangle: x = position + rotation x_shape.
/// @param polyhedra  where the shape's hull is. @pre kind is kBox, kHull or kTriangle.
void place(const Shape<3>& shape, const Polyhedra& polyhedra, const Rotation<3>& rotation,
           const Vec<3>& position, Solid& solid);

/// A ball (both ends equal) or a capsule in the frame of the collision.
struct Rod {
  Vec<3> from;
  Vec<3> to;
  float radius;
};

// All manifolds below have the normal [unit] from the first to the second shape and are relative to
// body a, whose centre is the origin. Points closer than `margin` [m]; no point: apart.

/// Separating axes over faces and pairs of edges, then a face clipped to a face or the nearest
/// points of two edges; at most four points, chosen by `reduce`.
Manifold<3> solid_against_solid(const Solid& a, const Solid& b, float margin);
/// The same for two boxes, whose 15 axes are known beforehand.
Manifold<3> box_against_box(const Solid& a, const Solid& b, float margin);
Manifold<3> solid_against_rod(const Solid& solid, const Rod& rod, float margin);
Manifold<3> rod_against_rod(const Rod& a, const Rod& b, float margin);
Manifold<3> half_space_against_solid(const Vec<3>& normal, float offset, const Solid& solid,
                                     float margin);
Manifold<3> half_space_against_rod(const Vec<3>& normal, float offset, const Rod& rod,
                                   float margin);
/// A triangle of a mesh meets what is on its free side, and where a neighbour continues it, only
/// along normals between its own and the neighbour's, so that nothing stumbles over inner edges.
Manifold<3> triangle_against_solid(const Solid& triangle, const Solid& solid, float margin);
Manifold<3> triangle_against_rod(const Solid& triangle, const Rod& rod, float margin);

/// A candidate for a contact point: `at` lies midway between the surfaces, relative to body a.
struct Candidate {
  Vec<3> at;
  float separation;
  std::uint32_t feature;
};

/// Adds at most four of the candidates to the manifold, whose normal is set, in their order: all
/// where there are at most four; otherwise the deepest, the farthest from it, the one that spans
/// the largest triangle with both, and the one that adds most area beyond that, seen along the
/// normal; of equals the deepest, then the first. A depth within 1e-4 m of the deepest counts as
/// equal, and a length or area within 1e-3 of the largest, so that resting boxes keep their points.
/// Fewer than four where the others add nothing.
void reduce(std::span<const Candidate> candidates, Manifold<3>& manifold);

/// Of a feature: the reference face is one of b; or there is none.
inline constexpr std::uint32_t kReferenceOnB = 0x80000000u;
inline constexpr std::uint32_t kOfNoFace = 0x40000000u;

/// The feature of a point: unique within a manifold, and the same while the same features touch.
/// `reference` tells which shape has the reference face; `face` and `edge` count at most 255.
constexpr std::uint32_t clip_feature(bool on_b, std::uint32_t reference_face,
                                     std::uint32_t incident_edge, std::uint32_t clip_edge) {
  return (on_b ? kReferenceOnB : 0u) | (reference_face << 20) | (incident_edge << 10) | clip_edge;
}
/// In place of a clip edge: the point is a corner of the incident solid, in place of its edge.
inline constexpr std::uint32_t kCorner = 0x3ffu;
/// The feature of nearest points that are not on an axis of either solid's own.
inline constexpr std::uint32_t kNearest = kOfNoFace | 0x20000000u;

}  // namespace cycloid::solver
