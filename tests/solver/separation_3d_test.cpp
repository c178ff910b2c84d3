#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "solver/queries/solid_queries.hpp"
#include "tests/solver/query_3d_fixture.hpp"

namespace cycloid::solver {

static Core<3> core_at(const Shape<3>& shape, Vec<3> position,
                       Rotation<3> rotation = identity_rotation<3>(), const Polyhedra& pools = {}) {
  return core_of(shape, rotation, position, pools);
}

static void expect_vector(const Vec<3>& found, const Vec<3>& wanted, float tolerance = kExact) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(found[i], wanted[i], tolerance) << "axis " << i;
}

TEST(SolidSeparation, OfBoxesIsThatOfTheirNearestFeatures) {
  const Core<3> a = core_at(solid_box({{1, 2, 3}}), {{0, 0, 0}});
  const Separation<3> face =
      separation_of(a, core_at(solid_box({{0.5f, 0.5f, 0.5f}}), {{3, 0, 0}}));
  EXPECT_NEAR(face.distance, 1.5f, kExact);
  expect_vector(face.normal, {{1, 0, 0}});
  EXPECT_NEAR(face.point_a[0], 1.0f, kExact);
  EXPECT_NEAR(face.point_b[0], 2.5f, kExact);
  const Separation<3> corner =
      separation_of(a, core_at(solid_box({{1, 1, 1}}), {{4, 5, 5}}));  // (2, 2, 1) apart.
  EXPECT_NEAR(corner.distance, 3.0f, kExact);
  expect_vector(corner.normal, {{2 / 3.0f, 2 / 3.0f, 1 / 3.0f}});
  expect_vector(corner.point_a, {{1, 2, 3}});
  expect_vector(corner.point_b, {{3, 4, 4}});
  // Two crossing edges: one box turned by 45 degrees about z, the other about x.
  const float quarter = 0.78539816f;
  const Core<3> ridge =
      core_at(solid_box({{1, 1, 5}}, {{0, 0, 0}}, turned_about({{0, 0, 1}}, quarter)), {{0, 0, 0}});
  const Core<3> above = core_at(
      solid_box({{5, 1, 1}}, {{0, 0, 0}}, turned_about({{1, 0, 0}}, quarter)), {{0.3f, 4, 0.2f}});
  const Separation<3> edges = separation_of(ridge, above);
  EXPECT_NEAR(edges.distance, 4 - 2 * std::sqrt(2.0f), kExact);
  expect_vector(edges.normal, {{0, 1, 0}});
  expect_vector(edges.point_a, {{0, std::sqrt(2.0f), 0.2f}}, 2e-6f);
}

TEST(SolidSeparation, OfCrossingSolidsIsTheLeastDepth) {
  const Core<3> a = core_at(solid_box({{1, 2, 3}}), {{0, 0, 0}});
  const Separation<3> face =
      separation_of(a, core_at(solid_box({{0.5f, 0.5f, 0.5f}}), {{0.2f, 2.4f, 0.1f}}));
  EXPECT_TRUE(face.crossing);
  EXPECT_NEAR(face.distance, -0.1f, kExact);
  expect_vector(face.normal, {{0, 1, 0}});
  const float quarter = 0.78539816f;
  const Core<3> ridge =
      core_at(solid_box({{1, 1, 5}}, {{0, 0, 0}}, turned_about({{0, 0, 1}}, quarter)), {{0, 0, 0}});
  const Core<3> above =
      core_at(solid_box({{5, 1, 1}}, {{0, 0, 0}}, turned_about({{1, 0, 0}}, quarter)),
              {{0.3f, 2.7f, 0.2f}});
  const Separation<3> edges = separation_of(ridge, above);
  EXPECT_TRUE(edges.crossing);
  EXPECT_NEAR(edges.distance, 2.7f - 2 * std::sqrt(2.0f), 2e-6f);
  expect_vector(edges.normal, {{0, 1, 0}}, 2e-6f);
  const Core<3> rod = core_at(solid_capsule({{-5, 0, 0}}, {{5, 0, 0}}, 0.1f), {{0, 1.9f, 2.8f}});
  const Separation<3> pierced = separation_of(a, rod);
  EXPECT_TRUE(pierced.crossing);
  EXPECT_NEAR(pierced.distance, -0.1f - 0.1f, kExact);
  expect_vector(pierced.normal, {{0, 1, 0}});
  const Separation<3> turned = separation_of(rod, a);
  EXPECT_NEAR(turned.distance, -0.2f, kExact);
  expect_vector(turned.normal, {{0, -1, 0}});
}

TEST(SolidSeparation, OfATriangleKnowsItsEdgesAndItsNormal) {
  const Core<3> t = core_at(solid_triangle({{0, 0, 0}}, {{0, 0, 1}}, {{1, 0, 0}}), {{0, 0, 0}});
  expect_vector(t.normals[0], {{0, 1, 0}});
  const auto ball = [](Vec<3> at) { return core_at(solid_ball(0.25f), at); };
  EXPECT_NEAR(separation_of(t, ball({{0.2f, 1, 0.2f}})).distance, 0.75f, kExact);
  EXPECT_NEAR(separation_of(t, ball({{0.2f, -1, 0.2f}})).distance, 0.75f, kExact);
  expect_vector(separation_of(t, ball({{0.2f, -1, 0.2f}})).normal, {{0, -1, 0}});
  const Separation<3> edge = separation_of(t, ball({{0.4f, 4, -3}}));
  EXPECT_NEAR(edge.distance, 4.75f, kExact);
  expect_vector(edge.point_a, {{0.4f, 0, 0}});
  const Separation<3> through =
      separation_of(t, core_at(solid_box({{0.1f, 1, 0.1f}}), {{0.2f, 0.5f, 0.2f}}));
  EXPECT_TRUE(through.crossing);
  EXPECT_NEAR(through.distance, -0.5f, kExact);
  expect_vector(through.normal, {{0, 1, 0}});
}

TEST(SolidSeparation, IsFiniteWhereThereIsNoDirection) {
  Polyhedra pools;
  const Shape<3> tetrahedron =
      solid_hull({{{1, 1, 1}}, {{1, -1, -1}}, {{-1, 1, -1}}, {{-1, -1, 1}}}, pools);
  const Shape<3> shapes[] = {solid_ball(0.5f),
                             solid_capsule({{-1, 0, 0}}, {{1, 0, 0}}, 0.5f),
                             solid_capsule({{0, -1, 0}}, {{0, 1, 0}}, 0.5f),
                             solid_box({{1, 1, 1}}),
                             tetrahedron,
                             solid_triangle({{0, 0, 0}}, {{0, 0, 1}}, {{1, 0, 0}})};
  const Vec<3> places[] = {{{0, 0, 0}}, {{1, 0, 0}}, {{2, 0, 0}}, {{2, 2, 0}},
                           {{2, 2, 2}}, {{1, 1, 1}}, {{0, 1, 0}}, {{1e-7f, 2, 0}}};
  for (const Shape<3>& a : shapes)
    for (const Shape<3>& b : shapes)
      for (const Vec<3>& place : places) {
        const Separation<3> s =
            separation_of(core_at(a, {{0, 0, 0}}, identity_rotation<3>(), pools),
                          core_at(b, place, identity_rotation<3>(), pools));
        EXPECT_NEAR(length(s.normal), 1.0f, 1e-5f);
        EXPECT_TRUE(std::isfinite(s.distance));
        for (int i = 0; i < 3; ++i) EXPECT_TRUE(std::isfinite(s.point_a[i] + s.point_b[i]));
        EXPECT_NEAR(dot(s.normal, s.point_b - s.point_a), s.distance, 1e-5f);
      }
}

static Shape<3> random_solid_of_kind(std::mt19937& random, int kind, Polyhedra& pools) {
  const Vec<3> half = {
      {uniform(random, 0.05f, 1.0f), uniform(random, 0.05f, 1.0f), uniform(random, 0.05f, 1.0f)}};
  switch (kind) {
    case 0:
      return solid_ball(0.3f);
    case 1:
      return solid_capsule(random_vector(random, 1), random_vector(random, 1), 0.2f);
    case 2:
      return solid_box(half, random_vector(random, 0.2f), random_rotation(random));
    case 3:
      return solid_triangle(random_vector(random, 1), random_vector(random, 1),
                            random_vector(random, 1));
    default:
      return solid_hull(random_corners(random, 4 + static_cast<int>(random() % 12), half), pools);
  }
}

TEST(SolidSeparation, AgreesWithDoublePrecisionForEveryPair) {
  std::mt19937 random(7);
  double worst = 0, worst_depth = 0, worst_point = 0;
  int crossing = 0;
  for (int i = 0; i < 10000; ++i) {
    Polyhedra pools;
    const int kinds[2] = {static_cast<int>(random() % 5), static_cast<int>(random() % 5)};
    const Shape<3> shape_a = random_solid_of_kind(random, kinds[0], pools);
    const Shape<3> shape_b = random_solid_of_kind(random, kinds[1], pools);
    const Core<3> a = core_at(shape_a, random_vector(random, 0.2f), random_rotation(random), pools);
    const Core<3> b = core_at(shape_b, random_vector(random, i % 2 == 0 ? 0.6f : 1.5f),
                              random_rotation(random), pools);
    const Separation<3> found = separation_of(a, b);
    ASSERT_TRUE(std::isfinite(found.distance) && std::isfinite(found.normal[0] + found.point_a[0]));
    ASSERT_NEAR(length(found.normal), 1.0f, 1e-5f);
    const double wanted = wide_separation(wide_core(a), wide_core(b)) - a.radius - b.radius;
    const bool cores_cross = wanted + a.radius + b.radius < -2e-6;
    if (cores_cross) {
      ++crossing;
      EXPECT_TRUE(found.crossing) << i;
      // A triangle is left along its own normal, which may be deeper.
      if (kinds[0] != 3 && kinds[1] != 3)
        worst_depth = std::max(worst_depth, std::abs(wanted - double{found.distance}));
      else
        EXPECT_LE(found.distance, wanted + 1e-5) << i;
    } else {
      EXPECT_FALSE(found.crossing) << i;
      worst = std::max(worst, std::abs(wanted - double{found.distance}));
      const Vec<3> between = found.point_b - found.point_a;
      for (int k = 0; k < 3; ++k)
        worst_point = std::max(
            worst_point,
            std::abs(double{between[k]} - double{found.distance} * double{found.normal[k]}));
    }
    ASSERT_LT(worst, 5e-6) << i << " kinds " << kinds[0] << kinds[1];
    ASSERT_LT(worst_depth, 5e-6) << i << " kinds " << kinds[0] << kinds[1];
    const Separation<3> swapped = separation_of(b, a);
    if (!cores_cross) {
      ASSERT_NEAR(swapped.distance, found.distance, 5e-6) << i;
    }
  }
  EXPECT_LT(worst_point, 5e-6);
  EXPECT_GT(crossing, 1000);
  RecordProperty("worst", std::to_string(worst));
  RecordProperty("worst_depth", std::to_string(worst_depth));
}

TEST(SolidSeparation, OfTwoHullsOf64CornersAgreesWithDoublePrecision) {
  std::mt19937 random(11);
  for (int i = 0; i < 40; ++i) {
    Polyhedra pools;
    const Shape<3> a = solid_hull(random_corners(random, 64, {{1, 0.8f, 0.6f}}), pools);
    const Shape<3> b = solid_hull(random_corners(random, 64, {{1, 0.8f, 0.6f}}), pools);
    const Core<3> core_a = core_at(a, {{0, 0, 0}}, random_rotation(random), pools);
    const Core<3> core_b =
        core_at(b, {{0.05f * static_cast<float>(i), 0.1f, 0.2f}}, random_rotation(random), pools);
    EXPECT_NEAR(separation_of(core_a, core_b).distance,
                wide_separation(wide_core(core_a), wide_core(core_b)), 5e-6)
        << i;
  }
}

TEST(SolidSeparation, OfTurnedAndTouchingBoxesHasNoJump) {
  // A box slides from above into another through the touch: the distance falls in equal steps.
  std::mt19937 random(3);
  for (int round = 0; round < 50; ++round) {
    const Rotation<3> turn = random_rotation(random);
    const Core<3> a = core_at(solid_box({{1, 1, 1}}), {{0, 0, 0}}, turn);
    for (int step = -20; step <= 20; ++step) {
      const float gap = 1e-6f * static_cast<float>(step);
      const Core<3> b =
          core_at(solid_box({{0.5f, 0.5f, 0.5f}}), rotate(turn, {{0.2f, 1.5f + gap, 0.1f}}), turn);
      const Separation<3> s = separation_of(a, b);
      EXPECT_NEAR(s.distance, gap, 1e-6f);
      EXPECT_NEAR(dot(s.normal, rotate(turn, {{0, 1, 0}})), 1.0f, 1e-4f);
    }
  }
}

TEST(SolidSeparation, FindsABoxAmongTheCornersOfAProbe) {
  std::mt19937 random(5);
  for (int round = 0; round < 200; ++round) {
    const Vec<3> half = {
        {uniform(random, 0.1f, 1), uniform(random, 0.1f, 1), uniform(random, 0.1f, 1)}};
    const Rotation<3> own = random_rotation(random);
    Probe<3> probe;
    probe.count = 8;
    for (std::uint32_t i = 0; i < 8; ++i) {
      Vec<3> corner = half;
      for (int k = 0; k < 3; ++k)
        if ((i >> k & 1u) == 0) corner[k] = -corner[k];
      probe.points[i] = rotate(own, corner);
    }
    for (std::uint32_t i = 7; i > 0; --i)
      std::swap(probe.points[i], probe.points[random() % (i + 1)]);
    const Rotation<3> turn = random_rotation(random);
    const Core<3> found = core_of(probe, turn);
    ASSERT_EQ(found.kind, ShapeKind::kBox);
    const Core<3> box = core_at(solid_box(half, {{0, 0, 0}}, own), {{0, 0, 0}}, turn);
    const Core<3> other = core_at(solid_box({{0.4f, 0.6f, 0.5f}}), random_vector(random, 1));
    EXPECT_NEAR(separation_of(found, other).distance, separation_of(box, other).distance, 2e-6f);
  }
}

TEST(SolidSeparation, OfHullProbesIsThatOfHulls) {
  std::mt19937 random(9);
  for (int i = 0; i < 2000; ++i) {
    Polyhedra pools;
    const std::vector<Vec<3>> corners = random_corners(random, 12, {{0.5f, 0.4f, 0.3f}});
    Probe<3> probe;
    probe.count = 12;
    for (std::size_t k = 0; k < 12; ++k) probe.points[k] = corners[k];
    const Rotation<3> turn = random_rotation(random);
    const Core<3> own = core_of(probe, turn);
    ASSERT_EQ(own.kind, ShapeKind::kHull);
    const Core<3> copy = own;  // Shares the faces.
    const Core<3> hull = core_at(solid_hull(corners, pools), {{0, 0, 0}}, turn, pools);
    const Vec<3> at = random_vector(random, 1.2f);
    for (const Shape<3>& shape : {solid_box({{0.4f, 0.6f, 0.5f}}), solid_ball(0.1f)}) {
      const Separation<3> found = separation_of(copy, core_at(shape, at));
      const Separation<3> wanted = separation_of(hull, core_at(shape, at));
      EXPECT_EQ(found.crossing, wanted.crossing);
      ASSERT_NEAR(length(found.normal), 1, 1e-5f);
      EXPECT_NEAR(found.distance, wanted.distance, 2e-6f);
    }
  }
}

TEST(SolidSeparation, OfAFlatProbeIsExactApartAndFiniteInside) {
  Probe<3> probe;
  probe.count = 4;
  for (std::size_t i = 0; i < 4; ++i)
    probe.points[i] = {{i < 2 ? -0.5f : 0.5f, 0.0f, i % 2 == 0 ? -0.5f : 0.5f}};
  const Core<3> plate = core_of(probe, identity_rotation<3>());
  EXPECT_EQ(plate.face_count, 0u);
  const Separation<3> apart = separation_of(plate, core_at(solid_ball(0.1f), {{0.3f, 0.5f, 0}}));
  EXPECT_NEAR(apart.distance, 0.4f, 1e-6f);
  const Separation<3> across =
      separation_of(plate, core_at(solid_box({{1, 1, 1}}), {{0.1f, 0.2f, 0}}));
  EXPECT_TRUE(across.crossing);
  EXPECT_NEAR(across.distance, -0.8f, 1e-6f);
  EXPECT_NEAR(length(across.normal), 1.0f, 1e-6f);
}

/// Two triangles that share the edge along z at the origin; the second is turned by `angle`.
static Core<3> hinged(float angle) {
  Shape<3> shape = solid_triangle({{-1, 0, 0}}, {{0, 0, 1}}, {{0, 0, -1}});
  shape.ghosts = 2;  // Across the edge from corner 1 to corner 2.
  shape.vertices[4] = {{std::cos(angle), std::sin(angle), 0}};
  return core_at(shape, {{0, 0, 0}});
}

TEST(SolidSeparation, ATriangleLeavesNormalsBeyondTheSeamToItsNeighbour) {
  const auto leaning = [](float angle) { return Vec<3>{{std::sin(angle), std::cos(angle), 0}}; };
  expect_vector(hinged(0).normals[0], {{0, 1, 0}});
  EXPECT_TRUE(allows(hinged(0), leaning(0)));
  EXPECT_FALSE(allows(hinged(0), leaning(0.1f)));
  EXPECT_TRUE(allows(hinged(0), leaning(-0.1f)));     // Over the corner at the free end.
  EXPECT_TRUE(allows(hinged(-0.5f), leaning(0.4f)));  // A ridge.
  EXPECT_FALSE(allows(hinged(-0.5f), leaning(0.6f)));
  EXPECT_FALSE(allows(hinged(0.5f), leaning(0.1f)));  // A valley.
  EXPECT_FALSE(allows(hinged(-0.5f), {{0, -1, 0}}));
  Shape<3> free = solid_triangle({{-1, 0, 0}}, {{0, 0, 1}}, {{0, 0, -1}});
  EXPECT_TRUE(allows(core_at(free, {{0, 0, 0}}), leaning(1.5f)));
}

}  // namespace cycloid::solver
