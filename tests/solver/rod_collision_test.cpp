#include "tests/solver/round_fixture.hpp"

namespace cycloid::solver {

struct Accurate {
  double x, y, z;
};
Accurate accurate(const Vec<3>& v) {
  return {v[0], v[1], v[2]};
}
Accurate operator+(Accurate a, Accurate b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
Accurate operator-(Accurate a, Accurate b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Accurate operator*(double s, Accurate a) {
  return {s * a.x, s * a.y, s * a.z};
}
double dot(Accurate a, Accurate b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
Accurate cross(Accurate a, Accurate b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// The least value of a convex function on [0, 1].
template <class F>
double least(F f) {
  double lower = 0.0;
  double upper = 1.0;
  for (int i = 0; i < 120; ++i) {
    const double a = lower + (upper - lower) / 3.0;
    const double b = upper - (upper - lower) / 3.0;
    (f(a) < f(b) ? upper : lower) = f(a) < f(b) ? b : a;
  }
  return std::min({f(0.5 * (lower + upper)), f(0.0), f(1.0)});
}

static double segments_distance(const Rod& a, const Rod& b) {
  const Accurate d1 = accurate(a.to) - accurate(a.from);
  const Accurate d2 = accurate(b.to) - accurate(b.from);
  return least([&](double s) {
    const Accurate offset = accurate(a.from) + s * d1 - accurate(b.from);
    const double square = dot(d2, d2);
    const double t = square > 0.0 ? std::clamp(dot(offset, d2) / square, 0.0, 1.0) : 0.0;
    const Accurate between = offset - t * d2;
    return std::sqrt(dot(between, between));
  });
}

/// Of the core of a rod from a box; negative: the least it has to move to leave the box.
static double box_distance(const Solid& box, const Rod& rod) {
  const Accurate from = accurate(rod.from) - accurate(box.centre);
  const Accurate along = accurate(rod.to) - accurate(rod.from);
  const double apart = least([&](double s) {
    const Accurate p = from + s * along;
    double square = 0.0;
    for (int k = 0; k < 3; ++k) {
      const double out = std::abs(dot(p, accurate(box.axes[k]))) - box.half[k];
      if (out > 0.0) square += out * out;
    }
    return std::sqrt(square);
  });
  if (apart > 1.0e-9) return apart;
  double best = -1.0e30;
  const auto try_axis = [&](Accurate axis) {
    const double size = std::sqrt(dot(axis, axis));
    if (size < 1.0e-9) return;
    double reach = 0.0;
    for (int k = 0; k < 3; ++k) reach += box.half[k] * std::abs(dot(axis, accurate(box.axes[k])));
    const double ends[2] = {dot(axis, from), dot(axis, from + along)};
    best = std::max(best, (std::min(ends[0], ends[1]) - reach) / size);
    best = std::max(best, (-std::max(ends[0], ends[1]) - reach) / size);
  };
  for (int k = 0; k < 3; ++k) {
    try_axis(accurate(box.axes[k]));
    try_axis(cross(accurate(box.axes[k]), along));
  }
  return best;
}

TEST(RodCollision, CrossedCapsulesMeetWhereTheirAxesAreNearest) {
  const Rod a = {{{-1.0f, 0.0f, 0.0f}}, {{1.0f, 0.0f, 0.0f}}, 0.25f};
  const Rod b = {{{0.25f, 0.5f, -1.0f}}, {{0.25f, 0.5f, 1.0f}}, 0.5f};
  const Manifold<3> m = rod_against_rod(a, b, 0.01f);
  ASSERT_EQ(m.point_count, 1u);
  expect_normal(m, 0.0f, 1.0f, 0.0f);
  EXPECT_NEAR(m.points[0].separation, -0.25f, 1e-6f);
  // Midway between the surfaces at 0.25 and 0.
  EXPECT_NEAR(m.points[0].anchor_a[0], 0.25f, 1e-6f);
  EXPECT_NEAR(m.points[0].anchor_a[1], 0.125f, 1e-6f);
  EXPECT_NEAR(anchor_b_of(m.points[0], {{0.25f, 0.5f, 0.0f}})[1], -0.375f, 1e-6f);
}

TEST(RodCollision, ParallelCapsulesRestOnBothEndsOfTheirOverlap) {
  const Rod a = {{{-1.0f, 0.0f, 0.0f}}, {{1.0f, 0.0f, 0.0f}}, 0.25f};
  const Rod b = {{{2.0f, 0.5f, 0.0f}}, {{0.5f, 0.5f, 0.0f}}, 0.25f};
  const Manifold<3> m = rod_against_rod(a, b, 0.01f);
  ASSERT_EQ(m.point_count, 2u);
  expect_normal(m, 0.0f, 1.0f, 0.0f);
  EXPECT_NEAR(m.points[0].anchor_a[0], 0.5f, 1e-6f);
  EXPECT_NEAR(m.points[1].anchor_a[0], 1.0f, 1e-6f);
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(m.points[i].separation, 0.0f, 1e-6f);
  EXPECT_NE(m.points[0].feature, m.points[1].feature);
}

TEST(RodCollision, CapsulesInOneLineMeetAtTheirEnds) {
  const Rod a = {{{-1.0f, 0.0f, 0.0f}}, {{1.0f, 0.0f, 0.0f}}, 0.5f};
  for (const float gap : {0.99f, 0.0f}) {
    const Rod b = {{{1.0f + gap, 0.0f, 0.0f}}, {{4.0f, 0.0f, 0.0f}}, 0.5f};
    const Manifold<3> m = rod_against_rod(a, b, 0.01f);
    ASSERT_EQ(m.point_count, 1u);
    expect_normal(m, 1.0f, 0.0f, 0.0f);
    EXPECT_NEAR(m.points[0].separation, gap - 1.0f, 1e-6f);
  }
}

TEST(RodCollision, TouchingAxesHaveADefinedNormal) {
  const Rod a = {{{-1.0f, 0.0f, 0.0f}}, {{1.0f, 0.0f, 0.0f}}, 0.5f};
  // Crossing: along the normal of both, towards the other's middle.
  expect_normal(rod_against_rod(a, {{{0.0f, 0.0f, -1.0f}}, {{0.0f, 0.0f, 1.0f}}, 0.5f}, 0), 0.0f,
                1.0f, 0.0f);
  // An end on the other's axis: towards the rest of the rod.
  expect_normal(rod_against_rod(a, {{{0.5f, 0.0f, 0.0f}}, {{1.5f, 0.0f, -1.0f}}, 0.5f}, 0), 0.0f,
                0.0f, -1.0f);
  // The same axis: upwards.
  const Manifold<3> same = rod_against_rod(a, a, 0.0f);
  expect_normal(same, 0.0f, 1.0f, 0.0f);
  EXPECT_EQ(same.point_count, 2u);
  // Upright: upwards is along it.
  const Rod upright = {{{0.0f, -1.0f, 0.0f}}, {{0.0f, 1.0f, 0.0f}}, 0.5f};
  expect_normal(rod_against_rod(upright, upright, 0.0f), 1.0f, 0.0f, 0.0f);
  // A ball in the middle of a capsule.
  const Rod ball = {kZero, kZero, 0.5f};
  const Manifold<3> ball_in = rod_against_rod(a, ball, 0.0f);
  ASSERT_EQ(ball_in.point_count, 1u);
  EXPECT_NEAR(ball_in.points[0].separation, -1.0f, 1e-6f);
  expect_normal(ball_in, 0.0f, 1.0f, 0.0f);
}

// The normal lies across the axis also where the axis all but points upwards.
TEST(RodCollision, BallInTheMiddleOfASteepCapsuleLeavesAcrossIt) {
  for (const float lean : {0.0f, 0.02f, 0.05f, 0.2f, 1.0f}) {
    const Vec<3> half = {{lean, 1.0f, 0.5f * lean}};
    const Rod capsule{-half, half, 0.3f};
    const Manifold<3> manifold = rod_against_rod({kZero, kZero, 0.2f}, capsule, 0.02f);
    ASSERT_EQ(manifold.point_count, 1u) << lean;
    EXPECT_NEAR(dot(manifold.normal, half), 0.0f, 1e-5f) << lean;
    EXPECT_NEAR(length(manifold.normal), 1.0f, 1e-6f) << lean;
    EXPECT_NEAR(manifold.points[0].separation, -0.5f, 1e-6f) << lean;
  }
}

TEST(RodCollision, CapsulePairsMatchTheDistanceInDoublePrecision) {
  Draw draw;
  int met = 0;
  int twice = 0;
  for (int i = 0; i < 20000; ++i) {
    Rod a = {draw.vector(1.0f), draw.vector(1.0f), draw.within(0.05f, 0.6f)};
    Rod b = {draw.vector(1.5f), draw.vector(1.5f), draw.within(0.05f, 0.6f)};
    if (i % 4 == 1) b.to = b.from + draw.within(-1.0f, 1.0f) * (a.to - a.from);
    if (i % 8 == 2) b.to = b.from;
    if (i % 8 == 3) b.to = b.from + draw.within(0.5f, 1.0f) * (a.to - a.from) + draw.vector(0.02f);
    const double expected = segments_distance(a, b) - a.radius - b.radius;
    const Manifold<3> m = rod_against_rod(a, b, 0.1f);
    ASSERT_TRUE(is_finite(m));
    ASSERT_EQ(m.point_count == 0, expected > 0.1) << expected;
    if (m.point_count == 0) continue;
    ++met;
    twice += m.point_count == 2;
    ASSERT_NEAR(deepest(m), expected, 1e-4) << i;
    const Manifold<3> back = rod_against_rod(b, a, 0.1f);
    ASSERT_NEAR(deepest(back), deepest(m), 1e-5f);
    if (expected + a.radius + b.radius > 1e-3) {
      ASSERT_GT(-dot(m.normal, back.normal), 1.0f - 1e-5f);
      const auto support = [&](const Rod& r, bool low) {
        const double ends[2] = {dot(accurate(m.normal), accurate(r.from)),
                                dot(accurate(m.normal), accurate(r.to))};
        return low ? std::min(ends[0], ends[1]) - r.radius : std::max(ends[0], ends[1]) + r.radius;
      };
      ASSERT_NEAR(support(b, true) - support(a, false), expected, 1e-4) << i;
    }
  }
  EXPECT_GT(met, 6000);
  EXPECT_GT(twice, 500);
}

TEST(RodCollision, CapsuleOnABoxRestsOnTwoPointsWithinItsFace) {
  const Solid box = make_box({{1.0f, 0.5f, 1.0f}}, kZero);
  const Rod rod = {{{-0.5f, 0.75f, 0.0f}}, {{3.0f, 0.75f, 0.0f}}, 0.25f};
  const Manifold<3> m = solid_against_rod(box, rod, 0.01f);
  ASSERT_EQ(m.point_count, 2u);
  expect_normal(m, 0.0f, 1.0f, 0.0f);
  EXPECT_NEAR(m.points[0].anchor_a[0], -0.5f, 1e-4f);
  EXPECT_NEAR(m.points[1].anchor_a[0], 1.0f, 1e-4f);
  EXPECT_NEAR(anchor_b_of(m.points[1], {{1.25f, 0.75f, 0.0f}})[0], -0.25f, 1e-4f);
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(m.points[i].separation, 0.0f, 1e-6f);
    EXPECT_NEAR(m.points[i].anchor_a[1], 0.5f, 1e-6f);
  }
}

// Sticking out on both sides, or lying exactly over an edge, changes nothing about it.
TEST(RodCollision, CapsuleAcrossABoxRestsOnBothItsEdges) {
  const Solid box = make_box({{1.0f, 0.5f, 1.0f}}, kZero);
  for (const float z : {0.0f, 0.3f, 1.0f, -1.0f})
    for (const float tilt : {0.0f, 1e-6f, -1e-4f, 1e-3f}) {
      const Rod rod = {{{-3.0f, 0.75f - 3.0f * tilt, z}}, {{3.0f, 0.75f + 3.0f * tilt, z}}, 0.25f};
      const Manifold<3> m = solid_against_rod(box, rod, 0.01f);
      ASSERT_EQ(m.point_count, 2u) << z << " " << tilt;
      expect_normal(m, 0.0f, 1.0f, 0.0f);
      EXPECT_NEAR(m.points[0].anchor_a[0], -1.0f, 1e-4f);
      EXPECT_NEAR(m.points[1].anchor_a[0], 1.0f, 1e-4f);
      EXPECT_NEAR(m.points[1].separation, tilt, 1e-5f);
    }
}

TEST(RodCollision, CapsuleAlongAnEdgeRestsOnTwoPoints) {
  const Solid box = make_box({{1.0f, 1.0f, 1.0f}}, kZero);
  const Rod rod = {{{-0.5f, 1.3f, 1.4f}}, {{0.5f, 1.3f, 1.4f}}, 0.5f};
  const Manifold<3> m = solid_against_rod(box, rod, 0.01f);
  ASSERT_EQ(m.point_count, 2u);
  expect_normal(m, 0.0f, 0.6f, 0.8f, 1e-5f);
  EXPECT_NEAR(std::abs(m.points[0].anchor_a[0] - m.points[1].anchor_a[0]), 1.0f, 1e-5f);
  EXPECT_NE(m.points[0].feature, m.points[1].feature);
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(m.points[i].separation, 0.0f, 1e-6f);
}

TEST(RodCollision, BallMeetsAFaceAnEdgeAndACorner) {
  const Solid box = make_box({{1.0f, 1.0f, 1.0f}}, kZero);
  const auto ball = [](float x, float y, float z) { return Rod{{{x, y, z}}, {{x, y, z}}, 0.5f}; };
  const Manifold<3> face = solid_against_rod(box, ball(0.2f, 1.4f, 0.0f), 0.01f);
  ASSERT_EQ(face.point_count, 1u);
  expect_normal(face, 0.0f, 1.0f, 0.0f);
  EXPECT_NEAR(face.points[0].separation, -0.1f, 1e-6f);
  const Manifold<3> edge = solid_against_rod(box, ball(0.0f, 1.3f, 1.4f), 0.01f);
  ASSERT_EQ(edge.point_count, 1u);
  expect_normal(edge, 0.0f, 0.6f, 0.8f);
  const Manifold<3> corner = solid_against_rod(box, ball(1.2f, 1.1f, 1.2f), 0.01f);
  ASSERT_EQ(corner.point_count, 1u);
  expect_normal(corner, 2.0f / 3.0f, 1.0f / 3.0f, 2.0f / 3.0f, 1e-5f);
  EXPECT_NEAR(corner.points[0].separation, -0.2f, 1e-6f);
  EXPECT_NE(face.points[0].feature, edge.points[0].feature);
  EXPECT_NE(corner.points[0].feature, edge.points[0].feature);
  EXPECT_EQ(solid_against_rod(box, ball(1.4f, 1.4f, 1.4f), 0.01f).point_count, 0u);
}

TEST(RodCollision, CentreExactlyOnTheSurfaceIsPushedOutAlongAFace) {
  for (const float size : {1e-3f, 1.0f, 1e3f}) {
    const Solid box = make_box({{size, size, size}}, kZero);
    for (const Vec<3>& at : {Vec<3>{{0.0f, size, 0.0f}}, Vec<3>{{size, size, 0.0f}},
                             Vec<3>{{size, size, size}}, Vec<3>{{0.0f, 0.0f, 0.0f}}})
      for (const float length_of : {0.0f, 0.5f, 3.0f}) {
        const Vec<3> along = {{length_of * size, 0.0f, 0.0f}};
        const Rod rod = {at, at + along, 0.5f * size};
        const Manifold<3> m = solid_against_rod(box, rod, 0.01f);
        ASSERT_GE(m.point_count, 1u);
        ASSERT_TRUE(is_finite(m));
        const double expected = box_distance(box, rod) - rod.radius;
        EXPECT_NEAR(deepest(m), expected, 2e-5f * size);
      }
  }
}

TEST(RodCollision, NormalDoesNotJumpWhereTheAxisEntersAFace) {
  const Solid box = make_box({{1.0f, 1.0f, 1.0f}}, kZero);
  float last = 0.0f;
  for (int i = 400; i >= -400; --i) {
    const float y = 1.0f + 1e-6f * static_cast<float>(i);
    const Rod rod = {{{-0.3f, y, 0.1f}}, {{0.4f, y + 0.2f, 0.2f}}, 0.3f};
    const Manifold<3> m = solid_against_rod(box, rod, 0.01f);
    ASSERT_GE(m.point_count, 1u);
    expect_normal(m, 0.0f, 1.0f, 0.0f);
    if (i < 400) {
      ASSERT_NEAR(deepest(m), last, 2e-6f);
    }
    last = deepest(m);
  }
}

TEST(RodCollision, CapsuleBoxPairsMatchTheDistanceInDoublePrecision) {
  Draw draw;
  int met = 0;
  int sunk = 0;
  int twice = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec<3> half = {
        {draw.within(0.2f, 1.0f), draw.within(0.2f, 1.0f), draw.within(0.2f, 1.0f)}};
    const Solid box = make_box(half, draw.vector(0.5f), draw.rotation());
    Rod rod = {draw.vector(1.6f), draw.vector(1.6f), draw.within(0.05f, 0.5f)};
    if (i % 4 == 1) rod.to = rod.from + draw.within(-2.0f, 2.0f) * box.axes[i / 4 % 3];
    if (i % 8 == 2) rod.to = rod.from;
    const double expected = box_distance(box, rod) - rod.radius;
    const Manifold<3> m = solid_against_rod(box, rod, 0.1f);
    ASSERT_TRUE(is_finite(m));
    if (std::abs(expected - 0.1) < 1e-5) continue;
    ASSERT_EQ(m.point_count == 0, expected > 0.1) << expected << " " << i;
    if (m.point_count == 0) continue;
    ++met;
    twice += m.point_count == 2;
    sunk += expected + rod.radius < 0.0;
    ASSERT_NEAR(deepest(m), expected, 1e-4) << i;
    double top = -1e30;
    for (std::uint32_t v = 0; v < 8; ++v)
      top = std::max(top, dot(accurate(m.normal), accurate(box.vertices[v])));
    const double low = std::min(dot(accurate(m.normal), accurate(rod.from)),
                                dot(accurate(m.normal), accurate(rod.to)));
    if (expected + rod.radius > 1e-2 || expected + rod.radius < -1e-4) {
      ASSERT_NEAR(low - top - rod.radius, expected, 0.05) << i;
    }
    if (m.point_count == 2) {
      ASSERT_NE(m.points[0].feature, m.points[1].feature);
    }
  }
  EXPECT_GT(met, 8000);
  EXPECT_GT(sunk, 2000);
  EXPECT_GT(twice, 1000);
}

TEST(RodCollision, FeaturesPersistUnderSmallMotion) {
  Draw draw;
  int changed = 0;
  int compared = 0;
  for (int i = 0; i < 2000; ++i) {
    const Solid box = make_box({{0.5f, 0.6f, 0.7f}}, kZero);
    const Rod rod = {draw.vector(1.4f), draw.vector(1.4f), 0.3f};
    const Vec<3> shift = draw.vector(1e-5f);
    const Rod moved = {rod.from + shift, rod.to + shift, 0.3f};
    const Manifold<3> a = solid_against_rod(box, rod, 0.05f);
    const Manifold<3> b = solid_against_rod(box, moved, 0.05f);
    if (a.point_count == 0 || a.point_count != b.point_count) continue;
    ++compared;
    for (std::uint32_t k = 0; k < a.point_count; ++k)
      changed += a.points[k].feature != b.points[k].feature;
  }
  EXPECT_GT(compared, 800);
  EXPECT_LE(changed, 4);
}

// Sizes by a power of two change no digit: nothing in it has a length of its own.
TEST(RodCollision, IsTheSameAtAllSizes) {
  Draw draw;
  int met = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec<3> half = {{0.3f, 0.5f, 0.7f}};
    const Rotation<3> turn = draw.rotation();
    const Rod a = {draw.vector(1.0f), draw.vector(1.0f), 0.3f};
    const Rod b = {draw.vector(1.0f), draw.vector(1.0f), 0.2f};
    for (const float size : {1.0f / 1024.0f, 1024.0f}) {
      const auto scaled = [&](const Rod& r) {
        return Rod{size * r.from, size * r.to, size * r.radius};
      };
      const Manifold<3> pairs[2][2] = {
          {rod_against_rod(a, b, 0.1f), rod_against_rod(scaled(a), scaled(b), 0.1f * size)},
          {solid_against_rod(make_box(half, kZero, turn), a, 0.1f),
           solid_against_rod(make_box(size * half, kZero, turn), scaled(a), 0.1f * size)}};
      for (const auto& [one, other] : pairs) {
        ASSERT_EQ(one.point_count, other.point_count);
        met += static_cast<int>(one.point_count);
        for (std::uint32_t k = 0; k < one.point_count; ++k) {
          ASSERT_EQ(size * one.points[k].separation, other.points[k].separation);
          ASSERT_EQ(one.points[k].feature, other.points[k].feature);
        }
      }
    }
  }
  EXPECT_GT(met, 2000);
}

TEST(RodCollision, HalfSpaceMeetsABallInOnePointAndACapsuleInTwo) {
  const Vec<3> up = {{0.0f, 1.0f, 0.0f}};
  const Rod ball = {{{1.0f, 0.5f, 0.0f}}, {{1.0f, 0.5f, 0.0f}}, 0.75f};
  const Manifold<3> m = half_space_against_rod(up, 0.0f, ball, 0.01f);
  ASSERT_EQ(m.point_count, 1u);
  EXPECT_NEAR(m.points[0].separation, -0.25f, 1e-6f);
  EXPECT_NEAR(m.points[0].anchor_a[1], -0.125f, 1e-6f);
  const Rod capsule = {{{1.0f, 0.5f, 0.0f}}, {{2.0f, 0.5f, 0.0f}}, 0.5f};
  EXPECT_EQ(half_space_against_rod(up, 0.0f, capsule, 0.01f).point_count, 2u);
}

}  // namespace cycloid::solver
