#include "tests/solver/surface_fixture.hpp"

namespace cycloid::solver {

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

// It leads past a free edge: one end is over the triangle, behind it, and the axis goes through the
// plane beside it.
TEST(TriangleCollision, CapsuleThatPassesBesideIsApart) {
  const auto alone = surface({{{0, 0, 0}}, {{0, 0, 1}}, {{1, 0, 0}}}, {{0, 1, 2}});
  // The line x + y = -0.1 at z = 0.5 is 0.1 / sqrt 2 from the edge x = 0.
  const Vec<3> from = {{-1.1f, 1.0f, 0.5f}};
  const Vec<3> to = {{0.3f, -0.4f, 0.5f}};
  EXPECT_TRUE(meet(alone, Rod{from, to, 0.05f}).empty());
  const auto near = meet(alone, Rod{from, to, 0.1f});
  EXPECT_TRUE(near.empty()) << "the edge is on the far side: towards the back";
}

TEST(TriangleCollision, CapsuleThroughATriangleLeavesItOverTheNearestEdge) {
  const auto alone = surface({{{0, 0, 0}}, {{0, 0, 1}}, {{1, 0, 0}}}, {{0, 1, 2}});
  // Leans 0.6 : 0.8 and goes through the plane at x = 0.05: 0.04 from the edge x = 0.
  const Rod rod = {{{0.8f, 1.0f, 0.4f}}, {{-0.4f, -0.6f, 0.4f}}, 0.1f};
  const auto all = meet(alone, rod);
  ASSERT_EQ(all.size(), 1u);
  ASSERT_EQ(all[0].point_count, 1u);
  expect_normal(all[0], -0.8f, 0.6f, 0.0f, 1e-5f);
  EXPECT_NEAR(deepest(all), -0.14f, 1e-5f);
}

// A board that leans over the edge x = 0 from outside: its middle is in front of the triangle and
// its lower end far behind it, and it is apart along its own face, which looks to the front.
TEST(TriangleCollision, BoxThatReachesBehindIsApart) {
  const auto alone = surface({{{0, 0, 0}}, {{0, 0, 1}}, {{1, 0, 0}}}, {{0, 1, 2}});
  const Rotation<3> turn = {{0.0f, 0.0f, std::sqrt(0.2f), std::sqrt(0.8f)}};
  for (const float gap : {-0.005f, 0.001f, 0.005f}) {
    const float across = 0.1f + gap;
    const Vec<3> middle = {{-0.6f * across - 0.8f * 0.3f, -0.8f * across + 0.6f * 0.3f, 0.4f}};
    const auto all = meet(alone, make_box({{0.1f, 1.0f, 0.3f}}, middle, turn));
    if (gap > 0.0f)
      EXPECT_GT(deepest(all), 0.0f) << gap;
    else
      EXPECT_TRUE(all.empty()) << "out to the back, which is shorter by far";
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
      const Manifold<3> a = triangle_against_solid(t, box, 0.02f);
      const Manifold<3> b = triangle_against_solid(t, moved, 0.02f);
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
