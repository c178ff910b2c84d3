#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "solver/definitions.hpp"
#include "solver/solids/hull_builder.hpp"

namespace cycloid::solver {

/// Points of hulls whose volume and moments are known, and a judge of what a hull has to be.

using Points = std::vector<Vec<3>>;

inline ShapeDef<3> hull_def(const Points& points) {
  ShapeDef<3> shape;
  shape.kind = ShapeKind::kHull;
  shape.points = points;
  return shape;
}

inline Points box_points(float x, float y, float z) {
  Points points;
  for (int i = 0; i < 8; ++i)
    points.push_back({{(i & 1) != 0 ? x : -x, (i & 2) != 0 ? y : -y, (i & 4) != 0 ? z : -z}});
  return points;
}

inline Points octahedron_points(float r) {
  return {{{r, 0, 0}}, {{-r, 0, 0}}, {{0, r, 0}}, {{0, -r, 0}}, {{0, 0, r}}, {{0, 0, -r}}};
}

/// Regular, of edge 2 scale.
inline Points icosahedron_points(float scale) {
  const float g = 0.5f * (1.0f + std::sqrt(5.0f)) * scale;
  Points points;
  for (const float a : {-scale, scale})
    for (const float b : {-g, g}) {
      points.push_back({{0, a, b}});
      points.push_back({{a, b, 0}});
      points.push_back({{b, 0, a}});
    }
  return points;
}

/// A regular prism about axis 1.
inline Points prism_points(int sides, float radius, float half_height) {
  Points points;
  for (int i = 0; i < sides; ++i)
    for (const float y : {-half_height, half_height}) {
      const double angle = 2.0 * M_PI * i / sides;
      points.push_back({{radius * static_cast<float>(std::cos(angle)), y,
                         radius * static_cast<float>(std::sin(angle))}});
    }
  return points;
}

/// Evenly over a sphere: a Fibonacci spiral.
inline Points sphere_points(int count, float radius) {
  Points points;
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count;
    const double angle = M_PI * (3.0 - std::sqrt(5.0)) * i;
    const double r = std::sqrt(1.0 - z * z);
    points.push_back(
        {{radius * static_cast<float>(r * std::cos(angle)),
          radius * static_cast<float>(r * std::sin(angle)), radius * static_cast<float>(z)}});
  }
  return points;
}

inline float longest_side(const Points& points) {
  Vec<3> lower = points[0];
  Vec<3> upper = points[0];
  for (const Vec<3>& p : points)
    for (int i = 0; i < 3; ++i) {
      lower[i] = std::min(lower[i], p[i]);
      upper[i] = std::max(upper[i], p[i]);
    }
  const Vec<3> side = upper - lower;
  return std::max({side[0], side[1], side[2]});
}

inline double height(const PolyhedronFace& face, const Vec<3>& at) {
  double sum = -double{face.offset};
  for (int i = 0; i < 3; ++i) sum += double{face.normal[i]} * double{at[i]};
  return sum;
}

/// Indices, twins, loops, corners and Euler's formula.
inline void expect_closed(const PolyhedronData& hull) {
  const std::size_t v = hull.vertices.size();
  const std::size_t e = hull.edges.size();
  const std::size_t f = hull.faces.size();
  ASSERT_EQ(v + f, e / 2 + 2);
  ASSERT_LE(v, kHullVerticesMax);
  ASSERT_LE(f, kHullFacesMax);
  std::size_t walked = 0;
  for (std::uint32_t i = 0; i < f; ++i) {
    std::uint32_t edge = hull.faces[i].edge;
    std::size_t sides = 0;
    do {
      ASSERT_LT(edge, e);
      ASSERT_GE(edge, hull.faces[i].edge);
      ASSERT_EQ(hull.edges[edge].face, i);
      ASSERT_EQ(hull.edges[edge].twin, edge ^ 1u);
      const std::uint32_t next = hull.edges[edge].next;
      ASSERT_EQ(hull.edges[next].origin, hull.edges[edge ^ 1u].origin);
      edge = next;
      ASSERT_LE(++sides, v);
    } while (edge != hull.faces[i].edge);
    ASSERT_GE(sides, 3u);
    walked += sides;
  }
  ASSERT_EQ(walked, e);
  for (std::uint32_t i = 0; i < v; ++i) {
    ASSERT_EQ(hull.edges[hull.vertices[i].edge].origin, i);
    for (std::uint32_t k = 0; k < hull.vertices[i].edge; ++k) ASSERT_NE(hull.edges[k].origin, i);
  }
}

/// Flat, strictly convex faces that have all corners and all points below them.
inline void expect_convex(const PolyhedronData& hull, const Points& points) {
  const double size = double{longest_side(points)};
  for (const PolyhedronFace& face : hull.faces) {
    ASSERT_NEAR(length(face.normal), 1.0, 1e-6);
    for (const PolyhedronVertex& vertex : hull.vertices)
      ASSERT_LE(height(face, vertex.position), 1e-6 * size);
    for (const Vec<3>& p : points)
      ASSERT_LE(height(face, p - hull.middle), double{kHullTolerance} * size);
    std::uint32_t e = face.edge;
    do {
      const PolyhedronEdge& edge = hull.edges[e];
      const PolyhedronEdge& next = hull.edges[edge.next];
      const Vec<3> a = hull.vertices[edge.origin].position;
      const Vec<3> b = hull.vertices[next.origin].position;
      const Vec<3> c = hull.vertices[hull.edges[next.next].origin].position;
      ASSERT_GE(height(face, a), -0.5 * double{kHullTolerance} * size);
      ASSERT_GT(dot(face.normal, cross(b - a, c - b)), 0.0f);
      e = edge.next;
    } while (e != face.edge);
  }
}

inline void expect_hull(const PolyhedronData& hull, const Points& points) {
  ASSERT_NO_FATAL_FAILURE(expect_closed(hull));
  ASSERT_NO_FATAL_FAILURE(expect_convex(hull, points));
}

}  // namespace cycloid::solver
