#pragma once

#include <vector>

#include "tests/solver/round_fixture.hpp"

namespace cycloid::solver {

using Corners = std::array<std::uint32_t, 3>;

/// The triangles of a surface as the solids of collision, each with the neighbours across its
/// edges.
inline std::vector<Solid> surface(const std::vector<Vec<3>>& vertices,
                                  const std::vector<Corners>& faces,
                                  const Vec<3>& position = kZero) {
  std::vector<Solid> solids;
  for (const Corners& face : faces) {
    Shape<3> shape;
    shape.kind = ShapeKind::kTriangle;
    for (std::size_t i = 0; i < 3; ++i) {
      shape.vertices[i] = vertices[face[i]];
      shape.vertices[3 + i] = kZero;
      for (const Corners& other : faces)
        for (std::size_t j = 0; j < 3; ++j)
          if (other[j] == face[(i + 1) % 3] && other[(j + 1) % 3] == face[i]) {
            shape.ghosts |= 1u << i;
            shape.vertices[3 + i] = vertices[other[(j + 2) % 3]];
          }
    }
    const Vec<3> normal =
        cross(shape.vertices[1] - shape.vertices[0], shape.vertices[2] - shape.vertices[0]);
    shape.normal = (1.0f / length(normal)) * normal;
    place(shape, {}, identity_rotation<3>(), position, solids.emplace_back());
  }
  return solids;
}

/// A grid of 8 x 2 triangles of a width of 1 m from the origin; y is a function of x and z.
template <class F>
std::vector<Solid> grid(F height, const Vec<3>& position = kZero) {
  std::vector<Vec<3>> vertices;
  std::vector<Corners> faces;
  for (int x = 0; x <= 4; ++x)
    for (int z = 0; z <= 2; ++z) {
      const auto u = static_cast<float>(x);
      const auto v = static_cast<float>(z);
      vertices.push_back({{u, height(u, v), v}});
    }
  for (std::uint32_t x = 0; x < 4; ++x)
    for (std::uint32_t z = 0; z < 2; ++z) {
      const std::uint32_t at = 3 * x + z;
      faces.push_back({at, at + 1, at + 4});
      faces.push_back({at, at + 4, at + 3});
    }
  return surface(vertices, faces, position);
}

inline std::vector<Solid> flat(const Vec<3>& position = kZero) {
  return grid([](float, float) { return 0.0f; }, position);
}

inline Rod ball(float x, float y, float z, float radius) {
  return {{{x, y, z}}, {{x, y, z}}, radius};
}

template <class F>
std::vector<Manifold<3>> meet(const std::vector<Solid>& triangles, F manifold) {
  std::vector<Manifold<3>> all;
  for (const Solid& triangle : triangles) {
    all.push_back(manifold(triangle));
    EXPECT_TRUE(is_finite(all.back()));
    if (all.back().point_count == 0) all.pop_back();
  }
  return all;
}
inline std::vector<Manifold<3>> meet(const std::vector<Solid>& triangles, const Rod& rod,
                                     float margin = 0.01f) {
  return meet(triangles, [&](const Solid& t) { return triangle_against_rod(t, rod, margin); });
}
inline std::vector<Manifold<3>> meet(const std::vector<Solid>& triangles, const Solid& solid,
                                     float margin = 0.01f) {
  return meet(triangles, [&](const Solid& t) { return triangle_against_solid(t, solid, margin); });
}

inline float deepest(const std::vector<Manifold<3>>& all) {
  float separation = 1.0e30f;
  for (const Manifold<3>& m : all) separation = std::min(separation, deepest(m));
  return separation;
}

// A ridge along z at x = 2, whose slopes fall by `slope`.
inline std::vector<Solid> ridge(float slope) {
  return grid([=](float x, float) { return -slope * std::abs(x - 2.0f); });
}

}  // namespace cycloid::solver
