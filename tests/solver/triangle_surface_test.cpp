#include "tests/solver/surface_fixture.hpp"

namespace cycloid::solver {

TEST(TriangleSurface, FlatFloorIsOnePlaneForAllThatSlidesOverIt) {
  // Not at the origin, so that the floor's own edges are rounded.
  const Vec<3> position = {{0.1f, 0.0f, -0.7f}};
  const auto floor = flat(position);
  const auto check = [](const std::vector<Manifold<3>>& all, float separation, int i) {
    ASSERT_FALSE(all.empty()) << i;
    ASSERT_NEAR(deepest(all), separation, 1e-5f) << i;
    for (const Manifold<3>& m : all) {
      expect_normal(m, 0.0f, 1.0f, 0.0f, 1e-5f);
      for (std::uint32_t k = 0; k < m.point_count; ++k)
        ASSERT_NEAR(m.points[k].anchor_a[1], 0.5f * m.points[k].separation, 1e-5f) << i;
    }
  };
  Draw draw;
  int capsules = 0;
  for (int i = 0; i < 1000; ++i) {
    // Every fourth one on the line of an edge, exactly.
    const float u = i % 4 == 0 ? 0.5f * static_cast<float>(i / 4 % 7 + 1) : draw.within(0.1f, 3.9f);
    const float v = i % 8 == 0 ? 1.0f : draw.within(0.1f, 1.9f);
    const Vec<3> at = position + Vec<3>{{u, 0.0f, v}};
    const float depth = draw.within(-0.005f, 0.05f);
    check(meet(floor, ball(at[0], 0.3f - depth, at[2], 0.3f)), -depth, i);
    const Vec<3> spread = {{draw.within(-1.0f, 1.0f), i % 2 == 0 ? 0.0f : draw.within(-0.1f, 0.1f),
                            draw.within(-1.0f, 1.0f)}};
    const Vec<3> core = at + Vec<3>{{0.0f, 0.3f - depth + abs(spread[1]), 0.0f}};
    const auto capsule = meet(floor, Rod{core - spread, core + spread, 0.3f});
    const auto inside = [&](const Vec<3>& end) {
      const Vec<3> local = end - position;
      return local[0] > 0.0f && local[0] < 4.0f && local[2] > 0.0f && local[2] < 2.0f;
    };
    if (inside(core - spread) && inside(core + spread)) {
      check(capsule, -depth, i);
      ++capsules;
    }
    const float half_turn = draw.within(0.0f, 3.0f);
    const Rotation<3> turn = {{0.0f, std::sin(half_turn), 0.0f, std::cos(half_turn)}};
    const Vec<3> half = {{0.4f, 0.2f, 0.3f}};
    check(meet(floor, make_box(half, at + Vec<3>{{0.0f, 0.2f - depth, 0.0f}}, turn)), -depth, i);
  }
  EXPECT_GT(capsules, 300);
}

TEST(TriangleSurface, BallOverARidgeIsAlwaysMetAtItsTrueDistance) {
  for (const float slope : {0.0005f, 0.002f, 0.1f, 1.0f, 5.0f}) {
    const auto triangles = ridge(slope);
    const float steep = std::sqrt(1.0f + slope * slope);
    for (int i = -500; i <= 500; ++i)
      for (const float z : {0.5f, 1.0f, 1.3f}) {
        // Round the ridge at a distance of 0.25 m, and along the slopes.
        const float turn = 0.002f * static_cast<float>(i);
        const float arc = std::atan(slope);
        const float angle = std::clamp(turn * 2.0f, -arc, arc);
        const float beyond = turn * 2.0f - angle;
        const float x = 2.0f + 0.25f * std::sin(angle) + 0.3f * beyond / steep;
        const float y = 0.25f * std::cos(angle) - 0.3f * std::abs(beyond) * slope / steep;
        const auto all = meet(triangles, ball(x, y, z, 0.25f));
        ASSERT_FALSE(all.empty()) << slope << " " << i;
        ASSERT_NEAR(deepest(all), 0.0f, 2e-4f * slope + 1e-5f) << slope << " " << i;
        for (const Manifold<3>& m : all) {
          ASSERT_NEAR(m.normal[0], std::sin(angle), 1.5e-3f) << slope << " " << i;
          ASSERT_NEAR(m.normal[2], 0.0f, 1e-4f);
        }
      }
  }
}

/// Whether a point lies under a triangle.
static bool is_under(const std::vector<Solid>& triangles, const Vec<3>& point) {
  for (const Solid& t : triangles) {
    const Rod down = {{{point[0], 10.0f, point[2]}}, {{point[0], -10.0f, point[2]}}, 0.0f};
    const Vec<3> up = t.normals[0];
    const float high = dot(up, down.from - t.vertices[0]);
    const float low = dot(up, down.to - t.vertices[0]);
    const Vec<3> at = point_on(down, high / (high - low));
    if (at[1] > point[1] && clip_to_face(t, 0, {at, at, 0.0f}, 1e-6f).to > 0.0f) return true;
  }
  return false;
}

/// From the axis of a rod to a triangle; 0 where they cross.
static float triangle_distance(const Solid& t, const Rod& rod) {
  const float from = dot(t.normals[0], rod.from - t.vertices[0]);
  const float to = dot(t.normals[0], rod.to - t.vertices[0]);
  const auto over = [&](const Vec<3>& p) { return clip_to_face(t, 0, {p, p, 0.0f}, 0.0f).to > 0; };
  if (from * to < 0.0f && over(point_on(rod, from / (from - to)))) return 0.0f;
  float distance = 1.0e30f;
  if (over(rod.from)) distance = std::min(distance, abs(from));
  if (over(rod.to)) distance = std::min(distance, abs(to));
  for (std::uint32_t e = 0; e < 6; e += 2)
    distance = std::min(distance, nearest_to_edge(t, e, rod).distance);
  return distance;
}

// Whatever the surface, what is nearest is met: no gap at any edge or corner.
TEST(TriangleSurface, RodOverAnUnevenSurfaceIsAlwaysMetAtItsTrueDistance) {
  Draw draw;
  int met = 0;
  for (int i = 0; i < 20000; ++i) {
    const float rough = draw.within(0.0f, 1.0f);
    const auto triangles = grid([&](float, float) { return draw.within(0.0f, rough); });
    const Vec<3> at = {{draw.within(0.7f, 3.3f), draw.within(0.0f, 1.5f), draw.within(0.6f, 1.4f)}};
    const Vec<3> arm = i % 2 == 0 ? kZero : draw.vector(0.5f);
    const Rod rod = {at - arm, at + arm, 0.3f};
    float distance = 1.0e30f;
    for (const Solid& t : triangles) distance = std::min(distance, triangle_distance(t, rod));
    if (distance > 0.3f || distance < 1e-4f) continue;
    if (is_under(triangles, rod.from) || is_under(triangles, rod.to)) continue;
    ++met;
    const auto all = meet(triangles, rod);
    ASSERT_FALSE(all.empty()) << i << " " << distance;
    ASSERT_NEAR(deepest(all), distance - 0.3f, 1e-4f) << i;
  }
  EXPECT_GT(met, 2000);
}

/// How deep the triangles reach into a box, from points all over them, m.
static float depth_in(const std::vector<Solid>& triangles, const Solid& box) {
  float deep = -1.0f;
  for (const Solid& t : triangles)
    for (int u = 0; u <= 30; ++u)
      for (int v = 0; u + v <= 30; ++v) {
        const Vec<3> at = t.vertices[0] - box.centre +
                          (static_cast<float>(u) / 30.0f) * (t.vertices[1] - t.vertices[0]) +
                          (static_cast<float>(v) / 30.0f) * (t.vertices[2] - t.vertices[0]);
        float inside = 1.0f;
        for (int k = 0; k < 3; ++k)
          inside = std::min(inside, box.half[k] - abs(dot(at, box.axes[k])));
        deep = std::max(deep, inside);
      }
  return deep;
}

// A box that overlaps a surface is met, at least as deep as the surface reaches into it, and not
// much deeper: the normals of a surface are not always the shortest way out.
TEST(TriangleSurface, BoxInAnUnevenSurfaceIsAlwaysMet) {
  Draw draw;
  int met = 0;
  for (int i = 0; i < 6000; ++i) {
    const float rough = draw.within(0.0f, 0.6f);
    const auto triangles = grid([&](float, float) { return draw.within(0.0f, rough); });
    const Vec<3> at = {{draw.within(0.8f, 3.2f), draw.within(0.0f, 1.2f), draw.within(0.8f, 1.2f)}};
    const Solid box = make_box({{0.3f, 0.25f, 0.35f}}, at, draw.rotation());
    if (is_under(triangles, at)) continue;
    const float depth = depth_in(triangles, box);
    if (depth < 0.005f || depth > 0.1f) continue;
    ++met;
    const auto all = meet(triangles, box);
    ASSERT_FALSE(all.empty()) << i << " " << depth;
    ASSERT_LT(deepest(all), 0.01f - depth) << i;
    ASSERT_GT(deepest(all), -0.1f - depth) << i;
  }
  EXPECT_GT(met, 500);
}

}  // namespace cycloid::solver
