#include <gtest/gtest.h>

#include "solver/queries/casting.hpp"
#include "solver/queries/query.hpp"
#include "tests/solver/cast_3d_fixture.hpp"

namespace cycloid::solver {

static void expect_ray(const WorldState<3>& state, Vec<3> from, Vec<3> to, float fraction,
                       Vec<3> normal) {
  const auto hit = ray_cast_first(state, from, to, {});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->fraction, fraction, kRound);
  expect_near(hit->normal, normal, 4e-6f);
  expect_near(hit->point, from + hit->fraction * (to - from), 4e-6f);
}
static bool misses(const WorldState<3>& state, Vec<3> from, Vec<3> to) {
  return ray_cast(state, from, to, {}).empty();
}

TEST(SolidQueries, RaysMeetBoxesAtTheirFaces) {
  const WorldState<3> box = state_of(solid_box({{1, 2, 3}}), {{5, 0, 0}});
  expect_ray(box, {{0, 1.5f, 2.5f}}, {{10, 1.5f, 2.5f}}, 0.4f, {{-1, 0, 0}});
  expect_ray(box, {{5, -6, 0}}, {{5, 6, 1}}, 1 / 3.0f, {{0, -1, 0}});
  EXPECT_TRUE(misses(box, {{0, 2.001f, 0}}, {{10, 2.001f, 0}}));
  EXPECT_TRUE(misses(box, {{0, 2, 0}}, {{10, 2, 0}}));  // Runs in the face.
  EXPECT_TRUE(misses(box, {{0, 0, 0}}, {{3.99f, 0, 0}}));
  expect_ray(box, {{5, 0, 0}}, {{9, 0, 0}}, 0, {{-1, 0, 0}});  // Starts inside.
  const float r = std::sqrt(0.5f);
  const WorldState<3> turned =
      state_of(solid_box({{1, 1, 1}}), {{5, 0, 0}}, turned_about({{0, 0, 1}}, 0.78539816f));
  expect_ray(turned, {{0, 0.2f, 0}}, {{10, 0.2f, 0}}, 0.1f * (5 - std::sqrt(2.0f) + 0.2f),
             {{-r, r, 0}});
}

TEST(SolidQueries, RaysMeetCapsulesAndHulls) {
  const WorldState<3> rod = state_of(solid_capsule({{0, -1, 0}}, {{0, 1, 0}}, 0.5f), {{4, 0, 0}});
  expect_ray(rod, {{0, 0.7f, 0.3f}}, {{10, 0.7f, 0.3f}}, 0.36f, {{-0.8f, 0, 0.6f}});
  expect_ray(rod, {{0, 1.3f, 0}}, {{10, 1.3f, 0}}, 0.36f, {{-0.8f, 0.6f, 0}});
  expect_ray(rod, {{4, 9, 0}}, {{4, -1, 0}}, 0.75f, {{0, 1, 0}});
  EXPECT_TRUE(misses(rod, {{0, 0, 0.501f}}, {{10, 0, 0.501f}}));
  EXPECT_TRUE(misses(rod, {{0, 1.501f, 0}}, {{10, 1.501f, 0}}));
  Polyhedra pools;
  const Shape<3> octahedron = solid_hull(
      {{{2, 0, 0}}, {{-2, 0, 0}}, {{0, 2, 0}}, {{0, -2, 0}}, {{0, 0, 2}}, {{0, 0, -2}}}, pools);
  const WorldState<3> hull = state_of({{octahedron, pose_of<3>({{5, 0, 0}})}}, pools);
  const float r = std::sqrt(1 / 3.0f);
  expect_ray(hull, {{0, 0.5f, 0.5f}}, {{10, 0.5f, 0.5f}}, 0.4f, {{-r, r, r}});
  EXPECT_TRUE(misses(hull, {{0, 1.01f, 1.01f}}, {{10, 1.01f, 1.01f}}));
}

TEST(SolidQueries, RaysMeetTrianglesFromTheFreeSideAndSlipThroughNoSeam) {
  const Shape<3> left = solid_triangle({{-1, 0, -1}}, {{-1, 0, 1}}, {{1, 0, 1}});
  const Shape<3> right = solid_triangle({{-1, 0, -1}}, {{1, 0, 1}}, {{1, 0, -1}});
  const WorldState<3> square =
      state_of({{left, pose_of<3>({{0, 0, 0}})}, {right, pose_of<3>({{0, 0, 0}})}});
  expect_ray(square, {{0.2f, 1, 0.5f}}, {{0.2f, -3, 0.5f}}, 0.25f, {{0, 1, 0}});
  EXPECT_TRUE(misses(square, {{0.2f, -1, 0.5f}}, {{0.2f, 3, 0.5f}}));
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    const float at = uniform(random, -0.9f, 0.9f);
    const Vec<3> from = {
        {uniform(random, -3, 3), uniform(random, 0.5f, 3), uniform(random, -3, 3)}};
    const Vec<3> seam = {{at, 0, at}};
    EXPECT_FALSE(misses(square, from, from + 2.0f * (seam - from))) << i;
  }
}

/// Rays straight through a corner of a height field, whichever way the six triangles there round.
TEST(SolidQueries, RaysSlipThroughNoCornerOfAHeightField) {
  World<3> world = make_world<3>();
  BodyDef<3> def;
  def.kind = BodyKind::kStatic;
  ShapeDef<3> field;
  field.kind = ShapeKind::kHeightField;
  field.columns = 5;
  field.cell = {1, 1};
  field.heights.assign(25, 0.0f);
  add(world, def, field);
  for (int i = -40; i <= 40; ++i)
    for (int k = -40; k <= 40; ++k) {
      const Vec<3> lean = {{0.1f * static_cast<float>(i), 9, 0.1f * static_cast<float>(k)}};
      const Vec<3> corner = {{2, 0, 1}};
      EXPECT_TRUE(ray_cast_first(world.state(), corner + lean, corner - lean, {})) << i << " " << k;
    }
}

TEST(SolidQueries, CastsOfBallsMeetFacesEdgesAndCorners) {
  const WorldState<3> box = state_of(solid_box({{1, 1, 1}}), {{5, 0, 0}});
  const auto fraction = [&](float y, float z) {
    const auto hit =
        shape_cast_first(box, ball_probe<3>(0.5f), pose_of<3>({{0, y, z}}), {{10, 0, 0}}, {});
    return hit ? hit->fraction : 2.0f;
  };
  EXPECT_NEAR(fraction(0.3f, -0.6f), 0.35f, kRound);
  EXPECT_NEAR(fraction(1.3f, 0), 0.1f * (4 - 0.4f), kRound);
  EXPECT_NEAR(fraction(1.3f, 1.0f), 0.1f * (4 - 0.4f), kRound);
  EXPECT_NEAR(fraction(1.2f, 1.2f), 0.1f * (4 - std::sqrt(0.25f - 0.08f)), kRound);
  EXPECT_EQ(fraction(1.51f, 0), 2.0f);
  EXPECT_EQ(fraction(1.4f, 1.4f), 2.0f);
}

TEST(SolidQueries, CastsOfCapsulesAndBoxesMeetSolids) {
  const WorldState<3> box = state_of(solid_box({{1, 1, 1}}), {{5, 0, 0}});
  // A capsule across the edge of the box, and along its face.
  const auto rod = shape_cast_first(box, capsule_probe({{0, 0, -2}}, {{0, 0, 2}}, 0.5f),
                                    pose_of<3>({{0, 1.3f, 0}}), {{10, 0, 0}}, {});
  ASSERT_TRUE(rod);
  EXPECT_NEAR(rod->fraction, 0.36f, kRound);
  expect_near(rod->normal, {{-0.8f, 0.6f, 0}}, 1e-4f);
  const auto block = shape_cast_first(box, block_probe({{0.5f, 0.5f, 0.5f}}),
                                      pose_of<3>({{0, 1.4f, 1.4f}}), {{10, 0, 0}}, {});
  ASSERT_TRUE(block);
  EXPECT_NEAR(block->fraction, 0.35f, kRound);
  expect_near(block->normal, {{-1, 0, 0}}, 1e-5f);
  EXPECT_FALSE(shape_cast_first(box, block_probe({{0.5f, 0.5f, 0.5f}}),
                                pose_of<3>({{0, 1.501f, 0}}), {{10, 0, 0}}, {}));
  const WorldState<3> plane = state_of(solid_half_space({{0, 1, 0}}, 1.0f));
  const auto fall =
      shape_cast_first(plane, block_probe({{0.5f, 0.5f, 0.5f}}),
                       {{{3, 5, 0}}, turned_about({{0, 0, 1}}, 0.78539816f)}, {{0, -10, 0}}, {});
  ASSERT_TRUE(fall);
  EXPECT_NEAR(fall->fraction, 0.1f * (4 - std::sqrt(0.5f)), kRound);
  const WorldState<3> floor = state_of(solid_triangle({{-4, 0, -4}}, {{-4, 0, 4}}, {{4, 0, 0}}));
  const auto down = [&](float from, float way) {
    const auto hit = shape_cast_first(floor, block_probe({{0.5f, 0.5f, 0.5f}}),
                                      pose_of<3>({{-1, from, 0}}), {{0, way, 0}}, {});
    return hit ? hit->fraction : 2.0f;
  };
  EXPECT_NEAR(down(3, -5), 0.5f, kRound);
  EXPECT_EQ(down(-3, 5), 2.0f);
}

TEST(SolidQueries, OverlapAndClosestPointTellDepthAndSide) {
  const WorldState<3> box = state_of(solid_box({{1, 1, 1}}), {{5, 0, 0}});
  const auto in = overlap(box, capsule_probe({{0, -1, 0}}, {{0, 1, 0}}, 0.25f),
                          pose_of<3>({{5.9f, 0, 0}}), 0.0f, {});
  ASSERT_EQ(in.size(), 1u);
  EXPECT_NEAR(in[0].separation, -0.35f, kRound);
  expect_near(in[0].normal, {{1, 0, 0}});
  expect_near(Vec<3>{{in[0].point[0], 0, 0}}, {{6, 0, 0}});
  EXPECT_TRUE(overlap(box, ball_probe<3>(1), pose_of<3>({{5, 2.01f, 0}}), 0.0f, {}).empty());
  EXPECT_EQ(overlap(box, ball_probe<3>(1), pose_of<3>({{5, 2.01f, 0}}), 0.02f, {}).size(), 1u);
  const auto inside = closest_point(box, {{5, 0.7f, 0.2f}}, 1.0f, {});
  ASSERT_TRUE(inside);
  EXPECT_NEAR(inside->separation, -0.3f, kRound);
  expect_near(inside->point, {{5, 1, 0.2f}});
  const auto corner = closest_point(box, {{7, 3, -2}}, 10.0f, {});
  ASSERT_TRUE(corner);
  EXPECT_NEAR(corner->separation, std::sqrt(1.0f + 4.0f + 1.0f), kRound);
  expect_near(corner->point, {{6, 1, -1}});
  const WorldState<3> floor = state_of(solid_triangle({{-4, 0, -4}}, {{-4, 0, 4}}, {{4, 0, 0}}));
  EXPECT_EQ(overlap(floor, ball_probe<3>(0.5f), pose_of<3>({{0, 0.4f, 0}}), 0.0f, {}).size(), 1u);
  EXPECT_TRUE(overlap(floor, ball_probe<3>(0.5f), pose_of<3>({{0, -0.4f, 0}}), 0.0f, {}).empty());
  EXPECT_TRUE(closest_point(floor, {{0, 0.4f, 0}}, 1.0f, {}));
  EXPECT_FALSE(closest_point(floor, {{0, -0.4f, 0}}, 1.0f, {}));
}

TEST(SolidQueries, OverlapOfAHullProbeIsAsDeepAsItsFacesTell) {
  Probe<3> probe;  // A corner cut from a cube: the slanted face is 1 / sqrt(3) from the origin.
  probe.count = 4;
  probe.points[1] = {{1, 0, 0}};
  probe.points[2] = {{0, 1, 0}};
  probe.points[3] = {{0, 0, 1}};
  const float slant = 1.0f / std::sqrt(3.0f);
  const auto hits =
      overlap(state_of(solid_ball(0.1f)), probe, pose_of<3>({{-0.3f, -0.3f, -0.3f}}), 0.0f, {});
  ASSERT_EQ(hits.size(), 1u);
  EXPECT_NEAR(hits[0].separation, -(slant - 0.9f * slant + 0.1f), kRound);
  expect_near(hits[0].normal, {{-slant, -slant, -slant}});
}

static Shape<3> random_solid(std::mt19937& random, Polyhedra& pools) {
  const Vec<3> half = {
      {uniform(random, 0.05f, 1), uniform(random, 0.05f, 1), uniform(random, 0.05f, 1)}};
  switch (random() % 4) {
    case 0:
      return solid_ball(0.4f);
    case 1:
      return solid_capsule(random_vector(random, 1), random_vector(random, 1), 0.2f);
    case 2:
      return solid_box(half, random_vector(random, 0.2f), random_rotation(random));
    default:
      return solid_hull(random_corners(random, 4 + static_cast<int>(random() % 12), half), pools);
  }
}

/// The cast against the distance at the fraction it reports, and at fractions before.
TEST(SolidQueries, CastsEndWhereTheSurfacesTouchAndNeverBeyond) {
  std::mt19937 random(17);
  int hits = 0;
  for (int i = 0; i < 10000; ++i) {
    Polyhedra pools;
    const Shape<3> shape = random_solid(random, pools);
    const WorldState<3> state =
        state_of({{shape, {random_vector(random, 0.3f), random_rotation(random)}}}, pools);
    Probe<3> probe = ball_probe<3>(i % 2 == 0 ? 0.0f : 0.3f);
    if (i % 4 == 1)
      probe = capsule_probe(random_vector(random, 0.5f), random_vector(random, 0.5f), 0.1f);
    if (i % 4 == 2) probe = block_probe({{0.3f, 0.2f, 0.1f}});
    const Pose<3> from{4.0f * normalized_or(random_vector(random, 1), {{1, 0, 0}}),
                       random_rotation(random)};
    const Vec<3> way = random_vector(random, 1.5f) - 2.0f * from.position;
    const auto distance = [&](float fraction) {
      const auto hit =
          overlap(state, probe, {from.position + fraction * way, from.rotation}, 20.0f, {});
      return hit.empty() ? 20.0f : hit[0].separation;
    };
    const auto hit = shape_cast_first(state, probe, from, way, {});
    if (!hit) {
      for (int k = 0; k <= 32; ++k) ASSERT_GT(distance(static_cast<float>(k) / 32), -2e-5f) << i;
      continue;
    }
    ++hits;
    ASSERT_NEAR(distance(hit->fraction), 0, 2e-5f) << i;
    ASSERT_NEAR(length(hit->normal), 1, 1e-5f) << i;
    ASSERT_LT(dot(hit->normal, way), 0) << i;
    for (int k = 0; k < 8; ++k)
      ASSERT_GT(distance(hit->fraction * static_cast<float>(k) / 8), -1e-6f) << i;
  }
  EXPECT_GT(hits, 3000);
  EXPECT_LT(hits, 9000);
}

TEST(SolidQueries, QueriesOfOnePointAgree) {
  std::mt19937 random(23);
  int rays = 0;
  for (int i = 0; i < 10000; ++i) {
    Polyhedra pools;
    const Shape<3> shape = random_solid(random, pools);
    const WorldState<3> state =
        state_of({{shape, {random_vector(random, 0.3f), random_rotation(random)}}}, pools);
    const Vec<3> from = random_vector(random, 3);
    const Vec<3> to = random_vector(random, 1) - from;
    const auto near = overlap(state, ball_probe<3>(0), pose_of(from), 20.0f, {});
    const auto closest = closest_point(state, from, 20.0f, {});
    ASSERT_EQ(near.size(), 1u);
    ASSERT_TRUE(closest);
    EXPECT_EQ(near[0].separation, closest->separation) << i;
    EXPECT_NEAR(length(closest->point - from), std::abs(closest->separation), 3e-6f) << i;
    const auto ray = ray_cast_first(state, from, to, {});
    if (near[0].separation < 0) {
      ASSERT_TRUE(ray);
      EXPECT_EQ(ray->fraction, 0.0f);
      continue;
    }
    const auto cast = shape_cast_first(state, ball_probe<3>(0), pose_of(from), to - from, {});
    ASSERT_EQ(ray.has_value(), cast.has_value()) << i;
    if (!ray) continue;
    ++rays;
    EXPECT_EQ(ray->fraction, cast->fraction) << i;
  }
  EXPECT_GT(rays, 1000);
}

TEST(SolidQueries, WorkFarFromTheOriginAndWithAWorldsOwnShapes) {
  World<3> world = make_world<3>();
  BodyDef<3> def;
  def.kind = BodyKind::kStatic;
  def.position = {{50000, 0, -30000}};
  ShapeDef<3> shape;
  shape.kind = ShapeKind::kBox;
  shape.half = {{500, 0.5f, 500}};
  const BodyId floor = add(world, def, shape);
  const auto ray = ray_cast_first(world.state(), {{50000, 10, -30000}}, {{50001, -10, -30000}}, {});
  ASSERT_TRUE(ray);
  EXPECT_EQ(ray->body, floor);
  EXPECT_NEAR(ray->fraction, 9.5f / 20, kRound);
  const auto cast =
      shape_cast_first(world.state(), capsule_probe({{0, 0, 0}}, {{0.3f, 1, 0}}, 0.25f),
                       pose_of<3>({{50000, 10, -30000}}), {{3, -20, 2}}, {});
  ASSERT_TRUE(cast);
  EXPECT_NEAR(cast->fraction, (10 - 0.75f) / 20, 5e-6f);
  expect_near(cast->normal, {{0, 1, 0}}, 1e-4f);
}

}  // namespace cycloid::solver
