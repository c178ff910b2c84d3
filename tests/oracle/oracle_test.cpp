#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "tests/oracle/random.hpp"
#include "tests/oracle/separation.hpp"

namespace cycloid::oracle {

static constexpr double kExact = 1e-12;
static constexpr double kPi = 3.14159265358979323846;

static Convex at(const Convex& body, const Vector& position) {
  return placed(body, {position, {}, 1.0});
}

static void expect_gap(const Convex& a, const Convex& b, double value, const Vector& direction) {
  const Gap gap = separation(a, b);
  EXPECT_NEAR(gap.value, value, kExact);
  EXPECT_LT(length(gap.direction - direction), 1e-9)
      << gap.direction.x << " " << gap.direction.y << " " << gap.direction.z;
}

static Convex random_hull(Random& random, int points) {
  std::vector<Vector> corners;
  for (int i = 0; i < points; ++i)
    corners.push_back({random.within(-1, 1), random.within(-0.5, 0.5), random.within(-0.2, 0.2)});
  return hull_of(corners);
}

static Placement random_place(Random& random, double reach) {
  Placement placement = random.turn();
  placement.position = random.within(0, reach) * random.direction();
  return placement;
}

TEST(OracleConvex, HasTheFacesAndEdgesOfBoxesTetrahedraAndTriangles) {
  const Convex box = box_of({1, 2, 3});
  EXPECT_EQ(box.normals.size(), 6u);
  EXPECT_EQ(box.edges.size(), 12u);
  EXPECT_NEAR(box.extent(), std::sqrt(14.0), kExact);
  EXPECT_EQ(hull_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}).normals.size(), 4u);
  EXPECT_EQ(hull_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}).normals.size(), 2u);
}

TEST(OracleConvex, ARandomHullObeysEulersFormula) {
  Random random(1);
  for (int i = 0; i < 50; ++i) {
    const Convex hull = random_hull(random, 8 + i / 2);
    std::size_t corners = 0;
    for (const Vector& corner : hull.corners)
      corners += static_cast<std::size_t>(
          std::any_of(hull.edges.begin(), hull.edges.end(), [&](const Edge& edge) {
            const Vector out = corner - edge.origin;
            return length(out) < kExact || length(cross(out, edge.direction)) < 1e-9;
          }));
    EXPECT_EQ(corners + hull.normals.size(), hull.edges.size() + 2);
  }
}

TEST(OracleSeparation, OfBoxesWhoseFacesEdgesOrCornersAreNearest) {
  const Convex cube = box_of({1, 1, 1});
  expect_gap(cube, at(cube, {2.5, 0.3, 0.4}), 0.5, {1, 0, 0});
  expect_gap(cube, at(cube, {-2.5, 0.3, 0.4}), 0.5, {-1, 0, 0});
  expect_gap(cube, at(cube, {2.3, 0.1, 2.4}), 0.5, {0.6, 0, 0.8});
  expect_gap(cube, at(cube, {2.1, 2.2, 2.2}), 0.3, {1.0 / 3, 2.0 / 3, 2.0 / 3});
}

TEST(OracleSeparation, OfBoxesThatOverlapIsTheLeastWayOut) {
  const Convex cube = box_of({1, 1, 1});
  expect_gap(cube, at(cube, {1.5, 1.0, 0.2}), -0.5, {1, 0, 0});
  expect_gap(cube, at(cube, {0.1, -1.9, 0.2}), -0.1, {0, -1, 0});
  EXPECT_NEAR(separation(cube, cube).value, -2.0, kExact);
  expect_gap(cube, at(box_of({0.1, 0.1, 0.1}), {0, 0, 0.8}), -0.3, {0, 0, 1});
}

TEST(OracleSeparation, OfCrossedEdgesIsAlongTheirCommonNormal) {
  const double diagonal = std::sqrt(2.0);
  const Convex cube = box_of({1, 1, 1});
  const Convex below = placed(cube, turned({0, 0, 1}, kPi / 4));
  for (const double gap : {0.25, -0.25}) {
    const Vector up = {0, 2 * diagonal + gap, 0};
    expect_gap(below, placed(cube, turned({1, 0, 0}, kPi / 4, up)), gap, {0, 1, 0});
  }
}

TEST(OracleSeparation, OfATetrahedronOnItsCornerOverAFace) {
  const Convex tetrahedron = hull_of({{0, 0, 0}, {1, 2, 0}, {-1, 2, 1}, {-1, 2, -1}});
  const Convex table = at(box_of({3, 1, 3}), {0, -1, 0});
  for (const double gap : {0.125, -0.125})
    expect_gap(table, at(tetrahedron, {0.5, gap, 0.5}), gap, {0, 1, 0});
  const Convex corner = hull_of({{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {0, 0, 3}});
  const double third = 1.0 / std::sqrt(3.0);
  expect_gap(corner, at(box_of({1, 1, 1}), {2.5, 2.5, 2.5}), 1.5 * third, {third, third, third});
  expect_gap(corner, at(box_of({1, 1, 1}), {1.9, 1.9, 1.9}), -0.3 * third, {third, third, third});
}

TEST(OracleSeparation, OfRoundBodies) {
  const Convex ball = ball_of(0.5);
  expect_gap(ball, at(ball, {0, 3, 4}), 4.0, {0, 0.6, 0.8});
  expect_gap(ball, at(ball, {0, 0.3, 0.4}), -0.5, {0, 0.6, 0.8});
  EXPECT_NEAR(separation(ball, ball).value, -1.0, kExact);
  const Convex capsule = capsule_of(1.0, 0.25);
  expect_gap(capsule, at(ball, {2, 0.5, 0}), 1.25, {1, 0, 0});
  expect_gap(capsule, at(ball, {0.3, 1.4, 0}), -0.25, {0.6, 0.8, 0});
  const Convex lying = placed(capsule, turned({1, 0, 0}, kPi / 2, {0.75, 0.2, 0.3}));
  expect_gap(capsule, lying, 0.25, {1, 0, 0});
  // A capsule whose segment goes through a box: out along x, past half 1 and the radius.
  expect_gap(box_of({1, 2, 3}), at(capsule, {0.9, 0.1, 0.2}), -0.35, {1, 0, 0});
  EXPECT_NEAR(separation(capsule, capsule).value, -0.5, kExact);
  EXPECT_NEAR(separation(capsule, at(ball, {0, 0.5, 0})).value, -0.75, kExact);
}

TEST(OracleSeparation, OfATriangleHasTwoSides) {
  const Convex triangle = hull_of({{-1, 0, -1}, {-1, 0, 2}, {2, 0, -1}});
  const Convex cube = box_of({0.5, 0.5, 0.5});
  expect_gap(triangle, at(cube, {-0.2, 0.4, -0.2}), -0.1, {0, 1, 0});
  expect_gap(triangle, at(cube, {-0.2, -0.4, -0.2}), -0.1, {0, -1, 0});
  expect_gap(triangle, at(cube, {-1.6, 0.3, 0.2}), 0.1, {-1, 0, 0});
  expect_gap(triangle, at(cube, {-1.4, 0.2, 0.2}), -0.1, {-1, 0, 0});
}

/// Over random hulls, apart and overlapping: nothing here is known beforehand, but all must agree.
TEST(OracleSeparation, IsProvedByAPlaneAndByItsOwnAlgebra) {
  Random random(7);
  std::array<int, 2> counts{};
  for (int i = 0; i < 2000; ++i) {
    const Convex a = placed(random_hull(random, 4 + i % 12), random_place(random, 0.0));
    const Convex b = placed(random_hull(random, 4 + i % 9), random_place(random, 3.0));
    const Distance apart = distance(a, b);
    EXPECT_NEAR(apart.value, apart.lower_bound, 1e-10) << i;
    EXPECT_NEAR(length(apart.on_b - apart.on_a), apart.value, 1e-10);
    const Gap gap = separation(a, b);
    EXPECT_NEAR(gap_along(a, b, gap.direction), gap.value, 1e-10) << i;
    const Gap widest = widest_gap(a, b);
    EXPECT_LE(widest.value, gap.value + 1e-10);
    EXPECT_EQ(widest.value > 1e-9, apart.value > 1e-9) << i;
    if (i % 10 == 0 && gap.value < 0) {
      EXPECT_NEAR(widest_gap(a, b, true).value, gap.value, kExact) << i;
    }
    EXPECT_NEAR(separation(b, a).value, gap.value, 1e-10);
    const Vector away = {10, -20, 30};
    EXPECT_NEAR(separation(at(a, away), at(b, away)).value, gap.value, 1e-10);
    ++counts[gap.value < 0 ? 1 : 0];
    const double out = gap.value < 0 ? -0.25 * gap.value : 0.25;
    EXPECT_NEAR(separation(a, at(b, out * gap.direction)).value, gap.value + out, 1e-9) << i;
  }
  EXPECT_GT(counts[0], 500);
  EXPECT_GT(counts[1], 300);
}

/// No direction out of many random ones frees two overlapping hulls sooner.
TEST(OracleSeparation, IsNotBeatenByRandomDirections) {
  Random random(11);
  for (int i = 0; i < 100; ++i) {
    const Convex a = placed(random_hull(random, 8), random_place(random, 0.0));
    const Convex b = placed(random_hull(random, 8), random_place(random, 0.3));
    const double value = separation(a, b).value;
    for (int k = 0; k < 200; ++k) EXPECT_LE(gap_along(a, b, random.direction()), value + kExact);
  }
}

}  // namespace cycloid::oracle
