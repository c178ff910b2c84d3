#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "solver/collision/collide.hpp"
#include "solver/collision/solid.hpp"
#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

inline Shape<3> solid_box(float x, float y, float z) {
  Shape<3> shape;
  shape.kind = ShapeKind::kBox;
  shape.vertices[0] = Vec<3>::zero();
  shape.half = {{x, y, z}};
  shape.rotation = identity_rotation<3>();
  return shape;
}

inline const Shape<3> kCube = solid_box(0.5f, 0.5f, 0.5f);
inline const double kRight = std::acos(0.0);  ///< A right angle, rad.

inline Manifold<3> meet(const Shape<3>& a, const Pose<3>& pose_a, const Shape<3>& b,
                        const Pose<3>& pose_b, float margin = 0.02f) {
  return collide(a, pose_a, b, pose_b, margin, {});
}

inline Rotation<3> turn_about(const Vec<3>& axis, double angle) {
  const Vec<3> unit = normalized_or(axis, Vec<3>{{1.0f, 0.0f, 0.0f}});
  const auto s = static_cast<float>(std::sin(0.5 * angle));
  return {{s * unit[0], s * unit[1], s * unit[2], static_cast<float>(std::cos(0.5 * angle))}};
}

inline Pose<3> at(float x, float y, float z) {
  return {{{x, y, z}}, identity_rotation<3>()};
}

inline Solid placed(const Shape<3>& shape, const Pose<3>& pose, const Polyhedra& polyhedra = {}) {
  Solid solid;
  place(shape, polyhedra, pose.rotation, pose.position, solid);
  return solid;
}

/// A convex polyhedron as one record of a pool, by trying every plane through three points.
struct TestHull {
  Polyhedra pool;
  Shape<3> shape;
};

inline std::set<std::vector<std::uint32_t>> faces_of(const std::vector<Vec<3>>& points) {
  std::set<std::vector<std::uint32_t>> faces;
  const auto n = static_cast<std::uint32_t>(points.size());
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j)
      for (std::uint32_t k = 0; k < n; ++k) {
        if (i == j || j == k || i == k) continue;
        const Vec<3> across = cross(points[j] - points[i], points[k] - points[i]);
        if (length(across) < 1.0e-9f) continue;
        const Vec<3> normal = (1.0f / length(across)) * across;
        std::vector<std::uint32_t> on;
        bool outside = false;
        for (std::uint32_t m = 0; m < n; ++m) {
          const float height = dot(normal, points[m] - points[i]);
          outside |= height > 1.0e-5f;
          if (std::abs(height) <= 1.0e-5f) on.push_back(m);
        }
        if (outside) continue;
        Vec<3> middle = Vec<3>::zero();
        for (const std::uint32_t m : on)
          middle += (1.0f / static_cast<float>(on.size())) * points[m];
        const Vec<3> first = points[on[0]] - middle;
        const auto angle = [&](std::uint32_t m) {
          const Vec<3> arm = points[m] - middle;
          const float turn = std::atan2(dot(cross(normal, first), arm), dot(first, arm));
          return turn < 0.0f ? turn + 6.2831853f : turn;
        };
        std::sort(on.begin() + 1, on.end(),
                  [&](std::uint32_t p, std::uint32_t q) { return angle(p) < angle(q); });
        std::rotate(on.begin(), std::min_element(on.begin(), on.end()), on.end());
        faces.insert(on);
      }
  return faces;
}

inline TestHull hull_of(const std::vector<Vec<3>>& points) {
  TestHull hull;
  Polyhedra& pool = hull.pool;
  for (const Vec<3>& point : points) pool.vertices.push_back({point, 0});
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> edges;
  for (const std::vector<std::uint32_t>& corners : faces_of(points)) {
    const auto face = static_cast<std::uint32_t>(pool.faces.size());
    std::vector<std::uint32_t> loop;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const std::uint32_t from = corners[k];
      const std::uint32_t to = corners[(k + 1) % corners.size()];
      if (!edges.contains({from, to})) {
        const auto e = static_cast<std::uint32_t>(pool.edges.size());
        edges[{from, to}] = e;
        edges[{to, from}] = e + 1;
        pool.edges.push_back({from, e + 1, 0, 0});
        pool.edges.push_back({to, e, 0, 0});
      }
      loop.push_back(edges[{from, to}]);
      pool.edges[loop.back()].face = face;
    }
    for (std::size_t k = 0; k < loop.size(); ++k)
      pool.edges[loop[k]].next = loop[(k + 1) % loop.size()];
    const Vec<3> p = points[corners[0]];
    const Vec<3> across = cross(points[corners[1]] - p, points[corners[2]] - p);
    const Vec<3> normal = (1.0f / length(across)) * across;
    pool.faces.push_back({normal, dot(normal, p), *std::min_element(loop.begin(), loop.end())});
  }
  for (std::size_t e = pool.edges.size(); e-- > 0;)
    pool.vertices[pool.edges[e].origin].edge = static_cast<std::uint32_t>(e);
  pool.records.push_back({1, 0, static_cast<std::uint32_t>(points.size()), 0,
                          static_cast<std::uint32_t>(pool.faces.size()), 0,
                          static_cast<std::uint32_t>(pool.edges.size())});
  hull.shape = solid_box(0.0f, 0.0f, 0.0f);
  hull.shape.kind = ShapeKind::kHull;
  hull.shape.polyhedron = 0;
  return hull;
}

/// Points on a sphere, none too near another.
inline TestHull ball_hull(std::size_t count, float radius, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  std::vector<Vec<3>> points;
  while (points.size() < count) {
    const Vec<3> direction =
        normalized_or(Vec<3>{{normal(random), normal(random), normal(random)}}, Vec<3>::zero());
    bool near = false;
    for (const Vec<3>& point : points) near |= length(radius * direction - point) < 0.25f * radius;
    if (!near) points.push_back(radius * direction);
  }
  return hull_of(points);
}

/// How far b is from a along the axis (not necessarily unit); the larger of both directions.
struct AxisGap {
  double along[3];

  double between(const Solid& a, const Solid& b) const {
    const double norm = std::hypot(along[0], along[1], along[2]);
    double low[2] = {1e30, 1e30};
    double high[2] = {-1e30, -1e30};
    for (int s = 0; s < 2; ++s) {
      const Solid& solid = s == 0 ? a : b;
      for (std::uint32_t i = 0; i < solid.vertex_count; ++i) {
        double x = 0.0;
        for (int k = 0; k < 3; ++k) x += along[k] * static_cast<double>(solid.vertices[i][k]);
        low[s] = std::min(low[s], x / norm);
        high[s] = std::max(high[s], x / norm);
      }
    }
    return std::max(low[1] - high[0], low[0] - high[1]);
  }
};

inline AxisGap axis_of(const Vec<3>& v) {
  return {{static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])}};
}

/// The best of all faces' normals and all pairs of edges, each tried in full.
inline double best_gap(const Solid& a, const Solid& b) {
  double best = -1e30;
  const Solid* solids[2] = {&a, &b};
  for (const Solid* solid : solids)
    for (std::uint32_t i = 0; i < solid->face_count; ++i)
      best = std::max(best, axis_of(solid->normals[i]).between(a, b));
  const auto along = [](const Solid& s, std::uint32_t e) {
    return axis_of(s.vertices[s.edges[e + 1].origin] - s.vertices[s.edges[e].origin]);
  };
  for (std::uint32_t i = 0; i < a.edge_count; i += 2)
    for (std::uint32_t j = 0; j < b.edge_count; j += 2) {
      const AxisGap u = along(a, i);
      const AxisGap v = along(b, j);
      const AxisGap w = {{u.along[1] * v.along[2] - u.along[2] * v.along[1],
                          u.along[2] * v.along[0] - u.along[0] * v.along[2],
                          u.along[0] * v.along[1] - u.along[1] * v.along[0]}};
      const double size = std::hypot(w.along[0], w.along[1], w.along[2]);
      if (size < 1e-3 * std::hypot(u.along[0], u.along[1], u.along[2]) *
                     std::hypot(v.along[0], v.along[1], v.along[2]))
        continue;
      best = std::max(best, w.between(a, b));
    }
  return best;
}

/// The distance of two solids that are apart, to 1e-7 or so, by alternating projections on the
/// Minkowski difference: the least norm that Frank-Wolfe with away steps finds is bounded from
/// below by the gap along its direction.
struct Distance {
  double least;
  double most;
};
inline Distance distance_of(const Solid& a, const Solid& b) {
  std::vector<std::array<double, 3>> corners;
  for (std::uint32_t i = 0; i < a.vertex_count; ++i)
    for (std::uint32_t j = 0; j < b.vertex_count; ++j) {
      std::array<double, 3> corner;
      for (int k = 0; k < 3; ++k)
        corner[k] = static_cast<double>(b.vertices[j][k]) - static_cast<double>(a.vertices[i][k]);
      corners.push_back(corner);
    }
  const auto inner = [](const std::array<double, 3>& p, const std::array<double, 3>& q) {
    return p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
  };
  std::vector<double> weight(corners.size(), 0.0);
  weight[0] = 1.0;
  std::array<double, 3> x = corners[0];
  Distance distance{0.0, 0.0};
  for (int step = 0; step < 3000; ++step) {
    std::size_t towards = 0;
    std::size_t away = corners.size();
    for (std::size_t i = 0; i < corners.size(); ++i) {
      if (inner(corners[i], x) < inner(corners[towards], x)) towards = i;
      if (weight[i] > 0.0 &&
          (away == corners.size() || inner(corners[i], x) > inner(corners[away], x)))
        away = i;
    }
    const double norm = std::sqrt(inner(x, x));
    distance.most = norm;
    distance.least = std::max(distance.least, inner(corners[towards], x) / std::max(norm, 1e-12));
    if (distance.most - distance.least < 1e-7) break;
    // Pairwise step: moves weight from the worst corner in use to the best one.
    std::array<double, 3> d;
    for (int k = 0; k < 3; ++k) d[k] = corners[towards][k] - corners[away][k];
    const double size = std::clamp(-inner(x, d) / std::max(inner(d, d), 1e-30), 0.0, weight[away]);
    weight[away] -= size;
    weight[towards] += size;
    for (int k = 0; k < 3; ++k) x[k] += size * d[k];
  }
  return distance;
}

}  // namespace cycloid::solver
