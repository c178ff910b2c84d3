#include "solver/queries/time_of_impact.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "solver/collision/collide.hpp"
#include "solver/queries/query.hpp"
#include "tests/solver/impact_fixture.hpp"
#include "tests/solver/random_fixture.hpp"

namespace cycloid::solver {

template <int D>
Shape<D> ball_shape(float radius) {
  Probe<D> probe;
  probe.radius = radius;
  return shape_of(probe);
}

static Shape<2> regular(std::uint32_t count, float size_x, float size_y, float radius,
                        Vec<2> centre) {
  Probe<2> probe;
  probe.count = count;
  probe.radius = radius;
  for (std::uint32_t i = 0; i < count; ++i) {
    const float angle = 6.2831853f * (static_cast<float>(i) + 0.5f) / static_cast<float>(count);
    probe.points[i] = centre + Vec<2>{{size_x * std::cos(angle), size_y * std::sin(angle)}};
  }
  return shape_of(probe);
}

static Shape<2> box_shape(float half_x, float half_y) {
  return regular(4, half_x * std::sqrt(2.0f), half_y * std::sqrt(2.0f), 0.0f, {{0, 0}});
}

static Shape<2> segment_shape(Vec<2> from, Vec<2> to) {
  Probe<2> probe;
  probe.count = 2;
  probe.points[0] = to;
  probe.points[1] = from;
  Shape<2> shape = shape_of(probe);
  shape.kind = ShapeKind::kSegment;
  return shape;
}

template <int D>
BodySweep<D> sweep(Vec<D> from, Vec<D> translation, Spin<D> turn = Spin<D>::zero()) {
  return {{from, identity_rotation<D>()}, translation, turn};
}

/// The reference: double precision, its own formulae.
struct Point {
  double x, y;
};
struct TestOutline {
  std::vector<Point> points;
  double radius;
};

static TestOutline outline_at(const Shape<2>& shape, const BodySweep<2>& way, double fraction) {
  const double angle = std::atan2(double{way.start.rotation[1]}, double{way.start.rotation[0]}) +
                       fraction * double{way.turn[0]};
  TestOutline outline{{}, shape.radius};
  for (std::uint32_t i = 0; i < shape.vertex_count; ++i) {
    const double x = shape.vertices[i][0];
    const double y = shape.vertices[i][1];
    outline.points.push_back({way.start.position[0] + fraction * way.translation[0] +
                                  std::cos(angle) * x - std::sin(angle) * y,
                              way.start.position[1] + fraction * way.translation[1] +
                                  std::sin(angle) * x + std::cos(angle) * y});
  }
  return outline;
}

static double side(Point a, Point b, Point c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

static bool contains(const TestOutline& outline, Point p) {
  if (outline.points.size() < 3) return false;
  for (std::size_t i = 0; i < outline.points.size(); ++i)
    if (side(outline.points[i], outline.points[(i + 1) % outline.points.size()], p) < 0)
      return false;
  return true;
}

static double point_to_edge(Point p, Point a, Point b) {
  const double square = (b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y);
  const double along = (p.x - a.x) * (b.x - a.x) + (p.y - a.y) * (b.y - a.y);
  const double t = square > 0 ? std::clamp(along / square, 0.0, 1.0) : 0.0;
  return std::hypot(p.x - a.x - t * (b.x - a.x), p.y - a.y - t * (b.y - a.y));
}

/// Between the surfaces; below -(sum of the radii) the cores overlap.
static double gap(const TestOutline& a, const TestOutline& b) {
  double nearest = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < a.points.size(); ++i)
    for (std::size_t j = 0; j < b.points.size(); ++j) {
      const Point a0 = a.points[i], a1 = a.points[(i + 1) % a.points.size()];
      const Point b0 = b.points[j], b1 = b.points[(j + 1) % b.points.size()];
      nearest = std::min({nearest, point_to_edge(a0, b0, b1), point_to_edge(b0, a0, a1)});
      const bool cross =
          side(a0, a1, b0) * side(a0, a1, b1) < 0 && side(b0, b1, a0) * side(b0, b1, a1) < 0;
      if (cross || contains(a, b0) || contains(b, a0)) nearest = -1.0;
    }
  return nearest - a.radius - b.radius;
}

struct Pair {
  Shape<2> a, b;
  BodySweep<2> sweep_a, sweep_b;
  double gap_at(double fraction) const {
    return gap(outline_at(a, sweep_a, fraction), outline_at(b, sweep_b, fraction));
  }
  Impact impact() const {
    return time_of_impact(a, sweep_a, b, sweep_b, kImpactTarget_m, kImpactTolerance_m, {});
  }
};

TEST(TimeOfImpact, OfStraightWaysIsExact) {
  const Shape<2> ball = ball_shape<2>(0.05f);
  const Shape<2> wall = box_shape(0.01f, 10.0f);
  const Impact hit =
      time_of_impact(ball, sweep<2>({{0, 0}}, {{1000, 0}}), wall, sweep<2>({{500, 0}}, {{0, 0}}),
                     kImpactTarget_m, kImpactTolerance_m, {});
  ASSERT_TRUE(hit.hit);
  EXPECT_NEAR(hit.fraction * 1000, 500 - 0.01 - 0.05 - 0.009, 0.0011);
  const Impact away =
      time_of_impact(ball, sweep<2>({{0, 0}}, {{-1000, 0}}), wall, sweep<2>({{500, 0}}, {{0, 0}}),
                     kImpactTarget_m, kImpactTolerance_m, {});
  EXPECT_FALSE(away.hit);
  EXPECT_EQ(away.fraction, 1.0f);
  const Impact beside =
      time_of_impact(ball, sweep<2>({{0, 10.07f}}, {{1000, 0}}), wall,
                     sweep<2>({{500, 0}}, {{0, 0}}), kImpactTarget_m, kImpactTolerance_m, {});
  EXPECT_FALSE(beside.hit);
}

TEST(TimeOfImpact, OfASpinningRodAgreesWithFineSampling) {
  int hits = 0;
  for (int i = 0; i < 40; ++i) {
    Pair pair{box_shape(1.0f, 0.01f), ball_shape<2>(0.01f), {}, {}};
    pair.sweep_a = sweep<2>({{0, 0}}, {{0.2f, 0.1f}}, {{50.0f / 60.0f}});
    const float angle = 0.2f + 0.03f * static_cast<float>(i);
    const float distance = 0.3f + 0.017f * static_cast<float>(i);
    pair.sweep_b = sweep<2>({{distance * std::cos(angle), distance * std::sin(angle)}}, {{0, 0}});
    double reached = 2;
    double passed = 2;
    for (int k = 0; k <= 100000 && passed > 1; ++k) {
      const double gap_now = pair.gap_at(k * 1e-5);
      if (gap_now <= kImpactTarget_m && reached > 1) reached = k * 1e-5;
      if (gap_now < kImpactTarget_m - kImpactTolerance_m) passed = k * 1e-5;
    }
    const Impact impact = pair.impact();
    EXPECT_EQ(impact.hit, passed <= 1) << i;
    if (!impact.hit) continue;
    ++hits;
    EXPECT_GE(impact.fraction, reached - 2e-5) << i;
    EXPECT_LE(impact.fraction, passed) << i;
  }
  EXPECT_GT(hits, 10);
  EXPECT_LT(hits, 40);
}

TEST(TimeOfImpact, OfShapesThatStartTooCloseIsZeroOnlyOnTheWayIn) {
  const Shape<2> floor = box_shape(5.0f, 1.0f);
  const Shape<2> box = box_shape(0.5f, 0.5f);
  const BodySweep<2> rest = sweep<2>({{0, 0}}, {{0, 0}});
  const auto from = [&](float height, Vec<2> way) {
    return time_of_impact(floor, rest, box, sweep<2>({{0, 1.5f + height}}, way), kImpactTarget_m,
                          kImpactTolerance_m, {});
  };
  for (const float height : {-0.02f, 0.0f, 0.0085f, 0.0095f}) {
    const Impact down = from(height, {{0, -0.5f}});
    EXPECT_TRUE(down.hit) << height;
    EXPECT_EQ(down.fraction, 0.0f) << height;
    EXPECT_FALSE(from(height, {{0, 0.5f}}).hit) << height;
    EXPECT_FALSE(from(height, {{2, 0}}).hit) << height;
    EXPECT_FALSE(from(height, {{0, 0}}).hit) << height;
  }
  EXPECT_FALSE(from(0.0105f, {{3, -0.001f}}).hit);
  EXPECT_TRUE(from(0.0105f, {{3, -0.01f}}).hit);
}

TEST(TimeOfImpact, MeetsSegmentsFromTheFreeSideAlone) {
  const Shape<2> segment = segment_shape({{-1, 0}}, {{1, 0}});
  const BodySweep<2> rest = sweep<2>({{0, 0}}, {{0, 0}});
  for (const Shape<2>& shape : {ball_shape<2>(0.1f), box_shape(0.1f, 0.1f)}) {
    const auto fall = [&](float x, float from, float to, bool swapped, float turn) {
      const BodySweep<2> way = sweep<2>({{x, from}}, {{0, to - from}}, {{turn}});
      return swapped ? time_of_impact(shape, way, segment, rest, kImpactTarget_m,
                                      kImpactTolerance_m, {})
                     : time_of_impact(segment, rest, shape, way, kImpactTarget_m,
                                      kImpactTolerance_m, {});
    };
    for (const bool swapped : {false, true}) {
      const Impact down = fall(0.3f, 2.0f, -2.0f, swapped, 0.0f);
      ASSERT_TRUE(down.hit);
      EXPECT_NEAR(4 * down.fraction, 2 - 0.109, 0.0011);
      EXPECT_FALSE(fall(0.3f, -2.0f, 2.0f, swapped, 0.0f).hit);
      EXPECT_FALSE(fall(0.3f, -0.2f, 2.0f, swapped, 3.0f).hit);
      EXPECT_FALSE(fall(0.3f, -0.05f, 1.0f, swapped, 0.0f).hit);
      EXPECT_FALSE(fall(1.3f, 2.0f, -2.0f, swapped, 2.0f).hit);
    }
  }
  const BodySweep<2> fall = sweep<2>({{0, 1}}, {{0, -2}});
  EXPECT_FALSE(
      time_of_impact(segment, rest, segment, fall, kImpactTarget_m, kImpactTolerance_m, {}).hit);
}

TEST(TimeOfImpact, StumblesOverNoJointOfAFlatChain) {
  Shape<2> segment = segment_shape({{0, 0}}, {{2, 0}});
  const BodySweep<2> rest = sweep<2>({{0, 0}}, {{0, 0}});
  const BodySweep<2> slide = sweep<2>({{-2, 0.109f}}, {{3, 0}});
  // Against an end alone the face of the box stops; where a neighbour leads up to it, it does not.
  const Shape<2> box = box_shape(0.1f, 0.1f);
  EXPECT_TRUE(
      time_of_impact(segment, rest, box, slide, kImpactTarget_m, kImpactTolerance_m, {}).hit);
  segment.ghosts = 2;
  segment.vertices[3] = {{-2, 0}};
  EXPECT_FALSE(
      time_of_impact(segment, rest, box, slide, kImpactTarget_m, kImpactTolerance_m, {}).hit);
  const BodySweep<2> fall = sweep<2>({{-1, 1}}, {{3, -2}});
  EXPECT_TRUE(
      time_of_impact(segment, rest, box, fall, kImpactTarget_m, kImpactTolerance_m, {}).hit);
}

TEST(TimeOfImpact, MeetsHalfSpacesAndWorksInSpace) {
  Shape<2> plane{};
  plane.kind = ShapeKind::kHalfSpace;
  plane.normal = {{0, 1}};
  const BodySweep<2> rod = sweep<2>({{0, 0.9f}}, {{0, 0}}, {{1.5f}});
  const Impact tip = time_of_impact(box_shape(1, 0.01f), rod, plane, sweep<2>({{0, 0}}, {{0, 0}}),
                                    kImpactTarget_m, kImpactTolerance_m, {});
  ASSERT_TRUE(tip.hit);
  const double angle = 1.5 * tip.fraction;
  EXPECT_NEAR(0.9 - std::sin(angle) - 0.01 * std::cos(angle), 0.009, 0.0011);

  Shape<3> offset = ball_shape<3>(0.2f);
  offset.vertices[0] = {{1, 0, 0}};
  const Impact swung =
      time_of_impact(offset, sweep<3>({{0, 0, 0}}, {{0, 0, 0}}, {{0, 0, 2}}), ball_shape<3>(0.3f),
                     sweep<3>({{0, 1, 0}}, {{0, 0, 0}}), kImpactTarget_m, kImpactTolerance_m, {});
  ASSERT_TRUE(swung.hit);
  const double turned = 2.0 * swung.fraction;
  EXPECT_NEAR(std::hypot(std::cos(turned), 1 - std::sin(turned)), 0.509, 0.0011);
}

static Shape<2> random_shape(std::mt19937& random) {
  const std::uint32_t count = 1 + static_cast<std::uint32_t>(random() % 8);
  const float size = uniform(random, 0.1f, 1.0f);
  const float radius = count < 3 || random() % 2 == 0 ? uniform(random, 0.01f, 0.3f) : 0.0f;
  const float flatness = uniform(random, 0.02f, 1.0f);
  const Vec<2> centre = {{uniform(random, -0.5f, 0.5f), uniform(random, -0.5f, 0.5f)}};
  return regular(count, size, size * flatness, radius, centre);
}

static BodySweep<2> random_sweep(std::mt19937& random) {
  const Vec<2> from = {{uniform(random, -3.0f, 3.0f), uniform(random, -3.0f, 3.0f)}};
  const Vec<2> aside = {{uniform(random, -0.5f, 0.5f), uniform(random, -0.5f, 0.5f)}};
  const float turn = random() % 3 == 0 ? 0.0f : uniform(random, -4.0f, 4.0f);
  // Most ways lead past the origin, so that about half of the pairs meet.
  BodySweep<2> way = sweep<2>(from, aside - uniform(random, 0.0f, 2.0f) * from, {{turn}});
  way.start.rotation =
      pose_at(sweep<2>({{0, 0}}, {{0, 0}}, {{uniform(random, -3, 3)}}), 1).rotation;
  return way;
}

TEST(TimeOfImpact, NeverPassesThroughNorStopsForNothing) {
  std::mt19937 random(20240229);
  int hits = 0;
  int early = 0;
  int misses = 0;
  for (int i = 0; i < 4000; ++i) {
    const Pair pair{random_shape(random), random_shape(random), random_sweep(random),
                    random_sweep(random)};
    if (pair.gap_at(0) < 2 * kImpactTarget_m) continue;
    const Impact impact = pair.impact();
    const double until = impact.fraction;
    ASSERT_GE(pair.gap_at(until), kImpactTarget_m - kImpactTolerance_m - (impact.hit ? 0.0 : 1e-5))
        << i;
    for (int k = 0; k <= 200; ++k)
      ASSERT_GE(pair.gap_at(until * k / 200), kImpactTarget_m - kImpactTolerance_m)
          << i << " at " << k;
    if (impact.hit && pair.gap_at(until) > kImpactTarget_m + 1e-5) ++early;
    ++(impact.hit ? hits : misses);
  }
  EXPECT_GT(hits, 800);
  EXPECT_GT(misses, 800);
  EXPECT_EQ(early, 0);
}

}  // namespace cycloid::solver
