#pragma once

#include "solver/state.hpp"

namespace cycloid::solver {

/// A shape in the frame of a query (world axes, a nearby origin): a convex core that `radius`
/// rounds, or a half-space.
template <int D>
struct Core {
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

template <int D>
Core<D> core_of(const Shape<D>& shape, const Rotation<D>& rotation, const Vec<D>& position,
                const Polyhedra& polyhedra);

/// How far two shapes are apart, and where.
template <int D>
struct Separation {
  float distance = 0.0f;  ///< m between the surfaces; negative where they overlap.
  Vec<D> normal;          ///< Unit, from a to b.
  Vec<D> point_a;         ///< On the surface of a, m.
  Vec<D> point_b;
  bool crossing = false;  ///< The cores themselves overlap, not only their roundings.
};

/// The exact distance of two convex shapes, or for crossing cores the depth along the best edge
/// normal. A one-sided segment is an edge with two sides here, but is left along its own normal.
///
/// Unlike `collide`, which makes contacts for a solver and so may skip what a neighbour will make,
/// this always answers. It tries every vertex against every edge: at most 128 tests, but no
/// iteration that could stall. Ties go to the first found. @pre not two half-spaces.
template <int D>
Separation<D> separation_of(const Core<D>& a, const Core<D>& b);

/// Whether a chain's segment may be met along `normal` [unit, outwards]: on its free side and,
/// where a neighbour continues it, between the normals of both. Other shapes: always.
bool allows(const Core<2>& core, const Vec<2>& normal);
bool allows(const Core<3>& core, const Vec<3>& normal);

}  // namespace cycloid::solver
