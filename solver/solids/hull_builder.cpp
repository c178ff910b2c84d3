#include "solver/solids/hull_builder.hpp"

#include "solver/solids/face_merger.hpp"
#include "solver/solids/integer_hull.hpp"
#include "solver/validate.hpp"

namespace cycloid::solver {

static constexpr Error kBadPoints = {Code::kInvalid, "points"};
static constexpr float kGridSteps = 16777215.0f;  // Of the longest side, at most: 2^24 - 1.

struct Box {
  Vec<3> lower;
  Vec<3> upper;
};

static Box box_of(std::span<const Vec<3>> points) {
  Box box{points[0], points[0]};
  for (const Vec<3>& point : points)
    for (int i = 0; i < 3; ++i) {
      box.lower[i] = min(box.lower[i], point[i]);
      box.upper[i] = max(box.upper[i], point[i]);
    }
  return box;
}

static float longest_side(const Box& box) {
  const Vec<3> side = box.upper - box.lower;
  return max(side[0], max(side[1], side[2]));
}

/// Steps per metre: a power of two, so that scaling is exact.
static float grid_scale(float size) {
  float scale = 1.0f;
  while (size * scale > kGridSteps) scale *= 0.5f;
  while (size * scale * 2.0f <= kGridSteps) scale *= 2.0f;
  return scale;
}

static std::vector<GridPoint> grid_points(std::span<const Vec<3>> points, const Vec<3>& lower,
                                          float scale) {
  std::vector<GridPoint> grid;
  for (const Vec<3>& point : points) {
    GridPoint& to = grid.emplace_back();
    for (int i = 0; i < 3; ++i)
      to.v[static_cast<std::size_t>(i)] =
          static_cast<std::int32_t>((point[i] - lower[i]) * scale + 0.5f);
  }
  return grid;
}

static std::vector<std::uint32_t> corners_of(std::span<const GridTriangle> triangles,
                                             std::size_t count) {
  std::vector<bool> used(count, false);
  for (const GridTriangle& triangle : triangles)
    for (const std::uint32_t corner : triangle.corners) used[corner] = true;
  std::vector<std::uint32_t> corners;
  for (std::uint32_t i = 0; i < count; ++i)
    if (used[i]) corners.push_back(i);
  return corners;
}

/// The neighbours of a corner and, so that they span a volume, the farthest of the other corners.
static std::vector<std::uint32_t> surroundings(std::span<const GridPoint> grid,
                                               std::span<const GridTriangle> triangles,
                                               std::span<const std::uint32_t> corners,
                                               std::uint32_t corner) {
  std::vector<bool> used(grid.size(), false);
  for (const GridTriangle& triangle : triangles) {
    const std::array<std::uint32_t, 3>& t = triangle.corners;
    if (t[0] == corner || t[1] == corner || t[2] == corner)
      used[t[0]] = used[t[1]] = used[t[2]] = true;
  }
  std::uint32_t farthest = corner;
  float most = 0.0f;
  for (const std::uint32_t other : corners) {
    const float distance = length(grid_difference(grid[other], grid[corner]));
    if (used[other] || distance <= most) continue;
    most = distance;
    farthest = other;
  }
  used[farthest] = true;
  used[corner] = false;
  std::vector<std::uint32_t> around;
  for (const std::uint32_t other : corners)
    if (used[other]) around.push_back(other);
  return around;
}

/// How far a corner lies outside of the hull of the others, grid steps. Without the corner its
/// neighbours alone are the corners of the triangles that close the gap, so that their hull tells,
/// unless it is flat.
static float height_over_others(std::span<const GridPoint> grid,
                                std::span<const GridTriangle> triangles,
                                std::span<const std::uint32_t> corners, std::uint32_t corner) {
  std::vector<GridTriangle> closed;
  if (!triangulate_hull(grid, surroundings(grid, triangles, corners, corner), 0.0f, closed)) {
    std::vector<std::uint32_t> others;
    for (const std::uint32_t other : corners)
      if (other != corner) others.push_back(other);
    if (!triangulate_hull(grid, others, 0.0f, closed)) return kGridSteps;
  }
  return height_above(grid[corner], grid, closed);
}

/// The points of which none lies within `tolerance` of the hull of the others, later ones dropped
/// first. Then no corner is left in the middle of what is almost a plane or a line, which merging
/// could not take out.
static std::vector<std::uint32_t> find_corners(std::span<const GridPoint> grid, float tolerance) {
  std::vector<std::uint32_t> corners;
  for (std::uint32_t i = 0; i < grid.size(); ++i) corners.push_back(i);
  std::vector<GridTriangle> triangles;
  if (!triangulate_hull(grid, corners, tolerance, triangles)) return {};
  corners = corners_of(triangles, grid.size());
  for (std::size_t i = corners.size(); i-- > 0 && corners.size() > 4;) {
    if (height_over_others(grid, triangles, corners, corners[i]) > tolerance) continue;
    corners.erase(corners.begin() + static_cast<std::ptrdiff_t>(i));
    if (!triangulate_hull(grid, corners, 0.0f, triangles)) return {};
  }
  return corners;
}

/// Positions about the middle of their bounding box.
static void place_vertices(std::span<const Vec<3>> corners, PolyhedronData& out) {
  const Box box = box_of(corners);
  out.middle = 0.5f * (box.lower + box.upper);
  for (const Vec<3>& corner : corners) {
    const Vec<3> position = corner - out.middle;
    out.vertices.push_back({position, 0});
    for (int i = 0; i < 3; ++i) out.half[i] = max(out.half[i], abs(position[i]));
  }
}

/// Sets the offsets of the faces. @returns the least width along their normals, m.
static float place_faces(PolyhedronData& out) {
  float width = 2.0f * kSizeMax;
  for (PolyhedronFace& face : out.faces) {
    face.offset = dot(face.normal, out.vertices[0].position);
    float lowest = face.offset;
    for (const PolyhedronVertex& vertex : out.vertices) {
      const float height = dot(face.normal, vertex.position);
      face.offset = max(face.offset, height);
      lowest = min(lowest, height);
    }
    width = min(width, face.offset - lowest);
  }
  return width;
}

Error build_polyhedron(std::span<const Vec<3>> points, PolyhedronData& out) {
  if (points.size() < 4 || points.size() > kHullPointsMax) return kBadPoints;
  for (const Vec<3>& point : points)
    if (!within(point, kSizeMax)) return kBadPoints;
  const Box box = box_of(points);
  const float size = longest_side(box);
  if (size < kSizeMin) return kBadPoints;
  const float scale = grid_scale(size);
  const float tolerance = 0.5f * kHullTolerance * size * scale;
  const std::vector<GridPoint> grid = grid_points(points, box.lower, scale);
  const std::vector<std::uint32_t> corners = find_corners(grid, tolerance);
  if (corners.size() < 4 || corners.size() > kHullVerticesMax) return kBadPoints;

  std::vector<Vec<3>> places;
  std::vector<GridPoint> grid_corners;
  std::vector<std::uint32_t> all;
  for (const std::uint32_t corner : corners) {
    all.push_back(static_cast<std::uint32_t>(places.size()));
    places.push_back(points[corner]);
    grid_corners.push_back(grid[corner]);
  }
  std::vector<GridTriangle> triangles;
  if (!triangulate_hull(grid_corners, all, 0.0f, triangles) ||
      corners_of(triangles, all.size()).size() != all.size())
    return kBadPoints;
  PolyhedronData built;
  place_vertices(places, built);
  link_faces(grid_corners, triangles, 0.25f * tolerance, built);
  const float width = place_faces(built);
  if (width < kSizeMin || width < kHullThinnest * size) return kBadPoints;
  out = std::move(built);
  return {};
}

}  // namespace cycloid::solver
