#include "tests/solver/manifold_3d_fixture.hpp"
#include "tests/solver/round_fixture.hpp"

namespace cycloid::solver {

static void expect_finite(const Manifold<3>& manifold) {
  ASSERT_GT(manifold.point_count, 0u);
  ASSERT_LE(manifold.point_count, 4u);
  EXPECT_NEAR(length(manifold.normal), 1.0f, 1e-5f);
  std::set<std::uint32_t> features;
  for (std::uint32_t i = 0; i < manifold.point_count; ++i) {
    features.insert(manifold.points[i].feature);
    EXPECT_TRUE(std::isfinite(manifold.points[i].separation));
    for (int k = 0; k < 3; ++k) EXPECT_TRUE(std::isfinite(manifold.points[i].anchor_a[k]));
  }
  EXPECT_EQ(features.size(), manifold.point_count);
}

TEST(SolidCollision, IdenticalBoxesInOnePlacePartAlongTheFirstAxis) {
  const Manifold<3> manifold = meet(kCube, at(0, 0, 0), kCube, at(0, 0, 0));
  expect_finite(manifold);
  EXPECT_EQ(manifold.point_count, 4u);
  EXPECT_EQ(manifold.normal[0], 1.0f);
  EXPECT_NEAR(deepest(manifold), -1.0f, 1e-6f);
}

TEST(SolidCollision, ParallelEdgesHaveAFiniteContact) {
  const Rotation<3> diamond = turn_about({{0, 0, 1}}, kRight / 2);
  const float tip = std::sqrt(2.0f);
  // Overlapping by 0.01 m from edge to edge: a face clips the other's in a narrow strip.
  const Manifold<3> deep =
      meet(kCube, {Vec<3>::zero(), diamond}, kCube, {{{0, tip - 0.01f, 0}}, diamond});
  expect_finite(deep);
  EXPECT_NEAR(deepest(deep), -0.01f * std::sqrt(0.5f), 1e-5f);
  // Apart: the distance is along the line between the edges, which is none of the 15 axes.
  const Manifold<3> apart =
      meet(kCube, {Vec<3>::zero(), diamond}, kCube, {{{0, tip + 0.01f, 0}}, diamond});
  expect_finite(apart);
  EXPECT_NEAR(deepest(apart), 0.01f, 1e-5f);
  EXPECT_NEAR(apart.normal[1], 1.0f, 1e-4f);
}

TEST(SolidCollision, ParallelEdgesApartMeetInTheEndsOfWhatTheyShare) {
  // Cubes on one corner line: the gap between the edges along z is 0.01 each way.
  for (const float shift : {0.0f, 0.4f}) {
    const Manifold<3> manifold = meet(kCube, at(0, 0, 0), kCube, at(1.01f, 1.01f, shift), 0.02f);
    ASSERT_EQ(manifold.point_count, 2u);
    std::vector<float> ends;
    for (std::uint32_t i = 0; i < 2; ++i) {
      EXPECT_NEAR(manifold.points[i].separation, 0.01f * std::sqrt(2.0f), 1e-5f);
      ends.push_back(manifold.points[i].anchor_a[2]);
    }
    EXPECT_NEAR(std::min(ends[0], ends[1]), shift - 0.5f, 1e-5f);
    EXPECT_NEAR(std::max(ends[0], ends[1]), 0.5f, 1e-5f);
  }
  EXPECT_EQ(meet(kCube, at(0, 0, 0), kCube, at(1.01f, 1.01f, 1.0f), 0.02f).point_count, 1u);
}

TEST(SolidCollision, CoplanarFacesTouchWithoutDepth) {
  const Manifold<3> whole = meet(kCube, at(0, 0, 0), kCube, at(1.0f, 0, 0), 0.0f);
  expect_finite(whole);
  EXPECT_EQ(whole.point_count, 4u);
  EXPECT_EQ(deepest(whole), 0.0f);
  // Side by side along one edge only.
  const Manifold<3> edge = meet(kCube, at(0, 0, 0), kCube, at(1.0f, 1.0f, 0));
  expect_finite(edge);
  EXPECT_EQ(deepest(edge), 0.0f);
}

TEST(SolidCollision, TouchingCornersMeetInTheCorner) {
  const Manifold<3> flush = meet(kCube, at(0, 0, 0), kCube, at(1.0f, 1.0f, 1.0f));
  expect_finite(flush);
  EXPECT_EQ(deepest(flush), 0.0f);
  EXPECT_NEAR(length(flush.points[0].anchor_a - Vec<3>{{0.5f, 0.5f, 0.5f}}), 0.0f, 1e-5f);
}

TEST(SolidCollision, ACornerOnAnEdgeMeetsThere) {
  // b stands on its corner, which lies in the middle of an upper edge of a.
  const Vec<3> diagonal = {{1, 1, 1}};
  const Vec<3> up = {{0, 1, 0}};
  const double angle = std::acos(1.0 / std::sqrt(3.0));
  const Pose<3> pose_b = {{{0.5f, 0.5f + std::sqrt(0.75f), 0}},
                          turn_about(cross(diagonal, up), angle)};
  const Manifold<3> manifold = meet(kCube, at(0, 0, 0), kCube, pose_b);
  expect_finite(manifold);
  EXPECT_NEAR(deepest(manifold), 0.0f, 2e-6f);
  float nearest = 1e30f;
  for (std::uint32_t i = 0; i < manifold.point_count; ++i)
    nearest = std::min(nearest, length(manifold.points[i].anchor_a - Vec<3>{{0.5f, 0.5f, 0.0f}}));
  EXPECT_LT(nearest, 1e-3f);
}

TEST(SolidCollision, SizesAndPlacesMayBeFarApart) {
  const Shape<3> small = solid_box(1e-3f, 1e-3f, 1e-3f);
  const Shape<3> huge = solid_box(1e3f, 1e3f, 1e3f);
  const Manifold<3> on_top = meet(huge, at(0, 0, 0), small, at(300.0f, 1000.0f, -200.0f));
  expect_finite(on_top);
  EXPECT_EQ(on_top.normal[1], 1.0f);
  EXPECT_NEAR(deepest(on_top), -1e-3f, 7e-5f);  // A float at 1000 m has steps of 6e-5 m.
  const Manifold<3> inside = meet(huge, at(0, 0, 0), small, at(0, 900.0f, 0));
  expect_finite(inside);
  EXPECT_NEAR(deepest(inside), -100.0f - 1e-3f, 1e-3f);
  const Manifold<3> tiny = meet(small, at(0, 0, 0), small, at(0, 1.99e-3f, 0), 1e-4f);
  expect_finite(tiny);
  EXPECT_EQ(tiny.point_count, 4u);
  EXPECT_NEAR(deepest(tiny), -1e-5f, 1e-8f);
  const Manifold<3> far =
      meet(kCube, at(1e5f, -1e5f, 1e5f), kCube, at(1e5f, -1e5f + 0.984375f, 1e5f));
  const Manifold<3> near = meet(kCube, at(0, 0, 0), kCube, at(0, 0.984375f, 0));
  EXPECT_EQ(std::memcmp(&far.points, &near.points, sizeof far.points), 0);
}

TEST(SolidCollision, ReduceKeepsTheNearSideOfASolidWithinTheMargin) {
  // A cube of 2 mm, upside down: its far corners are within the margin, and come first.
  const Rotation<3> over = turn_about({{1, 0, 0}}, 2.0 * kRight);
  const Solid solid = placed(solid_box(1e-3f, 1e-3f, 1e-3f), {{{0, 1e-3f, 0}}, over});
  const Manifold<3> manifold = half_space_against_solid({{0, 1, 0}}, 0.0f, solid, 0.02f);
  ASSERT_EQ(manifold.point_count, 4u);
  for (const ManifoldPoint<3>& point : manifold.points) EXPECT_NEAR(point.separation, 0.0f, 1e-9f);
}

TEST(SolidCollision, ReduceKeepsTheEndsOfALine) {
  std::array<Candidate, 7> line;
  for (std::uint32_t i = 0; i < 7; ++i)
    line[i] = {{{static_cast<float>(i), 0, 0}}, i == 3 ? -0.02f : -0.01f, i};
  Manifold<3> manifold;
  manifold.normal = {{0, 1, 0}};
  reduce(line, manifold);
  ASSERT_EQ(manifold.point_count, 3u);
  EXPECT_EQ(manifold.points[0].feature, 0u);
  EXPECT_EQ(manifold.points[1].feature, 3u);
  EXPECT_EQ(manifold.points[2].feature, 6u);
}

TEST(SolidCollision, BoxesAsHullsMeetAsBoxes) {
  std::mt19937 random(21);
  std::uniform_real_distribution<float> u(-1.0f, 1.0f);
  int compared = 0;
  for (int i = 0; i < 5000; ++i) {
    const Shape<3> b = solid_box(0.4f, 0.3f, 0.6f);
    const Pose<3> pose_a = {Vec<3>::zero(), turn_about({{u(random), u(random), u(random)}}, 1.0)};
    const Pose<3> pose_b = {{{u(random), u(random), u(random)}},
                            turn_about({{u(random), u(random), u(random)}}, 2.0)};
    const Solid solid_a = placed(kCube, pose_a);
    const Solid solid_b = placed(b, pose_b);
    const Manifold<3> boxes = box_against_box(solid_a, solid_b, 0.02f);
    const Manifold<3> hulls = solid_against_solid(solid_a, solid_b, 0.02f);
    // Edge pairs come in another order, so of ties within the tolerance another may win.
    if (dot(boxes.normal, hulls.normal) < 0.9999f || boxes.point_count == 0) continue;
    ++compared;
    ASSERT_EQ(boxes.point_count, hulls.point_count) << i;
    EXPECT_NEAR(deepest(boxes), deepest(hulls), 1e-5f) << i;
  }
  EXPECT_GT(compared, 3000);
}

static TestHull octahedron() {
  return hull_of({{{1, 0, 0}}, {{-1, 0, 0}}, {{0, 1, 0}}, {{0, -1, 0}}, {{0, 0, 1}}, {{0, 0, -1}}});
}

TEST(SolidCollision, AHullStandsOnItsCornerEdgeOrFace) {
  const TestHull hull = octahedron();
  ASSERT_EQ(hull.pool.faces.size(), 8u);
  const Shape<3> slab = solid_box(3.0f, 0.5f, 3.0f);
  const auto stand = [&](const Rotation<3>& rotation, float height) {
    return collide(slab, at(0, 0, 0), hull.shape, {{{0, 0.5f + height, 0}}, rotation}, 0.02f,
                   hull.pool);
  };
  const Manifold<3> corner = stand(identity_rotation<3>(), 0.99f);
  expect_finite(corner);
  ASSERT_EQ(corner.point_count, 1u);
  EXPECT_NEAR(corner.points[0].separation, -0.01f, 1e-6f);
  const Manifold<3> edge = stand(turn_about({{0, 0, 1}}, kRight / 2), std::sqrt(0.5f) - 0.01f);
  expect_finite(edge);
  EXPECT_EQ(edge.point_count, 2u);
  EXPECT_NEAR(deepest(edge), -0.01f, 1e-6f);
  const Vec<3> diagonal = {{1, 1, 1}};
  const Rotation<3> down = turn_about(cross(diagonal, Vec<3>{{0, -1, 0}}),
                                      2.0 * kRight - std::acos(1.0 / std::sqrt(3.0)));
  const Manifold<3> face = stand(down, std::sqrt(1.0f / 3.0f) - 0.01f);
  expect_finite(face);
  EXPECT_EQ(face.point_count, 3u);
  for (std::uint32_t i = 0; i < 3; ++i) EXPECT_NEAR(face.points[i].separation, -0.01f, 2e-6f);
}

TEST(SolidCollision, APrismOnAPrismIsCutToTheirCommonFace) {
  std::vector<Vec<3>> points;
  for (int side = 0; side < 2; ++side)
    for (int i = 0; i < 6; ++i) {
      const double angle = i * kRight * 2.0 / 3.0;
      points.push_back({{static_cast<float>(std::cos(angle)), side == 0 ? -0.5f : 0.5f,
                         static_cast<float>(std::sin(angle))}});
    }
  const TestHull prism = hull_of(points);
  ASSERT_EQ(prism.pool.faces.size(), 8u);
  ASSERT_EQ(prism.pool.edges.size(), 36u);
  Pose<3> above = at(0, 0.99f, 0);
  above.rotation = turn_about({{0, 1, 0}}, kRight / 3);
  const Manifold<3> manifold =
      collide(prism.shape, at(0, 0, 0), prism.shape, above, 0.02f, prism.pool);
  expect_finite(manifold);
  ASSERT_EQ(manifold.point_count, 4u);
  // Hexagons turned by 30 degrees meet in a dodecagon around a circle of 1 / (2 cos 15 degrees)
  // times the square root of 3.
  const float radius = std::sqrt(0.75f) / std::cos(static_cast<float>(kRight) / 6.0f);
  for (const ManifoldPoint<3>& point : manifold.points) {
    EXPECT_NEAR(point.separation, -0.01f, 1e-6f);
    EXPECT_NEAR(std::hypot(point.anchor_a[0], point.anchor_a[2]), radius, 1e-5f);
  }
}

TEST(SolidCollision, RandomHullsAgreeWithEveryAxisTried) {
  std::mt19937 random(31);
  std::uniform_real_distribution<float> u(-1.0f, 1.0f);
  const TestHull one = ball_hull(14, 0.5f, 1);
  const TestHull other = ball_hull(9, 0.4f, 2);
  int overlapping = 0;
  for (int i = 0; i < 3000; ++i) {
    const Pose<3> pose_a = {Vec<3>::zero(), turn_about({{u(random), u(random), u(random)}}, 3.0)};
    const Pose<3> pose_b = {{{0.6f * u(random), 0.6f * u(random), 0.6f * u(random)}},
                            turn_about({{u(random), u(random), u(random)}}, 3.0)};
    const Solid a = placed(one.shape, pose_a, one.pool);
    const Solid b = placed(other.shape, pose_b, other.pool);
    const Manifold<3> manifold = solid_against_solid(a, b, 0.02f);
    const double best = best_gap(a, b);
    if (best > 0.02 + 1e-5) {
      EXPECT_EQ(manifold.point_count, 0u) << i;
    }
    if (best > 0.0) continue;
    ++overlapping;
    expect_finite(manifold);
    const double along = axis_of(manifold.normal).between(a, b);
    EXPECT_GE(along, best + 0.025 * best - 2.6e-3) << i;
    EXPECT_GE(static_cast<double>(deepest(manifold)), along - 1e-4) << i;
    EXPECT_LE(static_cast<double>(deepest(manifold)), best + 6e-4) << i;
  }
  EXPECT_GT(overlapping, 1500);
}

}  // namespace cycloid::solver
