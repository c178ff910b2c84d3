#pragma once

#include <span>
#include <vector>

#include "solver/result.hpp"
#include "solver/solids/polyhedron.hpp"

namespace cycloid::solver {

/// One hull on its own, and where its frame lies in that of the points it was made from.
struct PolyhedronData {
  std::vector<PolyhedronVertex> vertices;
  std::vector<PolyhedronFace> faces;
  std::vector<PolyhedronEdge> edges;
  Vec<3> middle = Vec<3>::zero();  ///< Of the bounding box of the corners, m.
  Vec<3> half = Vec<3>::zero();    ///< Half extents of that box, m.

  PolyhedronView view() const { return {vertices, faces, edges}; }
};

/// How far, at most, an input point ends outside of the plane of any face, as a part of the longest
/// side of the bounding box.
inline constexpr float kHullTolerance = 1.0e-5f;
/// The thinnest hull, as a part of the same; and never thinner than kSizeMin.
inline constexpr float kHullThinnest = 1.0e-4f;

/// The convex hull of 4 to kHullPointsMax points [m, |coordinate| <= kSizeMax], which may repeat,
/// lie inside, or lie in one plane with others.
///
/// Corners are some of the points, in their order, the first of equal ones; a point that lies
/// within half of kHullTolerance of the hull of the others is no corner. Half-edges 2 i and 2 i + 1
/// are sorted by (lower corner, higher corner), 2 i runs from the lower one. Faces come in the
/// order of their lowest half-edges. Triangles within an eighth of kHullTolerance of a common plane
/// are one face. Every face is strictly convex, no corner lies above the offset of a face.
///
/// @returns kInvalid "points" for a number out of range, points without volume, a hull thinner than
/// kHullThinnest or kSizeMin (measured along the normals of faces), and for more than
/// kHullVerticesMax corners; then `out` is unchanged.
Error build_polyhedron(std::span<const Vec<3>> points, PolyhedronData& out);

}  // namespace cycloid::solver
