#include "solver/collision/triangle_clip.hpp"

namespace cycloid::solver {

void face_polygon(const Solid& solid, std::uint32_t face, Polygon& polygon) {
  polygon.count = 0;
  const std::uint32_t first = solid.faces[face].edge;
  std::uint32_t edge = first;
  do {
    polygon.corners[polygon.count] = solid.vertices[solid.edges[edge].origin];
    polygon.labels[polygon.count] = polygon.count;
    ++polygon.count;
    edge = solid.edges[edge].next;
  } while (edge != first);
}

static void add_corner(const Vec<3>& corner, std::uint32_t label, Polygon& polygon) {
  // Rounding may let a plane cut a flat polygon more than twice; no solid comes near the end.
  if (polygon.count == Polygon::kCornersMax) return;
  polygon.corners[polygon.count] = corner;
  polygon.labels[polygon.count++] = label;
}

/// Keeps what is not above a plane: heights [m] are those of the corners. The new edge is `label`.
static void cut(const Polygon& polygon, std::span<const float> heights, std::uint32_t label,
                Polygon& cut_polygon) {
  cut_polygon.count = 0;
  for (std::uint32_t i = 0; i < polygon.count; ++i) {
    const std::uint32_t next = i + 1 < polygon.count ? i + 1 : 0;
    const bool inside = heights[i] <= 0.0f;
    const bool next_inside = heights[next] <= 0.0f;
    if (inside) add_corner(polygon.corners[i], polygon.labels[i], cut_polygon);
    if (inside == next_inside) continue;
    const float fraction = heights[i] / (heights[i] - heights[next]);
    const Vec<3> corner =
        polygon.corners[i] + fraction * (polygon.corners[next] - polygon.corners[i]);
    add_corner(corner, inside ? label : polygon.labels[i], cut_polygon);
  }
}

/// The corners in use only: a polygon has room for many more.
static void copy(const Polygon& from, Polygon& to) {
  to.count = from.count;
  for (std::uint32_t i = 0; i < from.count; ++i) {
    to.corners[i] = from.corners[i];
    to.labels[i] = from.labels[i];
  }
}

void clip_polygon(const Solid& solid, std::uint32_t face, float slack, Polygon& polygon) {
  const std::uint32_t first = solid.faces[face].edge;
  std::uint32_t edge = first;
  std::uint32_t label = kHullVerticesMax;
  std::array<float, Polygon::kCornersMax> heights;
  Polygon kept;
  do {
    const PolyhedronEdge& half = solid.edges[edge];
    const Vec<3> origin = solid.vertices[half.origin];
    const Vec<3> along = solid.vertices[solid.edges[half.next].origin] - origin;
    const Vec<3> side = cross(along, solid.normals[face]);
    const float bound = slack * length(side);
    bool cuts = false;
    for (std::uint32_t i = 0; i < polygon.count; ++i) {
      heights[i] = dot(side, polygon.corners[i] - origin) - bound;
      cuts = cuts || heights[i] > 0.0f;
    }
    if (cuts) {
      cut(polygon, heights, label, kept);
      copy(kept, polygon);
    }
    ++label;
    edge = half.next;
  } while (edge != first && polygon.count > 0);
}

}  // namespace cycloid::solver
