#include <gtest/gtest.h>

#include "solver/collision/collide.hpp"
#include "solver/queries/query.hpp"
#include "solver/queries/time_of_impact.hpp"
#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

static BodyId add_fixed(World<2>& world, const Vec<2>& position, const ShapeDef<2>& shape,
                        float angle = 0.0f) {
  BodyDef<2> def;
  def.kind = BodyKind::kStatic;
  def.position = position;
  def.rotation = turned(angle);
  return add(world, def, shape);
}

static ShapeDef<2> edge(Vec<2> from, Vec<2> to) {
  ShapeDef<2> shape;
  shape.kind = ShapeKind::kChain;
  shape.points = {from, to};
  return shape;
}

static Probe<2> ball_probe(float radius) {
  Probe<2> probe;
  probe.radius = radius;
  return probe;
}

static Probe<2> box_probe(float half_x, float half_y) {
  Probe<2> probe;
  probe.count = 4;
  probe.points[0] = {{-half_x, -half_y}};
  probe.points[1] = {{half_x, -half_y}};
  probe.points[2] = {{half_x, half_y}};
  probe.points[3] = {{-half_x, half_y}};
  return probe;
}

TEST(RayCast, MeetsEveryKindWhereItIs) {
  World<2> world = make_world<2>();
  add_fixed(world, {{2.0f, 0.0f}}, ball<2>(0.5f));
  add_fixed(world, {{5.0f, 0.0f}}, box(0.5f, 1.0f));
  add_fixed(world, {{8.0f, 0.0f}}, capsule(0.5f, 0.25f));
  ShapeDef<2> rounded = box(0.5f, 0.5f);
  rounded.radius = 0.1f;
  add_fixed(world, {{11.0f, 0.0f}}, rounded);
  // Solid to the right of its direction: downwards leaves the side of smaller x free.
  add_fixed(world, {{14.0f, 0.0f}}, edge({{0.0f, -1.0f}}, {{0.0f, 1.0f}}));
  add_fixed(world, {{15.0f, 0.0f}}, edge({{0.0f, 1.0f}}, {{0.0f, -1.0f}}));
  add_ground<2>(world, {{-1.0f, 0.0f}});
  ASSERT_TRUE(world.set_pose({6, 0}, {{19.0f, 0.0f}}, turned(0.0f)).ok());
  const auto hits = ray_cast<2>(world.state(), {{0.0f, 0.0f}}, {{20.0f, 0.0f}}, {});
  std::vector<float> ways;
  for (const QueryHit<2>& hit : hits) {
    ways.push_back(20.0f * hit.fraction);
    EXPECT_NEAR(hit.normal[0], -1.0f, 1.0e-6f);
    EXPECT_NEAR(hit.point[0], 20.0f * hit.fraction, 1.0e-5f);
  }
  const bool first_edge_is_free = hits.size() == 6 && hits[4].body.index == 4;
  const std::vector<float> expected = {1.5f, 4.5f, 7.25f, 10.4f, first_edge_is_free ? 14.0f : 15.0f,
                                       19.0f};
  ASSERT_EQ(ways.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(ways[i], expected[i], 1.0e-5f) << i;
  EXPECT_EQ(ray_cast_first<2>(world.state(), {{20.0f, 0.9f}}, {{0.0f, 0.9f}}, {})->body.index, 6u);
}

TEST(RayCast, MissesRoundCornersAndStartsInside) {
  World<2> world = make_world<2>();
  add_fixed(world, {{0.0f, 0.0f}}, ball<2>(1.0f));
  EXPECT_FALSE(ray_cast_first<2>(world.state(), {{-5.0f, 1.001f}}, {{5.0f, 1.001f}}, {}));
  EXPECT_TRUE(ray_cast_first<2>(world.state(), {{-5.0f, 0.999f}}, {{5.0f, 0.999f}}, {}));
  const auto inside = ray_cast_first<2>(world.state(), {{0.2f, 0.0f}}, {{5.0f, 0.0f}}, {});
  ASSERT_TRUE(inside);
  EXPECT_EQ(inside->fraction, 0.0f);
  EXPECT_EQ(inside->normal[0], -1.0f);
  EXPECT_FALSE(ray_cast_first<2>(world.state(), {{2.0f, 0.0f}}, {{5.0f, 0.0f}}, {}));
  const auto glancing = ray_cast_first<2>(world.state(), {{-1000.0f, 0.6f}}, {{0.0f, 0.6f}}, {});
  ASSERT_TRUE(glancing);
  EXPECT_NEAR(glancing->point[0], -0.8f, 1.0e-4f);
}

TEST(RayCast, InSpaceToo) {
  World<3> world = make_world<3>();
  add_ground<3>(world, up<3>());
  add_at<3>(world, {{0.0f, 2.0f, 0.0f}}, ball<3>(0.5f));
  const auto hits = ray_cast<3>(world.state(), {{0.0f, 5.0f, 0.3f}}, {{0.0f, -5.0f, 0.3f}}, {});
  ASSERT_EQ(hits.size(), 2u);
  EXPECT_NEAR(hits[0].fraction, 0.5f, 1.0e-6f);
  EXPECT_NEAR(hits[1].point[1], 2.4f, 1.0e-5f);
  EXPECT_NEAR(hits[1].normal[2], 0.6f, 1.0e-5f);
}

TEST(Query, ObeysFiltersAndIgnoresOne) {
  World<2> world = make_world<2>();
  ShapeDef<2> shape = ball<2>(0.5f);
  shape.filter = {2, 0xffffffffu, 0};
  const BodyId first = add_at<2>(world, {{2.0f, 0.0f}}, shape);
  shape.filter = {1, 4, 0};
  const BodyId second = add_at<2>(world, {{4.0f, 0.0f}}, shape);
  const auto bodies = [&](const QueryFilter& filter) {
    std::vector<BodyId> met;
    for (const auto& hit : ray_cast<2>(world.state(), {{0.0f, 0.0f}}, {{9.0f, 0.0f}}, filter))
      met.push_back(hit.body);
    return met;
  };
  EXPECT_EQ(bodies({{4, 0xffffffffu, 0}, {}}), (std::vector<BodyId>{first, second}));
  EXPECT_EQ(bodies({{1, 0xffffffffu, 0}, {}}), (std::vector<BodyId>{first}));
  EXPECT_EQ(bodies({{4, 1, 0}, {}}), (std::vector<BodyId>{second}));
  EXPECT_EQ(bodies({{4, 0xffffffffu, 0}, first}), (std::vector<BodyId>{second}));
}

TEST(Overlap, ListsInSlotOrderWithDepths) {
  World<2> world = make_world<2>();
  add_fixed(world, {{0.9f, 0.0f}}, box(0.5f, 0.5f));
  add_fixed(world, {{-0.8f, 0.0f}}, ball<2>(0.5f));
  add_fixed(world, {{0.0f, 5.0f}}, ball<2>(0.5f));
  const Pose<2> pose{{{0.0f, 0.0f}}, turned(0.0f)};
  const auto hits = overlap(world.state(), ball_probe(0.35f), pose, 0.1f, {});
  ASSERT_EQ(hits.size(), 2u);
  EXPECT_NEAR(hits[0].separation, 0.05f, 1.0e-6f);
  EXPECT_NEAR(hits[0].normal[0], -1.0f, 1.0e-6f);
  EXPECT_NEAR(hits[0].point[0], 0.4f, 1.0e-6f);
  EXPECT_NEAR(hits[1].separation, -0.05f, 1.0e-6f);
  EXPECT_NEAR(hits[1].normal[0], 1.0f, 1.0e-6f);
}

TEST(ClosestPoint, OutsideAndInside) {
  World<2> world = make_world<2>();
  add_fixed(world, {{0.0f, 0.0f}}, box(1.0f, 2.0f));
  const auto outside = closest_point<2>(world.state(), {{4.0f, 6.0f}}, 10.0f, {});
  ASSERT_TRUE(outside);
  EXPECT_NEAR(outside->separation, 5.0f, 1.0e-5f);
  EXPECT_NEAR(outside->point[0], 1.0f, 1.0e-5f);
  EXPECT_NEAR(outside->normal[1], 0.8f, 1.0e-5f);
  const auto inside = closest_point<2>(world.state(), {{0.7f, 0.0f}}, 10.0f, {});
  ASSERT_TRUE(inside);
  EXPECT_NEAR(inside->separation, -0.3f, 1.0e-6f);
  EXPECT_NEAR(inside->point[0], 1.0f, 1.0e-6f);
  EXPECT_FALSE(closest_point<2>(world.state(), {{4.0f, 6.0f}}, 4.9f, {}));
}

TEST(ShapeCast, StopsAtTheSurface) {
  World<2> world = make_world<2>();
  add_fixed(world, {{500.0f, 0.0f}}, box(0.01f, 2.0f));
  const Pose<2> pose{{{0.0f, 0.0f}}, turned(0.0f)};
  const auto fast = shape_cast_first(world.state(), ball_probe(0.05f), pose, {{1000.0f, 0.0f}}, {});
  ASSERT_TRUE(fast);
  EXPECT_NEAR(1000.0f * fast->fraction, 499.94f, 1.0e-3f);
  EXPECT_NEAR(fast->normal[0], -1.0f, 1.0e-6f);
  // A box turned by 45 degrees meets a box with its corner.
  const Pose<2> corner{{{490.0f, 0.0f}}, turned(0.785398163f)};
  const auto touch =
      shape_cast_first(world.state(), box_probe(0.5f, 0.5f), corner, {{20.0f, 0.0f}}, {});
  ASSERT_TRUE(touch);
  EXPECT_NEAR(20.0f * touch->fraction, 9.99f - std::sqrt(0.5f), 1.0e-3f);
  EXPECT_FALSE(
      shape_cast_first(world.state(), ball_probe(0.05f), pose, {{1000.0f, 10.0f}}, {}).has_value());
}

TEST(ShapeCast, FromOverlapItMeetsOnlyWhatItMovesInto) {
  World<2> world = make_world<2>();
  add_fixed(world, {{0.0f, 0.0f}}, box(1.0f, 1.0f));
  const Pose<2> pose{{{1.2f, 0.0f}}, turned(0.0f)};
  EXPECT_FALSE(shape_cast_first(world.state(), ball_probe(0.3f), pose, {{1.0f, 0.0f}}, {}));
  const auto deeper = shape_cast_first(world.state(), ball_probe(0.3f), pose, {{-1.0f, 0.0f}}, {});
  ASSERT_TRUE(deeper);
  EXPECT_EQ(deeper->fraction, 0.0f);
}

TEST(ShapeCast, ChainsAreMetFromTheirFreeSideAlongTheirWholeLength) {
  World<2> world = make_world<2>();
  ShapeDef<2> ground;
  ground.kind = ShapeKind::kChain;
  for (int i = 10; i >= -10; --i)
    ground.points.push_back({{static_cast<float>(i), 0.1f * static_cast<float>(i & 1)}});
  const BodyId id = add_fixed(world, {{0.0f, 0.0f}}, ground);
  const bool up_is_free =
      ray_cast_first<2>(world.state(), {{0.3f, 5.0f}}, {{0.3f, -5.0f}}, {}).has_value();
  const float side = up_is_free ? 1.0f : -1.0f;
  for (float x = -9.0f; x < 9.0f; x += 0.37f) {
    const Pose<2> pose{{{x, 3.0f * side}}, turned(0.0f)};
    const auto hit =
        shape_cast_first(world.state(), ball_probe(0.2f), pose, {{0.0f, -6.0f * side}}, {});
    ASSERT_TRUE(hit) << x;
    EXPECT_EQ(hit->body, id);
    EXPECT_NEAR(hit->fraction, 0.47f, 0.02f) << x;
    const Pose<2> behind{{{x, -3.0f * side}}, turned(0.0f)};
    EXPECT_FALSE(
        shape_cast_first(world.state(), ball_probe(0.2f), behind, {{0.0f, 6.0f * side}}, {}))
        << x;
  }
}

/// Least separation over many samples of a sweep, in slices too fine to step over the peg.
static float sampled_gap(const Shape<2>& a, const BodySweep<2>& sweep_a, const Shape<2>& b,
                         const BodySweep<2>& sweep_b, float until, int samples) {
  float least = 1.0e9f;
  for (int i = 0; i <= samples; ++i) {
    const float fraction = until * static_cast<float>(i) / static_cast<float>(samples);
    const Manifold<2> manifold =
        collide(a, pose_at(sweep_a, fraction), b, pose_at(sweep_b, fraction), 1.0e9f);
    for (std::uint32_t p = 0; p < manifold.point_count; ++p)
      least = std::min(least, manifold.points[p].separation);
  }
  return least;
}

TEST(TimeOfImpact, ASpinningRodMeetsTheSmallPeg) {
  const Shape<2> rod = shape_of(box_probe(1.0f, 0.01f));
  const Shape<2> peg = shape_of(ball_probe(0.02f));
  const BodySweep<2> spinning{{{{0.0f, 0.0f}}, turned(0.0f)}, {{0.016f, 0.0f}}, {{50.0f / 60.0f}}};
  const BodySweep<2> still{{{{0.6f, 0.5f}}, turned(0.0f)}, {{0.0f, 0.0f}}, {{0.0f}}};
  const Impact<2> impact = time_of_impact(rod, spinning, peg, still, 0.0f, 1.0e-4f);
  ASSERT_TRUE(impact.hit);
  EXPECT_GT(sampled_gap(rod, spinning, peg, still, impact.fraction - 0.002f, 400), 0.0f);
  EXPECT_LT(sampled_gap(rod, spinning, peg, still, impact.fraction + 0.002f, 400), 1.0e-3f);
}

// Whatever flies at whatever: never later than the true impact, never a miss.
TEST(TimeOfImpact, NeverPassesThroughOver3000RandomWays) {
  std::uint64_t seed = 12345;
  const auto random = [&](float low, float high) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * static_cast<float>(seed >> 40) / 16777216.0f;
  };
  const std::array<Shape<2>, 4> shapes = {shape_of(ball_probe(0.1f)),
                                          shape_of(box_probe(0.5f, 0.02f)),
                                          shape_of(box_probe(0.3f, 0.3f)), [] {
                                            Probe<2> probe;
                                            probe.count = 2;
                                            probe.radius = 0.05f;
                                            probe.points[0] = {{-0.4f, 0.0f}};
                                            probe.points[1] = {{0.4f, 0.0f}};
                                            return shape_of(probe);
                                          }()};
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    const Shape<2>& a = shapes[static_cast<std::size_t>(random(0.0f, 3.99f))];
    const Shape<2>& b = shapes[static_cast<std::size_t>(random(0.0f, 3.99f))];
    const BodySweep<2> sweep_a{{{{random(-2, 2), random(-2, 2)}}, turned(random(-3, 3))},
                               {{random(-4, 4), random(-4, 4)}},
                               {{random(-2, 2)}}};
    const BodySweep<2> sweep_b{{{{random(-2, 2), random(-2, 2)}}, turned(random(-3, 3))},
                               {{random(-1, 1), random(-1, 1)}},
                               {{random(-1, 1)}}};
    if (sampled_gap(a, sweep_a, b, sweep_b, 0.0f, 1) < 0.01f) continue;
    const Impact<2> impact = time_of_impact(a, sweep_a, b, sweep_b, 0.005f, 1.0e-3f);
    hits += impact.hit ? 1 : 0;
    const float until = impact.hit ? impact.fraction : 1.0f;
    ASSERT_GT(sampled_gap(a, sweep_a, b, sweep_b, until, 200), 0.003f) << i;
  }
  EXPECT_GT(hits, 250);
}

}  // namespace cycloid::solver
