#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "solver/dim.hpp"

namespace cycloid::solver {

/// Points rounded to a grid of 2^24 steps or fewer along the longest axis: about the precision that
/// float32 points have anyway. On whole numbers the question on which side of a plane a point lies
/// has an exact answer, so the hull of such points is always a closed convex surface.
struct GridPoint {
  std::array<std::int32_t, 3> v;
};

/// Twice the vector area of a flat piece of the surface, outwards; exact.
struct GridArea {
  std::array<std::int64_t, 3> v{};
};

/// One triangle of the surface, counter-clockwise seen from outside.
struct GridTriangle {
  std::array<std::uint32_t, 3> corners;
  GridArea area;
  Vec<3> normal;  ///< Unit.
};

/// Difference of two grid points, exact.
Vec<3> grid_difference(const GridPoint& to, const GridPoint& from);

/// The unit vector along an area, or zero.
Vec<3> unit_normal(const GridArea& area);

/// The convex hull of those `points` that `chosen` [ascending] names, as triangles. Points at most
/// `tolerance` [grid steps] outside are left out; of points equally far outside a face the first
/// one is taken. @returns false where the points are no more than `tolerance` off a plane.
/// Source: incremental hull with the farthest point first, as Barber, Dobkin and Huhdanpaa, "The
/// Quickhull Algorithm" (1996).
bool triangulate_hull(std::span<const GridPoint> points, std::span<const std::uint32_t> chosen,
                      float tolerance, std::vector<GridTriangle>& triangles);

/// How far a point lies outside of the planes of all triangles, grid steps; negative inside.
float height_above(const GridPoint& point, std::span<const GridPoint> points,
                   std::span<const GridTriangle> triangles);

}  // namespace cycloid::solver
