#include "solver/queries/separation.hpp"

#include <gtest/gtest.h>

#include <random>

#include "solver/motion.hpp"
#include "solver/trig.hpp"

namespace cycloid::solver {

/// A point, a line or a polygon of up to eight corners around `centre`, which may be rounded.
static Core<2> drawn_core(std::mt19937& random, const Vec<2>& centre) {
  const auto drawn = [&](float from, float to) {
    return from + (to - from) * static_cast<float>(random() % 4096) / 4096.0f;
  };
  Core<2> core{};
  core.count = 1 + random() % 8;
  core.kind = core.count == 1   ? ShapeKind::kBall
              : core.count == 2 ? ShapeKind::kCapsule
                                : ShapeKind::kPolygon;
  core.radius = random() % 2 == 0 ? 0.0f : 0.125f;
  const float size = drawn(0.2f, 2.0f);
  float angle = drawn(0.0f, 6.0f);
  for (std::uint32_t i = 0; i < core.count; ++i) {
    const Rotation<2> direction = rotation_by(Spin<2>{{angle}});
    core.vertices[i] = centre + size * Vec<2>{{direction[0], direction[1]}};
    angle += drawn(0.5f, 1.0f) * 2.0f * kPi / static_cast<float>(core.count);
  }
  for (std::uint32_t i = 0; i < core.count; ++i) {
    const Vec<2> span = core.vertices[core.next(i)] - core.vertices[i];
    core.normals[i] = normalized_or(Vec<2>{{span[1], -span[0]}}, Vec<2>{{1.0f, 0.0f}});
  }
  return core;
}

/// The square of the distance of a point from an edge.
static float square_from_edge(const Vec<2>& from, const Vec<2>& to, const Vec<2>& point) {
  const Vec<2> span = to - from;
  const float square = dot(span, span);
  const float fraction = square > 0.0f ? clamp(dot(point - from, span) / square, 0.0f, 1.0f) : 0.0f;
  const Vec<2> between = point - (fraction < 1.0f ? from + fraction * span : to);
  return dot(between, between);
}

/// The least over all vertices of `points` and edges of `edges`, one after the other.
static float least_square(const Core<2>& edges, const Core<2>& points) {
  float least = 3.0e38f;
  const std::uint32_t edge_count = edges.count > 2 ? edges.count : 1;
  for (std::uint32_t i = 0; i < edge_count; ++i)
    for (std::uint32_t j = 0; j < points.count; ++j)
      least = min(least, square_from_edge(edges.vertices[i], edges.vertices[edges.next(i)],
                                          points.vertices[j]));
  return least;
}

/// The greatest over the edges of `a` of how far all of `b` is outside.
static float greatest_height(const Core<2>& a, const Core<2>& b) {
  float greatest = -3.0e38f;
  for (std::uint32_t i = 0; i < a.count && a.count > 1; ++i) {
    float lowest = 3.0e38f;
    for (std::uint32_t j = 0; j < b.count; ++j)
      lowest = min(lowest, dot(a.normals[i], b.vertices[j] - a.vertices[i]));
    greatest = max(greatest, lowest);
  }
  return greatest;
}

TEST(Separation, OfFourVerticesAtATimeIsThatOfOneByOne) {
  std::mt19937 random(20261126);
  int apart = 0;
  int crossing = 0;
  for (int round = 0; round < 20000; ++round) {
    const float way = static_cast<float>(random() % 1024) / 256.0f;
    const Core<2> a = drawn_core(random, {{0.0f, 0.0f}});
    const Core<2> b = drawn_core(random, {{way, 0.25f}});
    const Separation<2> found = separation_of(a, b);
    const float radii = a.radius + b.radius;
    const float height = max(greatest_height(a, b), greatest_height(b, a));
    const bool has_area = a.count > 2 || b.count > 2;
    EXPECT_TRUE(!has_area || found.crossing == (height < 0.0f)) << round;
    if (found.crossing) {
      ++crossing;
      EXPECT_TRUE(!has_area || found.distance == height - radii) << round;
      continue;
    }
    const float distance = sqrt(min(least_square(a, b), least_square(b, a)));
    if (distance < 1.0e-6f) continue;
    ++apart;
    EXPECT_EQ(found.distance, distance - radii) << round;
    const Vec<2> between = found.point_b - found.point_a;
    EXPECT_NEAR(dot(between, found.normal), found.distance, 1.0e-5f) << round;
    EXPECT_NEAR(length(between), abs(found.distance), 1.0e-5f) << round;
  }
  EXPECT_GT(apart, 5000);
  EXPECT_GT(crossing, 5000);
}

}  // namespace cycloid::solver
