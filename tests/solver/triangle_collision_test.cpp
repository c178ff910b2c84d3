#include <vector>

#include "solver/trig.hpp"
#include "tests/solver/round_fixture.hpp"

namespace cycloid::solver {

using Corners = std::array<std::uint32_t, 3>;

/// The triangles of a surface as the solids of collision, each with the neighbours across its
/// edges.
std::vector<Solid> surface(const std::vector<Vec<3>>& vertices, const std::vector<Corners>& faces,
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

std::vector<Solid> flat(const Vec<3>& position = kZero) {
  return grid([](float, float) { return 0.0f; }, position);
}

Rod ball(float x, float y, float z, float radius) {
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
std::vector<Manifold<3>> meet(const std::vector<Solid>& triangles, const Rod& rod,
                              float margin = 0.01f) {
  return meet(triangles,
              [&](const Solid& t) { return triangle_against_rod(t, rod, rod.from, margin); });
}
std::vector<Manifold<3>> meet(const std::vector<Solid>& triangles, const Solid& solid,
                              float margin = 0.01f) {
  return meet(triangles, [&](const Solid& t) {
    return triangle_against_solid(t, solid, solid.centre, margin);
  });
}

float deepest(const std::vector<Manifold<3>>& all) {
  float separation = 1.0e30f;
  for (const Manifold<3>& m : all) separation = std::min(separation, deepest(m));
  return separation;
}

TEST(TriangleCollision, BallMeetsTheFreeSideOfAFaceAnEdgeAndACorner) {
  const auto alone = surface({{{0, 0, 0}}, {{0, 0, 1}}, {{1, 0, 0}}}, {{0, 1, 2}});
  const auto face = meet(alone, ball(0.25f, 0.4f, 0.25f, 0.5f));
  ASSERT_EQ(face.size(), 1u);
  expect_normal(face[0], 0.0f, 1.0f, 0.0f);
  EXPECT_NEAR(face[0].points[0].separation, -0.1f, 1e-6f);
  EXPECT_NEAR(face[0].points[0].anchor_a[1], -0.05f, 1e-6f);
  const auto edge = meet(alone, ball(-0.3f, 0.4f, 0.5f, 0.5f));
  ASSERT_EQ(edge.size(), 1u);
  expect_normal(edge[0], -0.6f, 0.8f, 0.0f);
  const auto corner = meet(alone, ball(-0.2f, 0.1f, -0.2f, 0.5f));
  ASSERT_EQ(corner.size(), 1u);
  expect_normal(corner[0], -2.0f / 3.0f, 1.0f / 3.0f, -2.0f / 3.0f, 1e-5f);
  EXPECT_NEAR(corner[0].points[0].separation, -0.2f, 1e-6f);
  EXPECT_NE(face[0].points[0].feature, edge[0].points[0].feature);
  EXPECT_NE(corner[0].points[0].feature, edge[0].points[0].feature);
}

TEST(TriangleCollision, WhatIsBehindIsLeftAlone) {
  const auto alone = surface({{{0, 0, 0}}, {{0, 0, 3}}, {{3, 0, 0}}}, {{0, 1, 2}});
  EXPECT_EQ(meet(alone, ball(0.5f, -0.24f, 0.5f, 0.5f)).size(), 1u);
  EXPECT_EQ(meet(alone, ball(0.5f, -0.26f, 0.5f, 0.5f)).size(), 0u);
  EXPECT_EQ(meet(alone, ball(-0.1f, -0.1f, 0.5f, 0.5f)).size(), 0u);
  EXPECT_EQ(meet(alone, make_box({{0.2f, 0.2f, 0.2f}}, {{0.5f, 0.01f, 0.5f}})).size(), 1u);
  EXPECT_EQ(meet(alone, make_box({{0.2f, 0.2f, 0.2f}}, {{0.5f, -0.01f, 0.5f}})).size(), 0u);
  // A capsule whose middle is behind, though one end sticks out in front.
  EXPECT_EQ(meet(alone, Rod{{{0.5f, 0.5f, 0.5f}}, {{0.5f, -1.5f, 0.5f}}, 0.2f}).size(), 0u);
  const auto pierced = meet(alone, Rod{{{0.5f, 1.5f, 0.5f}}, {{0.5f, -0.5f, 0.5f}}, 0.2f});
  ASSERT_EQ(pierced.size(), 1u);
  EXPECT_NEAR(deepest(pierced), -0.7f, 1e-6f);
}

TEST(TriangleCollision, FlatFloorIsOnePlaneForAllThatSlidesOverIt) {
  // Not at the origin, so that the floor's own edges are rounded.
  const Vec<3> position = {{0.1f, 0.0f, -0.7f}};
  const auto floor = flat(position);
  const auto check = [](const std::vector<Manifold<3>>& all, float separation, int i) {
    ASSERT_FALSE(all.empty()) << i;
    ASSERT_NEAR(deepest(all), separation, 1e-5f) << i;
    for (const Manifold<3>& m : all) {
      expect_normal(m, 0.0f, 1.0f, 0.0f, 1e-5f);
      for (std::uint32_t k = 0; k < m.point_count; ++k)
        ASSERT_NEAR(m.points[k].anchor_a[1], 0.5f * m.points[k].separation, 1e-5f) << i;
    }
  };
  Draw draw;
  int capsules = 0;
  for (int i = 0; i < 1000; ++i) {
    // Every fourth one on the line of an edge, exactly.
    const float u = i % 4 == 0 ? 0.5f * static_cast<float>(i / 4 % 7 + 1) : draw.within(0.1f, 3.9f);
    const float v = i % 8 == 0 ? 1.0f : draw.within(0.1f, 1.9f);
    const Vec<3> at = position + Vec<3>{{u, 0.0f, v}};
    const float depth = draw.within(-0.005f, 0.05f);
    check(meet(floor, ball(at[0], 0.3f - depth, at[2], 0.3f)), -depth, i);
    const Vec<3> spread = {{draw.within(-1.0f, 1.0f), i % 2 == 0 ? 0.0f : draw.within(-0.1f, 0.1f),
                            draw.within(-1.0f, 1.0f)}};
    const Vec<3> core = at + Vec<3>{{0.0f, 0.3f - depth + abs(spread[1]), 0.0f}};
    const auto capsule = meet(floor, Rod{core - spread, core + spread, 0.3f});
    const auto inside = [&](const Vec<3>& end) {
      const Vec<3> local = end - position;
      return local[0] > 0.0f && local[0] < 4.0f && local[2] > 0.0f && local[2] < 2.0f;
    };
    if (inside(core - spread) && inside(core + spread)) {
      check(capsule, -depth, i);
      ++capsules;
    }
    const float half_turn = draw.within(0.0f, 3.0f);
    const Rotation<3> turn = {{0.0f, std::sin(half_turn), 0.0f, std::cos(half_turn)}};
    const Vec<3> half = {{0.4f, 0.2f, 0.3f}};
    check(meet(floor, make_box(half, at + Vec<3>{{0.0f, 0.2f - depth, 0.0f}}, turn)), -depth, i);
  }
  EXPECT_GT(capsules, 300);
}

// A ridge along z at x = 2, whose slopes fall by `slope`.
std::vector<Solid> ridge(float slope) {
  return grid([=](float x, float) { return -slope * std::abs(x - 2.0f); });
}

TEST(TriangleCollision, BallOverARidgeIsAlwaysMetAtItsTrueDistance) {
  for (const float slope : {0.0005f, 0.002f, 0.1f, 1.0f, 5.0f}) {
    const auto triangles = ridge(slope);
    const float steep = std::sqrt(1.0f + slope * slope);
    for (int i = -500; i <= 500; ++i)
      for (const float z : {0.5f, 1.0f, 1.3f}) {
        // Round the ridge at a distance of 0.25 m, and along the slopes.
        const float turn = 0.002f * static_cast<float>(i);
        const float arc = std::atan(slope);
        const float angle = std::clamp(turn * 2.0f, -arc, arc);
        const float beyond = turn * 2.0f - angle;
        const float x = 2.0f + 0.25f * std::sin(angle) + 0.3f * beyond / steep;
        const float y = 0.25f * std::cos(angle) - 0.3f * std::abs(beyond) * slope / steep;
        const auto all = meet(triangles, ball(x, y, z, 0.25f));
        ASSERT_FALSE(all.empty()) << slope << " " << i;
        ASSERT_NEAR(deepest(all), 0.0f, 2e-4f * slope + 1e-5f) << slope << " " << i;
        for (const Manifold<3>& m : all) {
          ASSERT_NEAR(m.normal[0], std::sin(angle), 1.5e-3f) << slope << " " << i;
          ASSERT_NEAR(m.normal[2], 0.0f, 1e-4f);
        }
      }
  }
}

// Whatever the surface, what is nearest is met: no gap at any edge or corner.
TEST(TriangleCollision, BallOverAnUnevenSurfaceIsAlwaysMet) {
  Draw draw;
  int met = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const float rough = draw.within(0.0f, 1.0f);
    const auto triangles = grid([&](float, float) { return draw.within(0.0f, rough); });
    for (int i = 0; i < 300; ++i) {
      const Vec<3> centre = {
          {draw.within(0.2f, 3.8f), draw.within(0.0f, 1.5f), draw.within(0.2f, 1.8f)}};
      float distance = 1.0e30f;
      bool above = true;
      for (const Solid& t : triangles) {
        const Rod point = {centre, centre, 0.0f};
        const float height = dot(t.normals[0], centre - t.vertices[0]);
        if (clip_to_face(t, 0, point, 0.0f).to > 0.0f) distance = std::min(distance, abs(height));
        for (std::uint32_t e = 0; e < 6; e += 2)
          distance = std::min(distance, nearest_to_edge(t, e, point).distance);
        const auto side = [&](int a, int b) {
          const Vec<3> p = t.vertices[static_cast<std::size_t>(a)] - centre;
          const Vec<3> q = t.vertices[static_cast<std::size_t>(b)] - centre;
          return p[2] * q[0] - p[0] * q[2];
        };
        const bool covers = side(0, 1) >= 0.0f && side(1, 2) >= 0.0f && side(2, 0) >= 0.0f;
        if (covers && height < 0.0f) above = false;
      }
      if (!above || distance > 0.4f) continue;
      ++met;
      const auto all = meet(triangles, ball(centre[0], centre[1], centre[2], 0.4f));
      ASSERT_FALSE(all.empty()) << trial << " " << i << " " << distance;
      ASSERT_NEAR(deepest(all), distance - 0.4f, 1e-5f) << trial << " " << i;
    }
  }
  EXPECT_GT(met, 2000);
}

TEST(TriangleCollision, BallInAValleyTouchesBothSlopesAlongTheirNormals) {
  const auto triangles = grid([](float x, float) { return 0.75f * std::abs(x - 2.0f); });
  // 0.5 m from both planes.
  const auto all = meet(triangles, ball(2.0f, 0.625f, 0.5f, 0.5f));
  bool left = false;
  bool right = false;
  for (const Manifold<3>& m : all) {
    EXPECT_NEAR(m.points[0].separation, 0.0f, 1e-6f);
    EXPECT_NEAR(std::abs(m.normal[0]), 0.6f, 1e-6f);
    left = left || m.normal[0] > 0.0f;
    right = right || m.normal[0] < 0.0f;
  }
  EXPECT_TRUE(left && right);
}

TEST(TriangleCollision, BoxOnARidgeLiesOnItsLine) {
  const auto all = meet(ridge(1.0f), make_box({{0.5f, 0.2f, 0.4f}}, {{2.1f, 0.19f, 1.0f}}));
  ASSERT_FALSE(all.empty());
  EXPECT_NEAR(deepest(all), -0.01f, 1e-6f);
  float front = 0.0f;
  float back = 2.0f;
  for (const Manifold<3>& m : all) {
    expect_normal(m, 0.0f, 1.0f, 0.0f, 1e-6f);
    for (std::uint32_t k = 0; k < m.point_count; ++k) {
      front = std::max(front, m.points[k].anchor_a[2]);
      back = std::min(back, m.points[k].anchor_a[2]);
    }
  }
  EXPECT_NEAR(front, 1.4f, 1e-4f);
  EXPECT_NEAR(back, 0.6f, 1e-4f);
}

TEST(TriangleCollision, BoxInAValleyRestsOnItsEdges) {
  const auto triangles = grid([](float x, float) { return 0.5f * std::abs(x - 2.0f); });
  // Its lower edges, 0.4 m from the middle, are 0.01 m above the slopes.
  const auto all = meet(triangles, make_box({{0.4f, 0.3f, 0.3f}}, {{2.0f, 0.51f, 1.0f}}), 0.02f);
  ASSERT_GE(all.size(), 2u);
  for (const Manifold<3>& m : all) {
    EXPECT_NEAR(std::abs(m.normal[0]), 0.5f / std::sqrt(1.25f), 1e-6f);
    EXPECT_NEAR(deepest(m), 0.01f / std::sqrt(1.25f), 1e-5f);
  }
}

TEST(TriangleCollision, CornerOfABoxOnTheMiddleOfATriangle) {
  const auto triangles = flat();
  const float c = std::cos(0.3926991f);
  const float s = std::sin(0.3926991f);
  const Rotation<3> turn =
      compose(Rotation<3>{{s, 0.0f, 0.0f, c}}, Rotation<3>{{0.0f, 0.0f, s, c}});
  const Solid box = make_box({{0.2f, 0.2f, 0.2f}}, {{1.3f, 0.33f, 0.6f}}, turn);
  float low = 1.0f;
  for (std::size_t i = 0; i < 8; ++i) low = std::min(low, box.vertices[i][1]);
  const auto all = meet(triangles, box);
  ASSERT_EQ(all.size(), 1u);
  expect_normal(all[0], 0.0f, 1.0f, 0.0f);
  EXPECT_NEAR(deepest(all), low, 1e-6f);
}

TEST(TriangleCollision, EdgeOfABoxAcrossAFreeEdgeMeetsInOnePoint) {
  const auto alone = surface({{{-2, 0, 0}}, {{2, 0, 0}}, {{0, 0, -2}}}, {{0, 1, 2}});
  // The box's lower edge runs along (0, -1, 1) / sqrt 2 through (0, 0.01, 0.01).
  const float half_turn = 0.3926991f;
  const Rotation<3> tilt = {{std::sin(half_turn), 0.0f, 0.0f, std::cos(half_turn)}};
  const float eighth = 0.3926991f;
  const Rotation<3> roll = {{0.0f, 0.0f, std::sin(eighth), std::cos(eighth)}};
  const float reach = 0.5f * std::sqrt(2.0f) + 0.005f * std::sqrt(2.0f);
  const Vec<3> out = {{0.0f, reach / std::sqrt(2.0f), reach / std::sqrt(2.0f)}};
  const auto all = meet(alone, make_box({{0.5f, 0.5f, 1.0f}}, out, compose(tilt, roll)));
  ASSERT_EQ(all.size(), 1u);
  ASSERT_EQ(all[0].point_count, 1u);
  expect_normal(all[0], 0.0f, 0.7071068f, 0.7071068f, 1e-5f);
  EXPECT_NEAR(all[0].points[0].separation, 0.005f * std::sqrt(2.0f), 1e-5f);
  EXPECT_NEAR(all[0].points[0].anchor_a[2], 0.0025f, 1e-4f);
}

// The box stands before a step of 0.3 m and grazes its side: nothing lifts it onto the step.
TEST(TriangleCollision, BoxAgainstAStepIsNotLiftedOntoIt) {
  const std::vector<Vec<3>> corners = {{{0, 0.3f, -2}}, {{0, 0.3f, 2}}, {{4, 0.3f, 2}},
                                       {{4, 0.3f, -2}}, {{0, 0, -2}},   {{0, 0, 2}}};
  const auto step = surface(corners, {{0, 1, 2}, {0, 2, 3}, {0, 4, 5}, {0, 5, 1}});
  for (const float tilt : {0.0f, 0.02f, -0.02f, 0.2f}) {
    const Rotation<3> turn = {{0.0f, 0.0f, std::sin(0.5f * tilt), std::cos(0.5f * tilt)}};
    Solid box = make_box({{0.5f, 0.5f, 0.5f}}, {{-0.5f, 0.52f, 0.1f}}, turn);
    float right = -1.0f;
    for (std::size_t i = 0; i < 8; ++i)
      if (box.vertices[i][1] < 0.3f) right = std::max(right, box.vertices[i][0]);
    box = make_box({{0.5f, 0.5f, 0.5f}}, {{-0.5f + 0.001f - right, 0.52f, 0.1f}}, turn);
    const auto all = meet(step, box, 0.02f);
    for (const Manifold<3>& m : all) {
      EXPECT_LT(m.normal[0], -0.9f) << tilt;
      EXPECT_GT(deepest(m), -0.1f) << tilt;
    }
    if (tilt <= 0.0f) {
      EXPECT_FALSE(all.empty()) << tilt;
    }
  }
}

TEST(TriangleCollision, CapsuleOnARidgeAcrossItLeansOnIt) {
  // Along the edge: two points; across it one, with the normal of both.
  const auto along = meet(ridge(1.0f), Rod{{{2.0f, 0.2f, 0.6f}}, {{2.0f, 0.2f, 1.4f}}, 0.2f});
  ASSERT_GE(along.size(), 2u);
  for (const Manifold<3>& m : along) {
    expect_normal(m, 0.0f, 1.0f, 0.0f, 1e-5f);
    EXPECT_NEAR(deepest(m), 0.0f, 1e-6f);
  }
  const auto across = meet(ridge(1.0f), Rod{{{1.5f, 0.3f, 0.5f}}, {{2.5f, 0.1f, 0.5f}}, 0.2f});
  ASSERT_EQ(across.size(), 2u);
  const float steep = std::sqrt(1.04f);
  for (const Manifold<3>& m : across) {
    ASSERT_EQ(m.point_count, 1u);
    expect_normal(m, 0.2f / steep, 1.0f / steep, 0.0f, 1e-5f);
    EXPECT_NEAR(m.points[0].separation, 0.2f / steep - 0.2f, 1e-6f);
  }
}

TEST(TriangleCollision, TouchingDegeneratelyIsDefinedAtAllSizes) {
  for (const float size : {1e-3f, 1.0f, 1e3f}) {
    const auto alone = surface({{{0, 0, 0}}, {{0, 0, size}}, {{size, 0, 0}}}, {{0, 1, 2}});
    for (const Vec<3>& at : {Vec<3>{{0.2f, 0.0f, 0.2f}}, Vec<3>{{0.0f, 0.0f, 0.5f}},
                             Vec<3>{{0.0f, 0.0f, 0.0f}}, Vec<3>{{0.5f, 0.0f, 0.5f}}}) {
      const Rod point = {size * at, size * at, 0.1f * size};
      const auto met = meet(alone, point);
      ASSERT_EQ(met.size(), 1u);
      expect_normal(met[0], 0.0f, 1.0f, 0.0f);
      EXPECT_NEAR(deepest(met), -0.1f * size, 1e-5f * size);
      const Vec<3> along = {{0.0f, 0.0f, 0.3f * size}};
      const auto lying = meet(alone, Rod{size * at, size * at + along, 0.1f * size});
      ASSERT_EQ(lying.size(), 1u);
      expect_normal(lying[0], 0.0f, 1.0f, 0.0f);
      meet(alone, make_box({{size, size, size}}, size * at));
    }
  }
}

TEST(TriangleCollision, FeaturesAreUniqueAndPersistUnderSmallMotion) {
  Draw draw;
  const auto triangles = ridge(0.3f);
  int compared = 0;
  int changed = 0;
  for (int i = 0; i < 500; ++i) {
    const Vec<3> at = {
        {draw.within(0.5f, 3.5f), draw.within(-0.4f, 0.5f), draw.within(0.3f, 1.7f)}};
    const Rotation<3> turn = draw.rotation();
    const Vec<3> shift = draw.vector(1e-5f);
    const Solid box = make_box({{0.4f, 0.2f, 0.3f}}, at, turn);
    const Solid moved = make_box({{0.4f, 0.2f, 0.3f}}, at + shift, turn);
    for (const Solid& t : triangles) {
      const Manifold<3> a = triangle_against_solid(t, box, at, 0.02f);
      const Manifold<3> b = triangle_against_solid(t, moved, at + shift, 0.02f);
      ASSERT_TRUE(is_finite(a));
      for (std::uint32_t j = 0; j < a.point_count; ++j)
        for (std::uint32_t k = 0; k < j; ++k) ASSERT_NE(a.points[j].feature, a.points[k].feature);
      if (a.point_count == 0 || a.point_count != b.point_count) continue;
      ++compared;
      for (std::uint32_t k = 0; k < a.point_count; ++k)
        changed += a.points[k].feature != b.points[k].feature;
    }
  }
  EXPECT_GT(compared, 300);
  EXPECT_LE(changed, compared / 100);
}

}  // namespace cycloid::solver
