#pragma once

#include <memory>

#include "solver/queries/query.hpp"
#include "solver/solids/hull_builder.hpp"
#include "solver/state.hpp"

namespace cycloid::solver {

/// A shape in the frame of a query (world axes, a nearby origin): a convex core that `radius`
/// rounds, or a half-space.
template <int D>
struct Core;

template <>
struct Core<2> {
  static constexpr int D = 2;
  ShapeKind kind = ShapeKind::kFree;
  std::uint32_t count = 0;  ///< 0 for a half-space.
  std::uint32_t ghosts = 0;
  float radius = 0.0f;
  float offset = 0.0f;  ///< Half-space: solid where dot(normal, x) <= offset.
  Vec<D> normal;
  std::array<Vec<D>, Dim<D>::kVertices> vertices;
  std::array<Vec<D>, Dim<D>::kVertices> normals;

  bool half_space() const { return kind == ShapeKind::kHalfSpace; }
  bool one_sided() const { return kind == ShapeKind::kSegment; }
  /// Edges with a normal; a segment shows only its free side.
  std::uint32_t faces() const { return one_sided() ? 1 : (count < 2 ? 0 : count); }
  std::uint32_t next(std::uint32_t i) const { return i + 1 < count ? i + 1 : 0; }
};

/// Faces and half-edges are those of the polyhedron; without faces the core is a point, a line or
/// the hull of its vertices.
template <>
struct Core<3> {
  ShapeKind kind = ShapeKind::kFree;
  std::uint32_t count = 0;  ///< 0 for a half-space.
  std::uint32_t ghosts = 0;
  float radius = 0.0f;
  float offset = 0.0f;  ///< Half-space: solid where dot(normal, x) <= offset.
  Vec<3> normal;        ///< Half-space.
  std::uint32_t face_count = 0;
  std::uint32_t edge_count = 0;  ///< Half-edges.
  const PolyhedronFace* faces = nullptr;
  const PolyhedronEdge* edges = nullptr;
  std::shared_ptr<const PolyhedronData> own;      ///< Probe: the hull that these are of.
  Vec<3> centre;                                  ///< Hull: the origin of its own frame.
  Rotation<3> rotation;                           ///< Hull: of its faces.
  std::array<Vec<3>, 6> normals;                  ///< Box and triangle: of the faces; [0] is free.
  std::array<Vec<3>, kHullVerticesMax> vertices;  ///< Triangle: then the ghosts.

  bool half_space() const { return kind == ShapeKind::kHalfSpace; }
  bool one_sided() const { return kind == ShapeKind::kTriangle; }
  /// Unit, outwards. A hull's are turned when asked for, because most are not.
  Vec<3> face_normal(std::uint32_t face) const {
    return kind == ShapeKind::kHull ? rotate(rotation, faces[face].normal) : normals[face];
  }
  const Vec<3>& face_corner(std::uint32_t face) const {
    return vertices[edges[faces[face].edge].origin];
  }
};

template <int D>
Core<D> core_of(const Shape<D>& shape, const Rotation<D>& rotation, const Vec<D>& position,
                const Polyhedra& polyhedra);

/// The core of a probe whose pose has its position at the origin. In space a box may list its
/// corners in any order. The faces of other hulls are made by `build_polyhedron`; where that
/// refuses, as for points of one plane, the core has none: casts, distances and what overlaps are
/// as exact as for others, but how deep it crosses another core is the depth along the best face
/// normal of that one, or along axis 1 where that has none either.
Core<2> core_of(const Probe<2>& probe, const Rotation<2>& rotation);
Core<3> core_of(const Probe<3>& probe, const Rotation<3>& rotation);

/// How far two shapes are apart, and where.
template <int D>
struct Separation {
  float distance = 0.0f;  ///< m between the surfaces; negative where they overlap.
  Vec<D> normal;          ///< Unit, from a to b.
  Vec<D> point_a;         ///< On the surface of a, m.
  Vec<D> point_b;
  bool crossing = false;  ///< The cores themselves overlap, not only their roundings.
  bool by_axis = false;   ///< Points are told by a plane, on which they may lie beside the shapes.
};

/// The exact distance of two convex shapes, or for crossing cores the depth along the best edge
/// normal. A one-sided segment is an edge with two sides here, but is left along its own normal.
///
/// In space: over edges' cross products too, and exact within 1e-6 of the size of the cores, or of
/// their distance where they are farther apart; cores nearer than that are left as crossing ones.
///
/// Unlike `collide`, which makes contacts for a solver and so may skip what a neighbour will make,
/// this always answers. In the plane it tries every vertex against every edge: at most 128 tests,
/// but no iteration that could stall. Ties go to the first found. @pre not two half-spaces.
template <int D>
Separation<D> separation_of(const Core<D>& a, const Core<D>& b);

/// Where `probe` leaves the core of `a` that it overlaps by `depth` [m], when it moves along
/// `normal` [unit, from a to the probe]: the point of that core nearest to the probe's once it is
/// just out.
template <int D>
Vec<D> touched_point(const Core<D>& a, const Core<D>& probe, const Vec<D>& normal, float depth);

/// The point of `between` on the surface of `a`; where its plane has it beside one of both, as it
/// may where their faces are parallel, the point of `a` that the probe leaves last.
template <int D>
Vec<D> surface_point(const Core<D>& a, const Core<D>& probe, const Separation<D>& between);

/// Whether a chain's segment or a mesh's triangle may be met along `normal` [unit, outwards]: on
/// its free side and, where a neighbour continues it, between the normals of both. Other shapes:
/// always.
bool allows(const Core<2>& core, const Vec<2>& normal);
bool allows(const Core<3>& core, const Vec<3>& normal);

}  // namespace cycloid::solver
