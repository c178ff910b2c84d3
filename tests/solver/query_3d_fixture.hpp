#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "solver/queries/query.hpp"
#include "solver/queries/separation.hpp"
#include "tests/solver/random_fixture.hpp"
#include "tests/solver/space_fixture.hpp"

namespace cycloid::solver {

/// Shapes in space made without a world, random poses, and a reference in double precision.

inline constexpr float kExact = 1e-6f;

inline Vec<3> random_vector(std::mt19937& random, float size) {
  return {
      {uniform(random, -size, size), uniform(random, -size, size), uniform(random, -size, size)}};
}

inline Rotation<3> random_rotation(std::mt19937& random) {
  Rotation<3> q;
  for (float& value : q.v) value = uniform(random, -1.0f, 1.0f);
  return normalized_or(q, identity_rotation<3>());
}

inline Shape<3> solid_ball(float radius) {
  Shape<3> shape{};
  shape.kind = ShapeKind::kBall;
  shape.vertex_count = 1;
  shape.radius = radius;
  return shape;
}

inline Shape<3> solid_capsule(Vec<3> from, Vec<3> to, float radius) {
  Shape<3> shape = solid_ball(radius);
  shape.kind = ShapeKind::kCapsule;
  shape.vertex_count = 2;
  shape.vertices[0] = from;
  shape.vertices[1] = to;
  return shape;
}

inline Shape<3> solid_box(Vec<3> half, Vec<3> centre = Vec<3>::zero(),
                          Rotation<3> rotation = identity_rotation<3>()) {
  Shape<3> shape = solid_ball(0.0f);
  shape.kind = ShapeKind::kBox;
  shape.vertices[0] = centre;
  shape.half = half;
  shape.rotation = rotation;
  return shape;
}

/// Free on the side from which a, b, c run counter-clockwise.
inline Shape<3> solid_triangle(Vec<3> a, Vec<3> b, Vec<3> c) {
  Shape<3> shape = solid_ball(0.0f);
  shape.kind = ShapeKind::kTriangle;
  shape.vertex_count = 3;
  shape.vertices[0] = a;
  shape.vertices[1] = b;
  shape.vertices[2] = c;
  shape.normal = normalized_or(cross(b - a, c - a), Vec<3>::zero());
  return shape;
}

inline Shape<3> solid_half_space(Vec<3> normal, float offset) {
  Shape<3> shape{};
  shape.kind = ShapeKind::kHalfSpace;
  shape.normal = normal;
  shape.offset = offset;
  return shape;
}

/// A hull of points in general position, all of them corners: its faces are triangles.
inline Shape<3> solid_hull(const std::vector<Vec<3>>& points, Polyhedra& pools) {
  Polyhedron record{1, static_cast<std::uint32_t>(pools.vertices.size()),
                    0, static_cast<std::uint32_t>(pools.faces.size()),
                    0, static_cast<std::uint32_t>(pools.edges.size()),
                    0};
  for (const Vec<3>& point : points) pools.vertices.push_back({point, 0});
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> edge_of;
  const auto n = static_cast<std::uint32_t>(points.size());
  std::uint32_t faces = 0;
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j)
      for (std::uint32_t k = 0; k < n; ++k) {
        if (i >= j || i >= k || j == k) continue;
        const Vec<3> normal = cross(points[j] - points[i], points[k] - points[i]);
        bool outside = true;
        for (std::uint32_t l = 0; l < n && outside; ++l)
          outside = l == i || l == j || l == k || dot(normal, points[l] - points[i]) < 0.0f;
        if (!outside) continue;
        const Vec<3> unit = normalized_or(normal, Vec<3>::zero());
        const std::uint32_t corner[3] = {i, j, k};
        std::uint32_t half_edge[3];
        for (int e = 0; e < 3; ++e) {
          const std::uint32_t from = corner[e], to = corner[(e + 1) % 3];
          auto found = edge_of.find({from, to});
          if (found == edge_of.end()) {
            const std::uint32_t next = record.edge_count;
            record.edge_count += 2;
            pools.edges.push_back({from, next + 1, 0, 0});
            pools.edges.push_back({to, next, 0, 0});
            edge_of[{to, from}] = next + 1;
            found = edge_of.insert({{from, to}, next}).first;
          }
          half_edge[e] = found->second;
        }
        for (int e = 0; e < 3; ++e) {
          PolyhedronEdge& edge = pools.edges[record.first_edge + half_edge[e]];
          edge.next = half_edge[(e + 1) % 3];
          edge.face = faces;
        }
        pools.faces.push_back({unit, dot(unit, points[i]), half_edge[0]});
        ++faces;
      }
  record.face_count = faces;
  record.vertex_count = n;
  Shape<3> shape = solid_ball(0.0f);
  shape.kind = ShapeKind::kHull;
  shape.rotation = identity_rotation<3>();
  for (const Vec<3>& point : points)
    for (int i = 0; i < 3; ++i) shape.half[i] = std::max(shape.half[i], std::abs(point[i]));
  shape.polyhedron = static_cast<std::uint32_t>(pools.records.size());
  pools.records.push_back(record);
  return shape;
}

/// Points on an ellipsoid, so that each is a corner.
inline std::vector<Vec<3>> random_corners(std::mt19937& random, int count, Vec<3> half) {
  std::vector<Vec<3>> points;
  while (static_cast<int>(points.size()) < count) {
    const Vec<3> raw = random_vector(random, 1.0f);
    const float size = length(raw);
    if (size < 0.1f || size > 1.0f) continue;
    points.push_back({{half[0] * raw[0] / size, half[1] * raw[1] / size, half[2] * raw[2] / size}});
  }
  return points;
}

using WideVec = std::array<double, 3>;
inline WideVec wide(const Vec<3>& v) {
  return {double{v[0]}, double{v[1]}, double{v[2]}};
}
inline WideVec minus(const WideVec& a, const WideVec& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline WideVec plus(const WideVec& a, double s, const WideVec& b) {
  return {a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]};
}
inline double wide_dot(const WideVec& a, const WideVec& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline WideVec wide_cross(const WideVec& a, const WideVec& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double wide_length(const WideVec& a) {
  return std::sqrt(wide_dot(a, a));
}

/// A core as corners, edges and triangles, in double precision.
struct WideCore {
  std::vector<WideVec> points;
  std::vector<std::pair<WideVec, WideVec>> edges;
  std::vector<std::array<WideVec, 3>> triangles;
};

inline WideCore wide_core(const Core<3>& core) {
  WideCore result;
  for (std::uint32_t i = 0; i < core.count; ++i) result.points.push_back(wide(core.vertices[i]));
  if (core.count == 2) result.edges = {{result.points[0], result.points[1]}};
  for (std::uint32_t e = 0; e < core.edge_count; e += 2)
    result.edges.push_back(
        {result.points[core.edges[e].origin], result.points[core.edges[e + 1].origin]});
  for (std::uint32_t f = 0; f < core.face_count; ++f) {
    const std::uint32_t first = core.faces[f].edge;
    std::uint32_t e = core.edges[first].next;
    for (; core.edges[e].next != first; e = core.edges[e].next)
      result.triangles.push_back({result.points[core.edges[first].origin],
                                  result.points[core.edges[e].origin],
                                  result.points[core.edges[core.edges[e].next].origin]});
  }
  return result;
}

inline double wide_to_edge(const WideVec& p, const std::pair<WideVec, WideVec>& edge) {
  const WideVec span = minus(edge.second, edge.first);
  const double square = wide_dot(span, span);
  const double t =
      square > 0 ? std::clamp(wide_dot(minus(p, edge.first), span) / square, 0.0, 1.0) : 0.0;
  return wide_length(minus(p, plus(edge.first, t, span)));
}

inline double wide_to_triangle(const WideVec& p, const std::array<WideVec, 3>& t) {
  const WideVec normal = wide_cross(minus(t[1], t[0]), minus(t[2], t[0]));
  bool inside = true;
  double nearest = 1e300;
  for (std::size_t i = 0; i < 3; ++i) {
    const WideVec& from = t[i];
    const WideVec& to = t[(i + 1) % 3];
    if (wide_dot(wide_cross(minus(to, from), normal), minus(p, from)) > 0) inside = false;
    nearest = std::min(nearest, wide_to_edge(p, {from, to}));
  }
  if (!inside) return nearest;
  return std::abs(wide_dot(normal, minus(p, t[0]))) / wide_length(normal);
}

inline double wide_between_edges(const std::pair<WideVec, WideVec>& a,
                                 const std::pair<WideVec, WideVec>& b) {
  double nearest = std::min({wide_to_edge(a.first, b), wide_to_edge(a.second, b),
                             wide_to_edge(b.first, a), wide_to_edge(b.second, a)});
  const WideVec u = minus(a.second, a.first), v = minus(b.second, b.first);
  const WideVec n = wide_cross(u, v), w = minus(b.first, a.first);
  const double square = wide_dot(n, n);
  if (square < 1e-24) return nearest;
  const double s = wide_dot(wide_cross(w, v), n) / square;
  const double t = wide_dot(wide_cross(w, u), n) / square;
  if (s < 0 || s > 1 || t < 0 || t > 1) return nearest;
  return std::min(nearest, std::abs(wide_dot(w, n)) / std::sqrt(square));
}

/// The largest separation over all axes; negative for crossing cores, and then the depth.
inline double wide_axis_separation(const WideCore& a, const WideCore& b) {
  double best = -1e300;
  const auto offer = [&](const WideVec& axis) {
    const double size = wide_length(axis);
    if (size < 1e-9) return;
    double low_a = 1e300, high_a = -1e300, low_b = 1e300, high_b = -1e300;
    for (const WideVec& p : a.points) {
      low_a = std::min(low_a, wide_dot(p, axis) / size);
      high_a = std::max(high_a, wide_dot(p, axis) / size);
    }
    for (const WideVec& p : b.points) {
      low_b = std::min(low_b, wide_dot(p, axis) / size);
      high_b = std::max(high_b, wide_dot(p, axis) / size);
    }
    best = std::max({best, low_b - high_a, low_a - high_b});
  };
  for (const WideCore* core : {&a, &b})
    for (const auto& t : core->triangles) offer(wide_cross(minus(t[1], t[0]), minus(t[2], t[0])));
  for (const auto& e : a.edges)
    for (const auto& f : b.edges)
      offer(wide_cross(minus(e.second, e.first), minus(f.second, f.first)));
  return best;
}

/// Distance of the cores, or minus their depth.
inline double wide_separation(const WideCore& a, const WideCore& b) {
  const bool solid = !a.triangles.empty() || !b.triangles.empty();
  const double axis = wide_axis_separation(a, b);
  if (solid && axis < 0) return axis;
  double nearest = 1e300;
  for (const WideVec& p : a.points) {
    for (const WideVec& q : b.points) nearest = std::min(nearest, wide_length(minus(p, q)));
    for (const auto& e : b.edges) nearest = std::min(nearest, wide_to_edge(p, e));
    for (const auto& t : b.triangles) nearest = std::min(nearest, wide_to_triangle(p, t));
  }
  for (const WideVec& p : b.points) {
    for (const auto& e : a.edges) nearest = std::min(nearest, wide_to_edge(p, e));
    for (const auto& t : a.triangles) nearest = std::min(nearest, wide_to_triangle(p, t));
  }
  for (const auto& e : a.edges)
    for (const auto& f : b.edges) nearest = std::min(nearest, wide_between_edges(e, f));
  return nearest;
}

}  // namespace cycloid::solver
