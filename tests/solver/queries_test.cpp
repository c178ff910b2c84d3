#include <random>

#include "tests/solver/query_fixture.hpp"
#include "tests/solver/random_fixture.hpp"

namespace cycloid::solver {

TEST(Queries, ReportInSlotOrderAndObeyFilterAndIgnore) {
  World<2> world = make_world<2>();
  ShapeDef<2> other = ball<2>(1.0f);
  other.filter = {2, 0xffffffffu, -7};
  const BodyId far_one = add_at(world, {{20, 0}}, ball<2>(1.0f));
  const BodyId near_one = add_at(world, {{5, 0}}, ball<2>(1.0f));
  const BodyId middle = add_at(world, {{10, 0}}, other);
  const auto ids = [&](const QueryFilter& filter) {
    std::vector<BodyId> found;
    for (const auto& hit : ray_cast(world.state(), {{0, 0}}, {{40, 0}}, filter))
      found.push_back(hit.body);
    std::vector<BodyId> swept;
    for (const auto& hit :
         shape_cast(world.state(), ball_probe<2>(0.5f), pose_of<2>({{0, 0}}), {{40, 0}}, filter))
      swept.push_back(hit.body);
    std::vector<BodyId> overlapped;
    for (const auto& hit :
         overlap(world.state(), box_probe(30, 1), pose_of<2>({{0, 0}}), 0.0f, filter))
      overlapped.push_back(hit.body);
    EXPECT_EQ(found, swept);
    EXPECT_EQ(found, overlapped);
    return found;
  };
  using Ids = std::vector<BodyId>;
  EXPECT_EQ(ids({}), (Ids{far_one, near_one, middle}));
  EXPECT_EQ(ids({{}, near_one}), (Ids{far_one, middle}));
  EXPECT_EQ(ids({{1, 2, 0}, {}}), (Ids{middle}));
  EXPECT_EQ(ids({{1, 0xffffffffu, -7}, {}}), (Ids{far_one, near_one}));
  EXPECT_EQ(ids({{1, 0, 7}, {}}), Ids{});
  const BodyId stale{near_one.index, near_one.generation + 1};
  EXPECT_EQ(ids({{}, stale}), (Ids{far_one, near_one, middle}));
  EXPECT_EQ(ray_cast_first(world.state(), {{0, 0}}, {{40, 0}}, {})->body, near_one);
  // Of equal fractions the lowest slot.
  const auto tie = ray_cast_first(world.state(), {{20, 5}}, {{20, -5}}, {});
  add_at(world, {{20, 0}}, ball<2>(1.0f));
  EXPECT_EQ(ray_cast_first(world.state(), {{20, 5}}, {{20, -5}}, {})->body, tie->body);
  EXPECT_EQ(ray_cast(world.state(), {{20, 5}}, {{20, -5}}, {}).size(), 2u);
}

TEST(ShapeCast, StopsWhereTheSurfacesMeet) {
  World<2> world = make_world<2>();
  add_static(world, {{0, 0}}, box(1, 1));
  const auto first = [&](const Probe<2>& probe, Pose<2> pose, Vec<2> way) {
    return shape_cast_first(world.state(), probe, pose, way, {});
  };
  const auto wall = first(ball_probe<2>(0.5f), pose_of<2>({{-5, 0.25f}}), {{7, 0}});
  ASSERT_TRUE(wall);
  EXPECT_NEAR(wall->fraction, 0.5f, kRound);
  expect_near(wall->point, {{-1, 0.25f}});
  expect_near(wall->normal, {{-1, 0}});

  // A box on its corner falls onto the flat top, and the corner of the wall meets a flat probe.
  const float diagonal = std::sqrt(0.5f);
  const auto corner = first(box_probe(0.5f, 0.5f), {{{0.25f, 5}}, turned(kPi / 4)}, {{0, -8}});
  ASSERT_TRUE(corner);
  EXPECT_NEAR(corner->fraction, (4 - diagonal) / 8, kRound);
  expect_near(corner->point, {{0.25f, 1}});
  const Vec<2> tilt = rotate(turned(kPi / 4), Vec<2>{{0, 1}});
  const auto edge = first(box_probe(3, 0.5f), {{{-4, 4}}, turned(kPi / 4)}, {{6, -6}});
  ASSERT_TRUE(edge);
  EXPECT_NEAR(edge->fraction, (3 * std::sqrt(2.0f) - 0.5f) / (6 * std::sqrt(2.0f)), kRound);
  expect_near(edge->normal, tilt);
  expect_near(edge->point, {{-1, 1}});
}

TEST(ShapeCast, CapsulesMeetAtTheirEnds) {
  World<2> world = make_world<2>();
  add_static(world, {{0, 0}}, capsule(1.0f, 0.5f));
  Probe<2> probe;
  probe.count = 2;
  probe.radius = 0.5f;
  probe.points[0] = {{-1, 0}};
  probe.points[1] = {{1, 0}};
  const auto hit = shape_cast_first(world.state(), probe, pose_of<2>({{-8, 0.6f}}), {{10, 0}}, {});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->fraction, (6 - 0.8f) / 10, kRound);
  expect_near(hit->normal, {{-0.8f, 0.6f}});
  expect_near(hit->point, {{-1.4f, 0.3f}});
}

TEST(ShapeCast, OverlapsCountOnlyOnTheWayDeeper) {
  World<2> world = make_world<2>();
  add_static(world, {{0, 0}}, box(5, 1));
  const Probe<2> probe = ball_probe<2>(0.5f);
  const Pose<2> sunk = pose_of<2>({{0, 1.25f}});
  const auto down = shape_cast_first(world.state(), probe, sunk, {{0, -1}}, {});
  ASSERT_TRUE(down);
  EXPECT_EQ(down->fraction, 0.0f);
  EXPECT_NEAR(down->separation, -0.25f, kRound);
  EXPECT_FALSE(shape_cast_first(world.state(), probe, sunk, {{0, 1}}, {}));
  EXPECT_FALSE(shape_cast_first(world.state(), probe, sunk, {{1, 0}}, {}));
}

TEST(ShapeCast, SlidesOverTheJointsOfAFlatChainButNotIntoAStep) {
  World<2> world = make_world<2>();
  add_static(world, {{0, 0}}, chain({{{-3, 0}}, {{0, 0}}, {{3, 0}}, {{6, 0}}, {{6, 1}}, {{9, 1}}}));
  for (const float height : {0.5f, 0.499f, 0.501f}) {
    const auto hit = shape_cast_first(world.state(), box_probe(0.5f, 0.5f),
                                      pose_of<2>({{-2, height}}), {{10, 0}}, {});
    ASSERT_TRUE(hit) << height;
    EXPECT_NEAR(hit->fraction, 0.75f, kRound) << height;
    expect_near(hit->normal, {{-1, 0}});
    EXPECT_TRUE(
        shape_cast_first(world.state(), ball_probe<2>(0.5f), pose_of<2>({{-2, 5}}), {{4, -8}}, {}));
  }
}

TEST(ShapeCast, AThinWallStopsASmallBallAcrossAKilometre) {
  World<2> world = make_world<2>();
  add_static(world, {{500, 0}}, box(0.01f, 10));
  add_static(world, {{0, 700}}, ball<2>(0.05f));
  const auto hit =
      shape_cast_first(world.state(), ball_probe<2>(0.05f), pose_of<2>({{0, 0}}), {{1000, 0}}, {});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->fraction, 499.94f / 1000, 1e-7f);
  const auto round = shape_cast_first(world.state(), ball_probe<2>(0.05f), pose_of<2>({{0.06f, 0}}),
                                      {{0, 1000}}, {});
  ASSERT_TRUE(round);
  EXPECT_NEAR(round->fraction, (700 - 0.08f) / 1000, 2e-7f);
}

TEST(Overlap, GivesDepthAndNormalOfAllThatIsNear) {
  World<2> world = make_world<2>();
  const BodyId floor = add_ground<2>(world, {{0, 1}});
  const BodyId box_id = add_static(world, {{3, 1}}, box(1, 1));
  const BodyId pill = add_static(world, {{-3, 1}}, capsule(1, 0.5f));
  add_static(world, {{0, 9}}, ball<2>(1));
  const auto hits =
      overlap(world.state(), box_probe(2.25f, 0.5f), pose_of<2>({{0, 0.75f}}), 0.5f, {});
  ASSERT_EQ(hits.size(), 3u);
  EXPECT_EQ(hits[0].body, floor);
  EXPECT_NEAR(hits[0].separation, 0.25f, kRound);
  expect_near(hits[0].normal, {{0, 1}});
  EXPECT_EQ(hits[1].body, box_id);
  EXPECT_NEAR(hits[1].separation, -0.25f, kRound);
  expect_near(hits[1].normal, {{-1, 0}});
  EXPECT_NEAR(hits[1].point[0], 2, kRound);
  EXPECT_EQ(hits[2].body, pill);
  EXPECT_LT(hits[2].separation, -0.5f);
  EXPECT_EQ(
      overlap(world.state(), box_probe(2.25f, 0.5f), pose_of<2>({{0, 0.75f}}), 0.25f, {}).size(),
      2u);
}

/// Both ends of a face that is parallel tie, and may lie far beside the smaller shape.
TEST(Overlap, TellsAPointOfTheShapeWhereALargerFaceIsParallel) {
  for (const float angle : {0.0f, 0.3f, 1.9f})
    for (const float radius : {0.0f, 0.1f})
      for (const float aside : {-7.0f, 0.0f, 7.0f}) {
        World<2> world = make_world<2>();
        ShapeDef<2> small = box(0.5f, 0.5f);
        small.radius = radius;
        add_static(world, {{0, 0}}, small, angle);
        const Pose<2> pose{rotate(turned(angle), Vec<2>{{aside, 1.4f + radius}}), turned(angle)};
        const Vec<2> down = rotate(turned(angle), Vec<2>{{0, -1}});
        const auto met = overlap(world.state(), box_probe(10, 1), pose, 0.0f, {});
        const auto in = shape_cast(world.state(), box_probe(10, 1), pose, down, {});
        ASSERT_EQ(met.size() + in.size(), 2u);
        EXPECT_NEAR(met[0].separation, -0.1f, 4e-6f);
        for (const Vec<2>& point : {met[0].point, in[0].point}) {
          const Vec<2> own = rotate_back(turned(angle), point);
          EXPECT_NEAR(own[1], 0.5f + radius, 4e-6f);
          EXPECT_LE(std::abs(own[0]), 0.5f + 4e-6f);
        }
      }
}

TEST(ClosestPoint, FromOutsideAndInside) {
  World<2> world = make_world<2>();
  const BodyId left = add_static(world, {{0, 0}}, box(1, 1));
  const BodyId right = add_static(world, {{6, 0}}, box(1, 1));
  const auto outside = closest_point(world.state(), {{2, 2}}, 5.0f, {});
  ASSERT_TRUE(outside);
  EXPECT_EQ(outside->body, left);
  EXPECT_NEAR(outside->separation, std::sqrt(2.0f), kRound);
  expect_near(outside->point, {{1, 1}});
  const auto inside = closest_point(world.state(), {{6.75f, 0.5f}}, 5.0f, {});
  ASSERT_TRUE(inside);
  EXPECT_EQ(inside->body, right);
  EXPECT_NEAR(inside->separation, -0.25f, kRound);
  expect_near(inside->point, {{7, 0.5f}});
  expect_near(inside->normal, {{1, 0}});
  EXPECT_EQ(closest_point(world.state(), {{3, 0}}, 5.0f, {})->body, left);
  EXPECT_FALSE(closest_point(world.state(), {{3, 0}}, 1.9f, {}));
}

static Probe<2> random_probe(std::mt19937& random) {
  Probe<2> probe;
  probe.count = 1 + static_cast<std::uint32_t>(random() % 8);
  const float size = uniform(random, 0.1f, 1.0f);
  const float flat = size * uniform(random, 0.05f, 1.0f);
  const bool rounded = probe.count < 3 || random() % 2 == 0;
  probe.radius = rounded ? uniform(random, 0.01f, 0.3f) : 0.0f;
  for (std::uint32_t i = 0; i < probe.count; ++i) {
    const float angle = 2 * kPi * static_cast<float>(i) / static_cast<float>(probe.count);
    probe.points[i] = {{size * std::cos(angle), flat * std::sin(angle)}};
  }
  return probe;
}

/// A segment is met where a capsule of the same line is, if that is from its free side.
TEST(ShapeCast, PassesASegmentFromBehindAndMeetsItAtFirstContactOnly) {
  std::mt19937 random(1730);
  int hits = 0;
  int from_behind = 0;
  for (int i = 0; i < 3000; ++i) {
    ShapeDef<2> line = chain({{{-1, 0}}, {{1, 0}}});
    ShapeDef<2> pill = capsule(1.0f, 0.2f);
    line.radius = pill.radius;
    World<2> sided = make_world<2>();
    World<2> full = make_world<2>();
    const float angle = uniform(random, -3, 3);
    add_static(sided, {{0, 0}}, line, angle);
    add_static(full, {{0, 0}}, pill, angle);
    const Probe<2> probe = random_probe(random);
    const Pose<2> pose{{{uniform(random, -3, 3), uniform(random, -3, 3)}},
                       turned(uniform(random, -3, 3))};
    const Vec<2> aside = {{uniform(random, -1.5f, 1.5f), uniform(random, -1.5f, 1.5f)}};
    const Vec<2> way = aside - 2.0f * pose.position;
    if (!overlap(full.state(), probe, pose, 1e-4f, {}).empty()) continue;
    const auto first = shape_cast_first(full.state(), probe, pose, way, {});
    const auto hit = shape_cast_first(sided.state(), probe, pose, way, {});
    const float rise = first ? dot(first->normal, rotate(turned(angle), Vec<2>{{0, 1}})) : -1.0f;
    if (std::abs(rise) < 1e-3f) continue;
    ASSERT_EQ(hit.has_value(), rise > 0) << i;
    ++(hit ? hits : from_behind);
    if (!hit) continue;
    EXPECT_NEAR(hit->fraction, first->fraction, 1e-5f) << i;
  }
  EXPECT_GT(hits, 300);
  EXPECT_GT(from_behind, 300);
}

TEST(ShapeCast, NeverPassesWhatOverlapFindsOnItsWay) {
  std::mt19937 random(1729);
  int hits = 0;
  int misses = 0;
  for (int i = 0; i < 3000; ++i) {
    const Probe<2> still = random_probe(random);
    const Probe<2> probe = random_probe(random);
    ShapeDef<2> shape;
    shape.kind = shape_of(still).kind;
    shape.points.assign(still.points.begin(), still.points.begin() + still.count);
    shape.radius = still.radius;
    World<2> world = make_world<2>();
    add_static(world, {{0.25f, 0}}, shape, uniform(random, -3, 3));
    const Pose<2> pose{{{uniform(random, -3, 3), uniform(random, -3, 3)}},
                       turned(uniform(random, -3, 3))};
    const Vec<2> aside = {{uniform(random, -1.5f, 1.5f), uniform(random, -1.5f, 1.5f)}};
    const Vec<2> way = aside - uniform(random, 0, 2) * pose.position;
    const auto near = [&](float fraction, float margin) {
      const Pose<2> at{pose.position + fraction * way, pose.rotation};
      return overlap(world.state(), probe, at, margin, {});
    };
    if (!near(0.0f, 1e-4f).empty()) continue;
    const auto hit = shape_cast_first(world.state(), probe, pose, way, {});
    const float until = hit ? hit->fraction : 1.0f;
    for (int k = 0; k <= 50; ++k)
      ASSERT_TRUE(near(until * static_cast<float>(k) / 50, -1e-5f).empty()) << i << " " << k;
    ++(hit ? hits : misses);
    if (!hit) continue;
    const auto touch = near(until, 1e-5f);
    ASSERT_EQ(touch.size(), 1u) << i;
    EXPECT_LT(dot(hit->normal, way), 0.0f) << i;
    EXPECT_GT(dot(hit->normal, touch[0].normal), 0.99f) << i;
  }
  EXPECT_GT(hits, 800);
  EXPECT_GT(misses, 800);
}

TEST(Queries, WorkOnBallsInSpace) {
  World<3> world = make_world<3>();
  add_ground<3>(world, {{0, 1, 0}});
  const BodyId id = add_at<3>(world, {{0, 5, 2}}, ball<3>(1));
  const auto ray = ray_cast_first(world.state(), {{-5, 5, 2.6f}}, {{5, 5, 2.6f}}, {});
  ASSERT_TRUE(ray);
  EXPECT_EQ(ray->body, id);
  EXPECT_NEAR(ray->fraction, 0.42f, kRound);
  expect_near(ray->normal, {{-0.8f, 0, 0.6f}});
  const auto cast =
      shape_cast(world.state(), ball_probe<3>(0.5f), pose_of<3>({{0, 10, 2}}), {{0, -10, 0}}, {});
  ASSERT_EQ(cast.size(), 2u);
  EXPECT_NEAR(cast[0].fraction, 0.95f, kRound);
  EXPECT_NEAR(cast[1].fraction, 0.35f, kRound);
  expect_near(cast[1].point, {{0, 6, 2}});
  const auto near = overlap(world.state(), ball_probe<3>(1), pose_of<3>({{3, 5, 2}}), 1.5f, {});
  ASSERT_EQ(near.size(), 1u);
  EXPECT_NEAR(near[0].separation, 1, kRound);
  const auto point = closest_point(world.state(), {{0, 1, 9}}, 10.0f, {});
  ASSERT_TRUE(point);
  EXPECT_NEAR(point->separation, 1, kRound);
  expect_near(point->point, {{0, 0, 9}});
}

}  // namespace cycloid::solver
