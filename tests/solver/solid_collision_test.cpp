#include "tests/solver/manifold_3d_fixture.hpp"

namespace cycloid::solver {

static std::vector<float> separations(const Manifold<3>& manifold) {
  std::vector<float> all;
  for (std::uint32_t i = 0; i < manifold.point_count; ++i)
    all.push_back(manifold.points[i].separation);
  std::sort(all.begin(), all.end());
  return all;
}

static std::set<std::uint32_t> features(const Manifold<3>& manifold) {
  std::set<std::uint32_t> all;
  for (std::uint32_t i = 0; i < manifold.point_count; ++i) all.insert(manifold.points[i].feature);
  return all;
}

/// x and z of the points, to 1e-4 m, in order.
static std::vector<std::pair<float, float>> footprint(const Manifold<3>& manifold) {
  std::vector<std::pair<float, float>> all;
  for (std::uint32_t i = 0; i < manifold.point_count; ++i) {
    const Vec<3>& p = manifold.points[i].anchor_a;
    all.push_back({std::round(p[0] * 1e4f) / 1e4f, std::round(p[2] * 1e4f) / 1e4f});
  }
  std::sort(all.begin(), all.end());
  return all;
}

static void expect_sound(const Manifold<3>& manifold) {
  if (manifold.point_count == 0) return;
  ASSERT_LE(manifold.point_count, 4u);
  ASSERT_NEAR(length(manifold.normal), 1.0f, 1e-5f);
  ASSERT_EQ(features(manifold).size(), manifold.point_count);
  for (std::uint32_t i = 0; i < manifold.point_count; ++i) {
    ASSERT_TRUE(std::isfinite(manifold.points[i].separation));
    for (int k = 0; k < 3; ++k) ASSERT_TRUE(std::isfinite(manifold.points[i].anchor_a[k]));
  }
}

TEST(SolidCollision, StackedBoxesMeetInTheirCorners) {
  const Manifold<3> manifold = meet(kCube, at(0, 0, 0), kCube, at(0, 0.99f, 0));
  ASSERT_EQ(manifold.point_count, 4u);
  EXPECT_EQ(manifold.normal[1], 1.0f);
  using Corners = std::vector<std::pair<float, float>>;
  EXPECT_EQ(footprint(manifold),
            (Corners{{-0.5f, -0.5f}, {-0.5f, 0.5f}, {0.5f, -0.5f}, {0.5f, 0.5f}}));
  for (const ManifoldPoint<3>& point : manifold.points) {
    EXPECT_NEAR(point.separation, -0.01f, 1e-6f);
    EXPECT_NEAR(point.anchor_a[1], 0.495f, 1e-6f);  // Midway between 0.5 and 0.49.
    EXPECT_NEAR(anchor_b_of(point, {{0.0f, 0.99f, 0.0f}})[1], -0.495f, 1e-6f);
  }
}

TEST(SolidCollision, AnOffsetBoxIsCutAtTheEdgesOfTheReferenceFace) {
  const Manifold<3> manifold =
      meet(kCube, at(0, 0, 0), solid_box(0.4f, 0.1f, 0.3f), at(0.3f, 0.595f, 0.35f));
  using Corners = std::vector<std::pair<float, float>>;
  EXPECT_EQ(footprint(manifold),
            (Corners{{-0.1f, 0.05f}, {-0.1f, 0.5f}, {0.5f, 0.05f}, {0.5f, 0.5f}}));
  for (const float separation : separations(manifold)) EXPECT_NEAR(separation, -0.005f, 1e-6f);
}

TEST(SolidCollision, AnOctagonKeepsItsDeepestPointAndAWideBase) {
  Pose<3> pose_b = at(0, 0.995f, 0);
  pose_b.rotation = compose(turn_about({{1, 0, 0}}, 0.004), turn_about({{0, 1, 0}}, kRight / 2));
  const Manifold<3> manifold = meet(kCube, at(0, 0, 0), kCube, pose_b);
  ASSERT_EQ(manifold.point_count, 4u);
  expect_sound(manifold);
  // The tilt lowers the corners of the octagon at z = 0.5 the most.
  EXPECT_NEAR(separations(manifold).front(), -0.005f - 0.004f * 0.5f, 2e-5f);
  const auto corners = footprint(manifold);
  EXPECT_LT(corners.front().first, -0.49f);
  EXPECT_GT(corners.back().first, 0.2f);
}

TEST(SolidCollision, CrossingEdgesMeetInOnePoint) {
  const Pose<3> pose_a = {Vec<3>::zero(), turn_about({{0, 0, 1}}, kRight / 2)};
  const Pose<3> pose_b = {{{0.1f, 1.40f, 0.2f}}, turn_about({{1, 0, 0}}, kRight / 2)};
  const Manifold<3> manifold = meet(kCube, pose_a, kCube, pose_b);
  ASSERT_EQ(manifold.point_count, 1u);
  EXPECT_NEAR(manifold.normal[1], 1.0f, 1e-6f);
  const float depth = 1.40f - std::sqrt(2.0f);
  EXPECT_NEAR(manifold.points[0].separation, depth, 1e-6f);
  // a's upper edge runs along z at x = 0, b's lower one along x at z = 0.2.
  EXPECT_NEAR(manifold.points[0].anchor_a[0], 0.0f, 1e-6f);
  EXPECT_NEAR(manifold.points[0].anchor_a[1], std::sqrt(0.5f) + 0.5f * depth, 1e-6f);
  EXPECT_NEAR(manifold.points[0].anchor_a[2], 0.2f, 1e-6f);
  const std::uint32_t edge_bit = 0x40000000u;
  EXPECT_TRUE(manifold.points[0].feature & edge_bit);
  EXPECT_FALSE(meet(kCube, at(0, 0, 0), kCube, at(0, 1, 0)).points[0].feature & edge_bit);
}

TEST(SolidCollision, OnlyPointsWithinTheMarginCount) {
  EXPECT_EQ(meet(kCube, at(0, 0, 0), kCube, at(0, 1.03f, 0), 0.02f).point_count, 0u);
  const Manifold<3> manifold = meet(kCube, at(0, 0, 0), kCube, at(0, 1.03f, 0), 0.04f);
  ASSERT_EQ(manifold.point_count, 4u);
  for (const float separation : separations(manifold)) EXPECT_NEAR(separation, 0.03f, 1e-6f);
  Pose<3> tilted = at(0, 1.03f, 0);
  tilted.rotation = turn_about({{0, 0, 1}}, 0.04);  // The far side is 0.04 m higher.
  EXPECT_EQ(meet(kCube, at(0, 0, 0), kCube, tilted, 0.04f).point_count, 2u);
}

TEST(SolidCollision, CornersApartMeetAlongTheLineBetweenThemOrNotAtAll) {
  const Manifold<3> manifold = meet(kCube, at(0, 0, 0), kCube, at(1.02f, 1.03f, 1.06f), 0.08f);
  ASSERT_EQ(manifold.point_count, 1u);
  EXPECT_NEAR(manifold.points[0].separation, 0.07f, 1e-5f);  // 2, 3, 6: 7.
  EXPECT_NEAR(manifold.normal[0], 2.0f / 7.0f, 1e-4f);
  EXPECT_NEAR(manifold.normal[1], 3.0f / 7.0f, 1e-4f);
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(manifold.points[0].anchor_a[k], 0.5f + 0.035f * manifold.normal[k], 1e-5f);
  // Every face axis separates by less than the margin, but no two points are that near.
  EXPECT_EQ(meet(kCube, at(0, 0, 0), kCube, at(1.02f, 1.03f, 1.06f), 0.065f).point_count, 0u);
}

TEST(SolidCollision, SwappingTheSolidsTurnsTheManifoldRound) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> u(-1.0f, 1.0f);
  int touching = 0;
  for (int i = 0; i < 2000; ++i) {
    const Shape<3> a = solid_box(0.6f, 0.5f, 0.4f);
    const Shape<3> b = solid_box(0.3f, 0.7f, 0.35f);
    const Pose<3> pose_a = {Vec<3>::zero(), turn_about({{u(random), u(random), u(random)}}, 1.3)};
    const Vec<3> towards = normalized_or(Vec<3>{{u(random), u(random), u(random)}}, Vec<3>::zero());
    const Pose<3> pose_b = {0.9f * towards, turn_about({{u(random), u(random), u(random)}}, 2.1)};
    const Manifold<3> forth = meet(a, pose_a, b, pose_b);
    const Manifold<3> back = meet(b, pose_b, a, pose_a);
    // Pairs whose axes tie within the tolerance may choose another axis.
    const float turned = dot(forth.normal, back.normal);
    if (forth.point_count == 0 || turned > -0.999f) continue;
    ++touching;
    const std::vector<float> one = separations(forth);
    const std::vector<float> other = separations(back);
    EXPECT_NEAR(one.front(), other.front(), 2e-5f) << i;
  }
  EXPECT_GT(touching, 900);
}

TEST(SolidCollision, FeaturesStayUnderTinyMotion) {
  const Shape<3> slab = solid_box(2.0f, 0.5f, 2.0f);
  const Shape<3> plank = solid_box(0.8f, 0.1f, 0.2f);
  const Shape<3>* lower[3] = {&slab, &kCube, &kCube};
  const Shape<3>* upper[3] = {&kCube, &kCube, &plank};
  for (int k = 0; k < 3; ++k) {
    const float height = 0.499f + upper[k]->half[1];
    const std::set<std::uint32_t> still =
        features(meet(*lower[k], at(0, 0, 0), *upper[k], at(0, height, 0)));
    ASSERT_EQ(still.size(), 4u);
    for (int i = 0; i < 64; ++i) {
      const auto sign = [&](int bit) { return (i >> bit & 1) != 0 ? 1.0f : -1.0f; };
      Pose<3> moved = at(1e-4f * sign(0), height, 1e-4f * sign(1));
      moved.rotation = compose(turn_about({{sign(2), 0, sign(3)}}, 1e-4 * (i & 16 ? 1 : 0)),
                               turn_about({{0, 1, 0}}, static_cast<double>(1e-4f * sign(5))));
      EXPECT_EQ(features(meet(*lower[k], at(0, 0, 0), *upper[k], moved)), still) << k << ' ' << i;
    }
  }
}

/// 15 axes in double; whichever axis the manifold takes is at most the tolerance worse.
TEST(SolidCollision, RandomBoxesAgreeWithEveryAxisTried) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> u(-1.0f, 1.0f);
  int overlapping = 0;
  int exact = 0;  ///< The manifold is on the very best axis.
  for (int i = 0; i < 20000; ++i) {
    const auto side = [&] { return 0.3f + 0.2f * u(random); };
    const auto pose = [&](float reach) {
      return Pose<3>{{{reach * u(random), reach * u(random), reach * u(random)}},
                     turn_about({{u(random), u(random), u(random)}}, 3.0)};
    };
    const Shape<3> a = solid_box(side(), side(), side());
    const Shape<3> b = solid_box(side(), side(), side());
    const Pose<3> pose_a = pose(0.0f);
    const Pose<3> pose_b = pose(0.7f);
    const Manifold<3> manifold = meet(a, pose_a, b, pose_b);
    expect_sound(manifold);
    const Solid solid_a = placed(a, pose_a);
    const Solid solid_b = placed(b, pose_b);
    const double best = best_gap(solid_a, solid_b);
    if (best > 0.0) continue;
    ++overlapping;
    ASSERT_GT(manifold.point_count, 0u) << i;
    const double along = axis_of(manifold.normal).between(solid_a, solid_b);
    const double size = static_cast<double>(
        std::min({a.half[0], a.half[1], a.half[2], b.half[0], b.half[1], b.half[2]}));
    const double between_faces = std::min(5e-4, 5e-3 * size);
    EXPECT_GE(along, best + 0.025 * best - std::min(2e-3, 2e-2 * size) - between_faces) << i;
    const double deepest = static_cast<double>(separations(manifold).front());
    EXPECT_GE(deepest, along - 1e-4) << i;
    EXPECT_LE(deepest, best + between_faces + 1e-4) << i;
    if (std::abs(along - best) > 1e-6) continue;
    ++exact;
    EXPECT_NEAR(deepest, best, 1e-4) << i;
  }
  EXPECT_GT(overlapping, 10000);
  EXPECT_GT(exact, 9000);
}

TEST(SolidCollision, BoxesApartNeitherExceedTheirDistanceNorMissIt) {
  std::mt19937 random(12);
  std::uniform_real_distribution<float> u(-1.0f, 1.0f);
  const float margin = 0.05f;
  int near = 0;
  for (int i = 0; i < 3000; ++i) {
    const Pose<3> pose_a = {Vec<3>::zero(), turn_about({{u(random), u(random), u(random)}}, 3.0)};
    const Vec<3> towards =
        normalized_or(Vec<3>{{u(random), u(random), u(random)}}, Vec<3>{{1, 0, 0}});
    const Shape<3> a = solid_box(0.2f, 0.3f, 0.4f);
    const Pose<3> pose_b = {0.7f * towards, turn_about({{u(random), u(random), u(random)}}, 3.0)};
    const Solid solid_a = placed(a, pose_a);
    const Solid solid_b = placed(a, pose_b);
    const double gap = best_gap(solid_a, solid_b);
    if (gap < 1e-3 || gap > 0.06) continue;
    ++near;
    const Distance distance = distance_of(solid_a, solid_b);
    const Manifold<3> manifold = meet(a, pose_a, a, pose_b, margin);
    if (distance.most < static_cast<double>(margin) - 1e-4) {
      ASSERT_GT(manifold.point_count, 0u) << i;
      EXPECT_LE(static_cast<double>(separations(manifold).front()), distance.most + 6e-4) << i;
    }
    if (distance.least > static_cast<double>(margin) + 1e-4) {
      EXPECT_EQ(manifold.point_count, 0u) << i;
    }
  }
  EXPECT_GT(near, 200);
}

}  // namespace cycloid::solver
