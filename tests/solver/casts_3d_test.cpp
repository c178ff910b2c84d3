#include <gtest/gtest.h>

#include "tests/solver/cast_3d_fixture.hpp"

namespace cycloid::solver {

/// A cast in double precision: the cores, and how far apart they are at a fraction of the way.
struct WideCast {
  WideCore still;
  WideCore probe;
  WideVec way;

  WideCore probe_at(double fraction, WideVec aside = {0, 0, 0}) const {
    WideCore moved = probe;
    const auto place = [&](WideVec& p) { p = plus(plus(p, fraction, way), 1, aside); };
    for (WideVec& p : moved.points) place(p);
    for (auto& edge : moved.edges) {
      place(edge.first);
      place(edge.second);
    }
    for (auto& triangle : moved.triangles)
      for (WideVec& p : triangle) place(p);
    return moved;
  }
  double apart(double fraction) const { return wide_separation(still, probe_at(fraction)); }
  double deepest_fraction() const {
    double low = 0, high = 1;
    for (int i = 0; i < 30; ++i) {
      const double third = (high - low) / 3;
      if (apart(low + third) < apart(high - third))
        high -= third;
      else
        low += third;
    }
    return (low + high) / 2;
  }
  /// The first fraction at which they are `distance` apart. @pre nearer than that at `until`.
  double fraction_at(double distance, double until) const {
    double low = 0, high = until;
    for (int i = 0; i < 40; ++i) {
      const double middle = (low + high) / 2;
      (apart(middle) > distance ? low : high) = middle;
    }
    return low;
  }
  /// Unit, from what stands still to the probe: the way on which their distance grows most.
  WideVec normal_at(double fraction) const {
    WideVec normal{};
    for (std::size_t k = 0; k < 3; ++k) {
      WideVec aside{};
      aside[k] = 1e-6;
      normal[k] += wide_separation(still, probe_at(fraction, aside));
      aside[k] = -1e-6;
      normal[k] -= wide_separation(still, probe_at(fraction, aside));
    }
    return plus({0, 0, 0}, 1 / wide_length(normal), normal);
  }
};

static double wide_to_core(const WideVec& point, const WideCore& core) {
  WideCore ball;
  ball.points = {point};
  return wide_separation(core, ball);
}

TEST(SolidCasts, OfSharpBlocksMeetATriangleOnItsEdgesAndOnItsFreeSideOnly) {
  const Vec<3> own = {{0, 1, 0}};
  const WorldState<3> state = state_of(solid_triangle({{-1, 0, 0}}, {{1, 0, 1}}, {{1, 0, -1}}));
  const Rotation<3> turn = turned_about({{0, 0, 1}}, 0.78539816f);
  const auto cast = [&](Vec<3> from, Vec<3> way) {
    return shape_cast_first(state, block_probe({{1, 1, 1}}), {from, turn}, way, {});
  };
  const float r = std::sqrt(0.5f);
  for (const Vec<3>& way : {Vec<3>{{6, -0.5f, 0}}, Vec<3>{{6, 0.3f, 0.1f}}}) {
    const Vec<3> from = {{-5, way[1] < 0 ? 1.5f : 1.0f, way[2]}};
    const auto hit = cast(from, way);
    ASSERT_TRUE(hit);
    expect_near(hit->normal, {{-r, r, 0}}, 1e-5f);
    expect_near(hit->point, {{-1, 0, 0}}, 1e-4f);
    EXPECT_GT(dot(hit->normal, own), 0);
  }
  EXPECT_FALSE(cast({{-5, -1, 0.1f}}, {{6, -0.3f, 0.02f}}));  // From below, as its normal tells.
}

/// Hits, normals and points of casts against the distance in double precision.
TEST(SolidCasts, OfSharpProbesAgainstTrianglesAreThoseOfDoublePrecision) {
  std::mt19937 random(31);
  int hits = 0, from_behind = 0;
  for (int i = 0; i < 600; ++i) {
    const Shape<3> shape = solid_triangle(random_vector(random, 1), random_vector(random, 1),
                                          random_vector(random, 1));
    if (length(cross(shape.vertices[1] - shape.vertices[0],
                     shape.vertices[2] - shape.vertices[0])) < 0.1f)
      continue;
    const float size = uniform(random, 0.2f, 3.0f);
    Probe<3> probe = block_probe({{size, uniform(random, 0.1f, 1.0f) * size, 0.5f * size}});
    if (i % 2 == 0) {
      probe.count = 6;
      const auto corners = random_corners(random, 6, {{size, size, size}});
      std::copy(corners.begin(), corners.end(), probe.points.begin());
    }
    const Rotation<3> turn = i % 3 == 0 ? identity_rotation<3>() : random_rotation(random);
    const Vec<3> from = (4 + 3 * size) * normalized_or(random_vector(random, 1), {{1, 0, 0}});
    const Vec<3> way = random_vector(random, 1) - 1.5f * from;
    const Core<3> core = core_of(shape, identity_rotation<3>(), -from, {});
    const WideCast wide_cast{wide_core(core), wide_core(core_of(probe, turn)), wide(way)};
    const double deepest = wide_cast.deepest_fraction();
    if (wide_cast.apart(deepest) > -0.02) continue;
    const double fraction = wide_cast.fraction_at(0, deepest);
    const WideVec normal = wide_cast.normal_at(wide_cast.fraction_at(1e-4, deepest));
    const double rise = wide_dot(normal, wide(core.normals[0]));
    const double approach = -wide_dot(normal, wide(way)) / length(way);
    if (std::abs(rise) < 0.02 || approach < 0.05) continue;
    const auto hit = shape_cast_first(state_of(shape), probe, {from, turn}, way, {});
    ASSERT_EQ(hit.has_value(), rise > 0) << i;
    if (!hit) {
      ++from_behind;
      continue;
    }
    ++hits;
    const double tolerance = (1e-4 + 1e-5 * size) / (approach * length(way));
    EXPECT_NEAR(hit->fraction, fraction, tolerance) << i;
    EXPECT_GT(wide_dot(normal, wide(hit->normal)), 0.99) << i;
    const WideVec point = wide(hit->point - from);
    EXPECT_LT(wide_to_core(point, wide_cast.still), 1e-4) << i;
    EXPECT_LT(wide_to_core(point, wide_cast.probe_at(hit->fraction)), 2e-4) << i;
  }
  EXPECT_GT(hits, 60);
  EXPECT_GT(from_behind, 60);
}

/// Faces that are parallel tie in all their corners, of which some lie far beside the smaller
/// shape.
TEST(SolidCasts, AndOverlapsTellAPointOnTheShapeMetWhereFacesAreParallel) {
  std::mt19937 random(37);
  for (int i = 0; i < 500; ++i) {
    const Rotation<3> turn = i % 2 == 0 ? identity_rotation<3>() : random_rotation(random);
    const Vec<3> half = {
        {uniform(random, 0.1f, 1), uniform(random, 0.1f, 1), uniform(random, 0.1f, 1)}};
    const WorldState<3> state = state_of(solid_box(half), Vec<3>::zero(), turn);
    const float wide_half = uniform(random, 1, 10);
    const Probe<3> probe = block_probe({{wide_half, 1, uniform(random, 0.2f, 10)}});
    const float depth = uniform(random, 0.001f, 0.05f);
    const Vec<3> aside = {
        {uniform(random, -1, 1), half[1] + 1 - depth, uniform(random, -0.2f, 0.2f)}};
    const Pose<3> pose{rotate(turn, aside), turn};
    const Vec<3> up = rotate(turn, Vec<3>{{0, 1, 0}});
    const auto met = overlap(state, probe, pose, 0.0f, {});
    const auto in = shape_cast(state, probe, pose, -up, {});
    ASSERT_EQ(met.size() + in.size(), 2u) << i;
    for (const Vec<3>& point : {met[0].point, in[0].point}) {
      const Vec<3> own = rotate_back(turn, point);
      EXPECT_NEAR(own[1], half[1], 2e-5f) << i;
      EXPECT_LE(std::abs(own[0]), half[0] + 2e-5f) << i;
      EXPECT_LE(std::abs(own[2]), half[2] + 2e-5f) << i;
      EXPECT_LE(std::abs(own[0] - aside[0]), wide_half + 2e-5f) << i;
    }
    EXPECT_NEAR(met[0].separation, -depth, 3e-5f);
    const auto fall = shape_cast(state, probe, {pose.position + 4.0f * up, turn}, -5.0f * up, {});
    ASSERT_EQ(fall.size(), 1u) << i;
    EXPECT_LE(std::abs(rotate_back(turn, fall[0].point)[0]), half[0] + 2e-5f) << i;
  }
}

/// Rounding turns the normal of some nearest points by 1e-4, which must not lead past the contact.
TEST(SolidCasts, OfHullsStopAtTheContactAndNotBehindIt) {
  std::mt19937 random(43);
  int hits = 0;
  for (int i = 0; i < 6000; ++i) {
    Polyhedra pools;
    const Vec<3> half = {
        {uniform(random, 0.05f, 1), uniform(random, 0.05f, 1), uniform(random, 0.05f, 1)}};
    const Shape<3> shape = solid_hull(random_corners(random, 5, half), pools);
    Probe<3> probe = block_probe({{half[2], 0.3f * half[0], half[1]}});
    if (i % 2 == 0) {
      probe.count = 6;
      const auto corners = random_corners(random, 6, {{half[1], 0.1f, half[0]}});
      std::copy(corners.begin(), corners.end(), probe.points.begin());
    }
    const Rotation<3> turn = random_rotation(random);
    const Vec<3> from = 3.0f * normalized_or(random_vector(random, 1), {{1, 0, 0}});
    const Vec<3> way = random_vector(random, 1) - 1.5f * from;
    const WorldState<3> state = state_of({{shape, pose_of(Vec<3>::zero())}}, pools);
    const auto hit = shape_cast_first(state, probe, {from, turn}, way, {});
    if (!hit) continue;
    ++hits;
    const WideCast cast{wide_core(core_of(shape, identity_rotation<3>(), -from, pools)),
                        wide_core(core_of(probe, turn)), wide(way)};
    EXPECT_NEAR(cast.apart(hit->fraction), 0, 1.5e-5) << i;
  }
  EXPECT_GT(hits, 1000);
}

}  // namespace cycloid::solver
