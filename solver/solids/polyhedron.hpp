#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "solver/dim.hpp"

namespace cycloid::solver {

/// Most corners, faces and half-edges of one hull. A convex polyhedron of V corners has at most
/// 2 V - 4 faces and 6 V - 12 half-edges.
inline constexpr std::uint32_t kHullVerticesMax = 64;
inline constexpr std::uint32_t kHullPointsMax = 256;  ///< Of a definition; inner ones are dropped.
inline constexpr std::uint32_t kHullFacesMax = 2 * kHullVerticesMax - 4;
inline constexpr std::uint32_t kHullEdgesMax = 6 * kHullVerticesMax - 12;

/// A corner, from the middle of the hull's bounding box, m.
struct PolyhedronVertex {
  Vec<3> position;
  std::uint32_t edge;  ///< A half-edge that starts here: the lowest one.
};

/// A flat face, of three or more corners: solid where dot(normal, x) <= offset.
struct PolyhedronFace {
  Vec<3> normal;  ///< Unit, outwards.
  float offset;
  std::uint32_t edge;  ///< The lowest of its half-edges.
};

/// One side of an edge: runs counter-clockwise around its face seen from outside. Half-edges 2 i
/// and 2 i + 1 are twins.
struct PolyhedronEdge {
  std::uint32_t origin;
  std::uint32_t twin;
  std::uint32_t next;
  std::uint32_t face;
};

/// Where one hull lies in the pools. Indices inside its vertices, faces and edges count from its
/// own first ones. Hulls of equal corners share one record. `references` counts the shapes that use
/// it; a free slot has none.
struct Polyhedron {
  std::uint32_t references = 0;
  std::uint32_t first_vertex = 0;
  std::uint32_t vertex_count = 0;
  std::uint32_t first_face = 0;
  std::uint32_t face_count = 0;
  std::uint32_t first_edge = 0;
  std::uint32_t edge_count = 0;  ///< Half-edges.
};

/// The hulls of a world, as flat arrays: part of the state. Empty in the plane.
struct Polyhedra {
  std::vector<Polyhedron> records;
  std::vector<PolyhedronVertex> vertices;
  std::vector<PolyhedronFace> faces;
  std::vector<PolyhedronEdge> edges;
};

/// One hull, wherever it is kept.
struct PolyhedronView {
  std::span<const PolyhedronVertex> vertices;
  std::span<const PolyhedronFace> faces;
  std::span<const PolyhedronEdge> edges;
};

/// @pre `slot` is a record with references.
inline PolyhedronView view_of(const Polyhedra& polyhedra, std::uint32_t slot) {
  const Polyhedron& record = polyhedra.records[slot];
  return {std::span(polyhedra.vertices).subspan(record.first_vertex, record.vertex_count),
          std::span(polyhedra.faces).subspan(record.first_face, record.face_count),
          std::span(polyhedra.edges).subspan(record.first_edge, record.edge_count)};
}

}  // namespace cycloid::solver
