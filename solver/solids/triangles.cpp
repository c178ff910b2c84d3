#include "solver/solids/triangles.hpp"

#include <algorithm>

#include "solver/validate.hpp"

namespace cycloid::solver {

using TriangleCorners = std::array<std::uint32_t, 3>;

/// A side of a triangle, from one point to another.
struct DirectedEdge {
  std::uint32_t from;
  std::uint32_t to;
  std::uint32_t triangle;
  std::uint32_t far_corner;

  bool operator<(const DirectedEdge& other) const {
    if (from != other.from) return from < other.from;
    if (to != other.to) return to < other.to;
    return triangle < other.triangle;
  }
};

static std::vector<DirectedEdge> sorted_edges(const std::vector<TriangleCorners>& triangles) {
  std::vector<DirectedEdge> edges;
  edges.reserve(3 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      edges.push_back({triangles[t][k], triangles[t][(k + 1) % 3], t, triangles[t][(k + 2) % 3]});
  // Total order: a triangle has three different corners, so none of its edges comes twice.
  std::sort(edges.begin(), edges.end());
  return edges;
}

/// The only edge that runs so; nullptr where there is none or more than one.
static const DirectedEdge* find_single(const std::vector<DirectedEdge>& edges, std::uint32_t from,
                                       std::uint32_t to) {
  const auto first = std::lower_bound(edges.begin(), edges.end(), DirectedEdge{from, to, 0, 0});
  const auto is_same = [&](auto it) {
    return it != edges.end() && it->from == from && it->to == to;
  };
  return is_same(first) && !is_same(first + 1) ? &*first : nullptr;
}

/// False where a corner is closer than kSizeMin to the side across from it.
static bool set_corners(const std::vector<Vec<3>>& points, const TriangleCorners& corners,
                        Shape<3>& shape) {
  for (std::size_t k = 0; k < 3; ++k) shape.vertices[k] = points[corners[k]];
  const Vec<3> u = shape.vertices[1] - shape.vertices[0];
  const Vec<3> w = shape.vertices[2] - shape.vertices[0];
  const Vec<3> area = cross(u, w);
  const float longest = max(length(u), max(length(w), length(w - u)));
  if (!(longest > 0.0f) || !(length(area) >= kSizeMin * longest)) return false;
  shape.normal = (1.0f / length(area)) * area;
  return true;
}

static bool append_triangles(const std::vector<Vec<3>>& points,
                             const std::vector<TriangleCorners>& triangles, const Shape<3>& blank,
                             std::vector<Shape<3>>& into) {
  std::vector<Shape<3>> shapes;
  for (const TriangleCorners& corners : triangles) {
    Shape<3>& shape = shapes.emplace_back(blank);
    shape.kind = ShapeKind::kTriangle;
    shape.vertex_count = 3;
    if (!set_corners(points, corners, shape)) return false;
  }
  const std::vector<DirectedEdge> edges = sorted_edges(triangles);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = triangles[t][k];
      const std::uint32_t to = triangles[t][(k + 1) % 3];
      const DirectedEdge* across = find_single(edges, to, from);
      if (across == nullptr || find_single(edges, from, to) == nullptr) continue;
      shapes[t].vertices[3 + k] = points[across->far_corner];
      shapes[t].ghosts |= 1u << k;
    }
  into.insert(into.end(), shapes.begin(), shapes.end());
  return true;
}

Error append_mesh(const ShapeDef<3>& def, int index, const Shape<3>& blank,
                  std::vector<Shape<3>>& into) {
  if (!append_triangles(def.points, def.triangles, blank, into))
    return {Code::kInvalid, "triangles", index};
  return {};
}

Error append_height_field(const ShapeDef<3>& def, int index, const Shape<3>& blank,
                          std::vector<Shape<3>>& into) {
  const Vec<3> origin = def.points.empty() ? Vec<3>::zero() : def.points[0];
  const auto rows = static_cast<std::uint32_t>(def.heights.size() / def.columns);
  std::vector<Vec<3>> points;
  for (std::uint32_t row = 0; row < rows; ++row)
    for (std::uint32_t column = 0; column < def.columns; ++column)
      points.push_back(origin + Vec<3>{{static_cast<float>(column) * def.cell[0],
                                        def.heights[row * def.columns + column],
                                        static_cast<float>(row) * def.cell[1]}});
  std::vector<TriangleCorners> triangles;
  for (std::uint32_t row = 0; row + 1 < rows; ++row)
    for (std::uint32_t column = 0; column + 1 < def.columns; ++column) {
      const std::uint32_t here = row * def.columns + column;
      const std::uint32_t across = here + def.columns + 1;
      triangles.push_back({here, across - 1, across});
      triangles.push_back({here, across, here + 1});
    }
  if (!append_triangles(points, triangles, blank, into)) return {Code::kInvalid, "heights", index};
  return {};
}

}  // namespace cycloid::solver
