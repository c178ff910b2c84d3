#include <gtest/gtest.h>

#include "solver/queries/time_of_impact.hpp"
#include "tests/solver/impact_fixture.hpp"
#include "tests/solver/query_3d_fixture.hpp"
#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

static BodySweep<3> way_of(Vec<3> from, Vec<3> translation, Vec<3> turn = Vec<3>::zero(),
                           Rotation<3> rotation = identity_rotation<3>()) {
  return {{from, rotation}, translation, turn};
}
static BodySweep<3> at_rest(Vec<3> at = Vec<3>::zero()) {
  return way_of(at, Vec<3>::zero());
}

struct SolidPair {
  Shape<3> a, b;
  BodySweep<3> sweep_a, sweep_b;
  Polyhedra pools = {};

  Impact impact() const {
    return time_of_impact(a, sweep_a, b, sweep_b, kImpactTarget_m, kImpactTolerance_m, pools);
  }
  Core<3> core(bool of_b, float fraction) const {
    const Pose<3> pose = pose_at(of_b ? sweep_b : sweep_a, fraction);
    return core_of(of_b ? b : a, pose.rotation, pose.position, pools);
  }
  double gap_at(float fraction) const {
    const Core<3> core_a = core(false, fraction);
    const Core<3> core_b = core(true, fraction);
    return wide_separation(wide_core(core_a), wide_core(core_b)) - core_a.radius - core_b.radius;
  }
};

TEST(SolidImpact, OfStraightWaysIsExact) {
  // 5000 m/s for a tick of 1/60 s against 0.02 m.
  const SolidPair shot{solid_ball(0.05f), solid_box({{0.01f, 2, 2}}),
                       way_of({{0, 0, 0}}, {{83.3f, 0, 0}}), at_rest({{40, 0, 0}})};
  const Impact hit = shot.impact();
  ASSERT_TRUE(hit.hit);
  EXPECT_NEAR(hit.fraction * 83.3f, 40 - 0.01f - 0.05f - 0.009f, 0.0011f);
  SolidPair beside = shot;
  beside.sweep_a.start.position[1] = 2.07f;
  EXPECT_FALSE(beside.impact().hit);
  SolidPair away = shot;
  away.sweep_a.translation[0] = -83.3f;
  EXPECT_FALSE(away.impact().hit);
  const SolidPair boxes{solid_box({{0.3f, 0.2f, 0.1f}}), solid_box({{1, 1, 1}}),
                        way_of({{-9, 0.4f, 0.2f}}, {{20, 0, 0}}), at_rest()};
  ASSERT_TRUE(boxes.impact().hit);
  EXPECT_NEAR(boxes.impact().fraction * 20, 9 - 1.3f - 0.009f, 0.0011f);
}

TEST(SolidImpact, OfASpinningRodAgreesWithFineSampling) {
  int hits = 0;
  for (int i = 0; i < 40; ++i) {
    const float angle = 0.1f + 0.03f * static_cast<float>(i);
    const float distance = 0.3f + 0.017f * static_cast<float>(i);
    // A thin wall beside a rod that spins at 50 rad/s about a slanted axis.
    SolidPair pair{i % 2 == 0 ? solid_box({{1, 0.01f, 0.01f}})
                              : solid_capsule({{-1, 0, 0}}, {{1, 0, 0}}, 0.01f),
                   solid_box({{0.01f, 0.01f, 0.5f}}),
                   way_of({{0, 0, 0}}, {{0.2f, 0.1f, 0}}, {{0.05f, 0.1f, 50.0f / 60}}),
                   at_rest({{distance * std::cos(angle), distance * std::sin(angle), 0}})};
    float reached = 2, passed = 2;
    for (int k = 0; k <= 4000 && passed > 1; ++k) {
      const float fraction = static_cast<float>(k) * 2.5e-4f;
      const double gap = pair.gap_at(fraction);
      if (gap <= double{kImpactTarget_m} && reached > 1) reached = fraction;
      if (gap < double{kImpactTarget_m - kImpactTolerance_m}) passed = fraction;
    }
    const Impact impact = pair.impact();
    EXPECT_EQ(impact.hit, passed <= 1) << i;
    if (!impact.hit) continue;
    ++hits;
    EXPECT_GE(impact.fraction, reached - 2.6e-4f) << i;
    EXPECT_LE(impact.fraction, passed) << i;
  }
  EXPECT_GT(hits, 10);
  EXPECT_LT(hits, 40);
}

TEST(SolidImpact, MeetsTrianglesFromTheFreeSideAlone) {
  const Shape<3> floor = solid_triangle({{-2, 0, -2}}, {{-2, 0, 2}}, {{2, 0, 0}});
  for (const Shape<3>& shape : {solid_ball(0.1f), solid_box({{0.1f, 0.1f, 0.1f}}),
                                solid_capsule({{0, 0, -0.5f}}, {{0, 0, 0.5f}}, 0.1f)})
    for (const bool swapped : {false, true}) {
      const auto fall = [&](float from, float to, Vec<3> turn) {
        const BodySweep<3> way = way_of({{-1, from, 0}}, {{0, to - from, 0}}, turn);
        return swapped ? SolidPair{shape, floor, way, at_rest()}.impact()
                       : SolidPair{floor, shape, at_rest(), way}.impact();
      };
      const Impact down = fall(2, -2, Vec<3>::zero());
      ASSERT_TRUE(down.hit);
      EXPECT_NEAR(4 * down.fraction, 2 - 0.109f, 0.0011f);
      EXPECT_FALSE(fall(-2, 2, Vec<3>::zero()).hit);
      EXPECT_FALSE(fall(-0.6f, 2, {{0, 3, 0}}).hit);
      EXPECT_FALSE(fall(-0.05f, 1, Vec<3>::zero()).hit);
    }
  EXPECT_FALSE(
      (SolidPair{floor, floor, at_rest(), way_of({{0, 1, 0}}, {{0, -2, 0}})}).impact().hit);
}

TEST(SolidImpact, StumblesOverNoSeamOfAFlatMesh) {
  Shape<3> floor = solid_triangle({{-2, 0, 0}}, {{0, 0, 2}}, {{0, 0, -2}});
  const Shape<3> box = solid_box({{0.1f, 0.1f, 0.1f}});
  // From beyond the edge on the right, just below the target.
  const auto slides = [&](float drop) {
    return SolidPair{floor, box, at_rest(), way_of({{1, 0.109f, 0}}, {{-2, drop, 0}})}.impact().hit;
  };
  EXPECT_TRUE(slides(0));
  floor.ghosts = 2;
  floor.vertices[4] = {{2, 0, 0}};
  EXPECT_FALSE(slides(0));
  const BodySweep<3> fall = way_of({{1, 1, 0}}, {{-2.5f, -1.2f, 0}});
  EXPECT_TRUE((SolidPair{floor, box, at_rest(), fall}).impact().hit);
}

TEST(SolidImpact, OfABoxThatFallsOnAMeshIsThatOfItsLowestCorner) {
  const Shape<3> floor = solid_triangle({{-9, 0, -9}}, {{-9, 0, 9}}, {{9, 0, 0}});
  const Rotation<3> tilt = turned_about({{0, 0, 1}}, 0.78539816f);
  const SolidPair pair{floor, solid_box({{0.5f, 0.5f, 0.5f}}), at_rest(),
                       way_of({{0, 30, 0}}, {{0, -60, 0}}, {{0, 0, 3.1415927f}}, tilt)};
  const Impact impact = pair.impact();
  ASSERT_TRUE(impact.hit);
  EXPECT_GE(pair.gap_at(impact.fraction), double{kImpactTarget_m - kImpactTolerance_m});
  EXPECT_LE(pair.gap_at(impact.fraction), double{kImpactTarget_m} + 1e-5);
}

static Shape<3> random_small_solid(std::mt19937& random, Polyhedra& pools) {
  const Vec<3> half = {
      {uniform(random, 0.02f, 0.8f), uniform(random, 0.05f, 0.8f), uniform(random, 0.05f, 0.8f)}};
  switch (random() % 4) {
    case 0:
      return solid_ball(0.2f);
    case 1:
      return solid_capsule(random_vector(random, 0.7f), random_vector(random, 0.7f), 0.1f);
    case 2:
      return solid_box(half, random_vector(random, 0.3f), random_rotation(random));
    default:
      return solid_hull(random_corners(random, 4 + static_cast<int>(random() % 8), half), pools);
  }
}

static BodySweep<3> random_sweep_in_space(std::mt19937& random) {
  const Vec<3> from = random_vector(random, 2.5f);
  const Vec<3> turn = random() % 3 == 0 ? Vec<3>::zero() : random_vector(random, 3.0f);
  return way_of(from, random_vector(random, 0.4f) - uniform(random, 0, 2) * from, turn,
                random_rotation(random));
}

TEST(SolidImpact, NeverPassesThroughNorStopsForNothing) {
  std::mt19937 random(20240229);
  int hits = 0, early = 0, misses = 0;
  for (int i = 0; i < 3000; ++i) {
    SolidPair pair;
    pair.a = random_small_solid(random, pair.pools);
    pair.b = random_small_solid(random, pair.pools);
    pair.sweep_a = random_sweep_in_space(random);
    pair.sweep_b = random_sweep_in_space(random);
    if (pair.gap_at(0) < 2 * double{kImpactTarget_m}) continue;
    const Impact impact = pair.impact();
    const double least = double{kImpactTarget_m - kImpactTolerance_m} - 1e-5;
    for (int k = 0; k <= 40; ++k)
      ASSERT_GE(pair.gap_at(impact.fraction * static_cast<float>(k) / 40), least) << i << " " << k;
    if (impact.hit && pair.gap_at(impact.fraction) > double{kImpactTarget_m} + 1e-5) ++early;
    ++(impact.hit ? hits : misses);
  }
  EXPECT_GT(hits, 500);
  EXPECT_GT(misses, 500);
  EXPECT_EQ(early, 0);
}

TEST(SolidImpact, StopsFastRodsAndBoxesAtAHalfSpace) {
  for (const ShapeKind kind : {ShapeKind::kBox, ShapeKind::kCapsule}) {
    constexpr float speed = 5000.0f;
    World<3> world = make_world<3>(with_gravity<3>());
    add_ground<3>(world, {{0, 1, 0}});
    ShapeDef<3> shape;
    shape.kind = kind;
    shape.half = {{0.1f, 0.02f, 0.05f}};
    if (kind == ShapeKind::kCapsule) {
      shape.points = {{{-0.1f, 0, 0}}, {{0.1f, 0, 0}}};
      shape.radius = 0.02f;
    }
    BodyDef<3> def;
    def.position = {{0, 30, 0}};
    def.velocity = {{0, -speed, 0}};
    const BodyId id = add(world, def, shape);
    for (int tick = 0; tick < 30; ++tick) {
      step(world, 1);
      ASSERT_GT(view(world, id).position[1], -0.05f) << tick;
    }
  }
}

/// Neither in the tick of the impact nor later, whatever the contact solver makes of it.
TEST(SolidImpact, StopsAFastBodyBeforeAThinWall) {
  for (const bool rod : {false, true}) {
    World<3> world = make_world<3>();
    BodyDef<3> def;
    def.kind = BodyKind::kStatic;
    def.position = {{40, 0, 0}};
    def.rotation = turned_about({{0, 0, 1}}, 0.2f);
    ShapeDef<3> wall;
    wall.kind = ShapeKind::kBox;
    wall.half = {{0.01f, 5, 5}};
    add(world, def, wall);
    BodyDef<3> shot;
    shot.velocity = {{5000, 0, 0}};
    ShapeDef<3> shape = ball<3>(0.05f);
    if (rod) {
      shape.kind = ShapeKind::kCapsule;
      shape.points = {{{0, -0.5f, 0}}, {{0, 0.5f, 0}}};
      shot.spin = {{0, 0, 50}};
    }
    const BodyId id = add(world, shot, shape);
    const Vec<3> normal = rotate(def.rotation, Vec<3>{{1, 0, 0}});
    const auto height = [&] { return dot(normal, view(world, id).position - def.position); };
    step(world, 1);
    EXPECT_GT(height(), -1.0f);
    for (int tick = 0; tick < 30; ++tick) {
      EXPECT_LT(height(), -0.05f) << tick;
      step(world, 1);
    }
  }
}

}  // namespace cycloid::solver
