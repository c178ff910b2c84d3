#include "tests/solver/query_fixture.hpp"

namespace cycloid::solver {

TEST(RayCast, MeetsEachKindWhereItsSurfaceIs) {
  struct Case {
    ShapeDef<2> shape;
    Vec<2> from, to;
    float fraction;
    Vec<2> normal;
  };
  ShapeDef<2> plane;
  plane.kind = ShapeKind::kHalfSpace;
  plane.normal = {{0.0f, 1.0f}};
  plane.offset = 1.0f;
  ShapeDef<2> rounded = box(1.0f, 1.0f);
  rounded.radius = 0.5f;
  const float half = std::sqrt(0.5f);
  const Case cases[] = {
      {ball<2>(1.0f), {{-5, 0}}, {{5, 0}}, 0.4f, {{-1, 0}}},
      {ball<2>(1.0f), {{-5, 0.6f}}, {{5, 0.6f}}, 0.42f, {{-0.8f, 0.6f}}},
      {capsule(1.0f, 0.5f), {{0.25f, 4}}, {{0.25f, -4}}, 3.5f / 8, {{0, 1}}},
      {capsule(1.0f, 0.5f), {{6, 0.3f}}, {{0, 0.3f}}, (5 - 0.4f) / 6, {{0.8f, 0.6f}}},
      {box(1.0f, 2.0f), {{-5, 1}}, {{3, 1}}, 0.5f, {{-1, 0}}},
      {rounded, {{0.5f, 9.5f}}, {{0.5f, 1.5f}}, 1.0f, {{0, 1}}},
      {rounded, {{3, 3}}, {{1, 1}}, 1 - 0.25f * half, {{half, half}}},
      {plane, {{3, 5}}, {{7, -3}}, 0.5f, {{0, 1}}},
      {chain({{{-1, 0}}, {{1, 0}}}), {{0.5f, 1}}, {{0.5f, -3}}, 0.25f, {{0, 1}}},
  };
  for (const Case& c : cases) {
    World<2> world = make_world<2>();
    const BodyId id = add_static(world, {{0.0f, 0.0f}}, c.shape);
    const auto hits = ray_cast(world.state(), c.from, c.to, {});
    ASSERT_EQ(hits.size(), 1u) << "fraction " << c.fraction;
    EXPECT_EQ(hits[0].body, id);
    EXPECT_NEAR(hits[0].fraction, c.fraction, kRound);
    expect_near(hits[0].normal, c.normal);
    expect_near(hits[0].point, c.from + c.fraction * (c.to - c.from), 4e-6f);
    EXPECT_EQ(hits[0].separation, 0.0f);
    // Stopped short of the surface, and away from it, the same ray meets nothing.
    const Vec<2> short_of = c.from + (c.fraction - 1e-3f) * (c.to - c.from);
    EXPECT_TRUE(ray_cast(world.state(), c.from, short_of, {}).empty());
    EXPECT_TRUE(ray_cast(world.state(), short_of, c.from, {}).empty());
  }
}

TEST(RayCast, PassesSegmentsFromBehindAndTangents) {
  World<2> world = make_world<2>();
  add_static(world, {{0, 0}}, chain({{{-1, 0}}, {{1, 0}}}));
  add_static(world, {{10, 0}}, box(1, 1));
  EXPECT_TRUE(ray_cast(world.state(), {{0, -1}}, {{0, 1}}, {}).empty());
  EXPECT_TRUE(ray_cast(world.state(), {{8, 1}}, {{12, 1}}, {}).empty());
  EXPECT_TRUE(ray_cast(world.state(), {{8, -1}}, {{12, -1}}, {}).empty());
}

TEST(RayCast, StartsInsideAtFractionZeroAgainstItsWay) {
  World<2> world = make_world<2>();
  add_static(world, {{0, 0}}, box(1, 1));
  const auto hit = ray_cast_first(world.state(), {{0.5f, 0}}, {{0.5f, 4}}, {});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->fraction, 0.0f);
  expect_near(hit->normal, {{0, -1}}, 0.0f);
  expect_near(hit->point, {{0.5f, 0}}, 0.0f);
  const auto still = ray_cast_first(world.state(), {{0.5f, 0}}, {{0.5f, 0}}, {});
  ASSERT_TRUE(still);
  expect_near(still->normal, {{1, 0}}, 0.0f);
}

/// No ray slips between two edges, whichever way their shared point rounds.
TEST(RayCast, SlipsThroughNoCornerOfAPolygonAndNoJointOfAChain) {
  World<2> world = make_world<2>();
  const Vec<2> joint = {{0.1f, 0.3f}};
  add_static(world, {{0, 0}}, chain({{{-2.9f, 0.1f}}, joint, {{3.3f, -0.7f}}}), 0.3f);
  add_static(world, {{20, 0}}, box(0.7f, 0.3f), 0.77f);
  const Vec<2> at = rotate(turned(0.3f), joint);
  const Vec<2> corner = Vec<2>{{20, 0}} + rotate(turned(0.77f), Vec<2>{{0.7f, 0.3f}});
  for (int i = 0; i < 500; ++i) {
    const float angle = 0.4f + 2.0f * static_cast<float>(i) / 500.0f;
    const Vec<2> way = {{7.0f * std::cos(angle), 7.0f * std::sin(angle)}};
    EXPECT_TRUE(ray_cast_first(world.state(), at + way, at - way, {})) << "angle " << angle;
    const float steep = 0.87f + 0.9f * static_cast<float>(i) / 500.0f;
    const Vec<2> in = {{7.0f * std::cos(steep), 7.0f * std::sin(steep)}};
    EXPECT_TRUE(ray_cast_first(world.state(), corner + in, corner - in, {})) << steep;
  }
}

}  // namespace cycloid::solver
