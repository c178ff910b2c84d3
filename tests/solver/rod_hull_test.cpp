#include <array>
#include <vector>

#include "tests/solver/round_fixture.hpp"

namespace cycloid::solver {

using Triple = std::array<double, 3>;
static Triple triple(const Vec<3>& v) {
  return {v[0], v[1], v[2]};
}
static Triple sum(const Triple& a, const Triple& b, double scale) {
  return {a[0] + scale * b[0], a[1] + scale * b[1], a[2] + scale * b[2]};
}
static double inner(const Triple& a, const Triple& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
static Triple outer(const Triple& a, const Triple& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// An octahedron: corner 2 k + s lies along axis k, negatively for s = 0.
struct Octahedron {
  std::array<std::array<std::uint32_t, 3>, 8> corners;
  std::array<PolyhedronFace, 8> faces;
  std::array<PolyhedronEdge, 24> edges;

  Octahedron() {
    std::uint32_t count = 0;
    std::uint32_t ends[24] = {};
    for (std::uint32_t f = 0; f < 8; ++f) {
      const bool odd = ((f ^ f >> 1 ^ f >> 2) & 1u) != 0;
      corners[f] = {f & 1u, 2 + (f >> 1 & 1u), 4 + (f >> 2 & 1u)};
      if (!odd) std::swap(corners[f][1], corners[f][2]);
      std::uint32_t found[3];
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t from = corners[f][k];
        const std::uint32_t to = corners[f][(k + 1) % 3];
        std::uint32_t e = 0;
        while (e < count && !(edges[e].origin == from && ends[e] == to)) ++e;
        if (e == count) {
          edges[e] = {from, e + 1, 0, 0};
          edges[e + 1] = {to, e, 0, 0};
          ends[e] = to;
          ends[e + 1] = from;
          count += 2;
        }
        edges[e].face = f;
        found[k] = e;
      }
      for (std::uint32_t k = 0; k < 3; ++k) edges[found[k]].next = found[(k + 1) % 3];
      faces[f].edge = std::min({found[0], found[1], found[2]});
    }
  }

  Solid placed(const Vec<3>& half, const Rotation<3>& rotation, const Vec<3>& position) const {
    Solid solid;
    solid.kind = ShapeKind::kHull;
    solid.centre = position;
    solid.ghosts = 0;
    solid.vertex_count = 6;
    solid.face_count = 8;
    solid.edge_count = 24;
    solid.faces = faces.data();
    solid.edges = edges.data();
    for (std::uint32_t i = 0; i < 6; ++i) {
      Vec<3> arm = kZero;
      const int axis = static_cast<int>(i / 2);
      arm[axis] = (i & 1u) != 0 ? half[axis] : -half[axis];
      solid.vertices[i] = position + rotate(rotation, arm);
    }
    for (std::uint32_t f = 0; f < 8; ++f) {
      const Vec<3> a = solid.vertices[corners[f][0]];
      const Vec<3> normal =
          cross(solid.vertices[corners[f][1]] - a, solid.vertices[corners[f][2]] - a);
      solid.normals[f] = (1.0f / length(normal)) * normal;
    }
    return solid;
  }
};

static double point_to_triangle(const Triple& p, const std::array<Triple, 3>& t) {
  double nearest = 1e30;
  const Triple normal = outer(sum(t[1], t[0], -1.0), sum(t[2], t[0], -1.0));
  bool over = true;
  for (std::size_t i = 0; i < 3; ++i) {
    const Triple along = sum(t[(i + 1) % 3], t[i], -1.0);
    const Triple offset = sum(p, t[i], -1.0);
    over = over && inner(outer(along, normal), offset) <= 0.0;
    const double s = std::clamp(inner(offset, along) / inner(along, along), 0.0, 1.0);
    const Triple between = sum(offset, along, -s);
    nearest = std::min(nearest, std::sqrt(inner(between, between)));
  }
  if (!over) return nearest;
  return std::abs(inner(normal, sum(p, t[0], -1.0))) / std::sqrt(inner(normal, normal));
}

/// Of the axis of a rod from a hull; negative: the least it has to move to leave it.
static double hull_distance(const Octahedron& shape, const Solid& hull, const Rod& rod) {
  const Triple from = triple(rod.from);
  const Triple along = sum(triple(rod.to), from, -1.0);
  std::vector<std::array<Triple, 3>> triangles;
  std::vector<Triple> normals;
  for (const auto& c : shape.corners) {
    triangles.push_back(
        {triple(hull.vertices[c[0]]), triple(hull.vertices[c[1]]), triple(hull.vertices[c[2]])});
    const auto& t = triangles.back();
    normals.push_back(outer(sum(t[1], t[0], -1.0), sum(t[2], t[0], -1.0)));
  }
  const auto apart = [&](double s) {
    const Triple p = sum(from, along, s);
    double nearest = 1e30;
    bool inside = true;
    for (std::size_t f = 0; f < 8; ++f) {
      inside = inside && inner(normals[f], sum(p, triangles[f][0], -1.0)) <= 0.0;
      nearest = std::min(nearest, point_to_triangle(p, triangles[f]));
    }
    return inside ? 0.0 : nearest;
  };
  double lower = 0.0;
  double upper = 1.0;
  for (int i = 0; i < 60; ++i) {
    const double a = (2.0 * lower + upper) / 3.0;
    const double b = (lower + 2.0 * upper) / 3.0;
    (apart(a) < apart(b) ? upper : lower) = apart(a) < apart(b) ? b : a;
  }
  const double distance = std::min({apart(lower), apart(0.0), apart(1.0)});
  if (distance > 1e-7) return distance;
  for (std::uint32_t e = 0; e < 24; e += 2)
    normals.push_back(outer(along, sum(triple(hull.vertices[hull.edges[e].origin]),
                                       triple(hull.vertices[hull.edges[e + 1].origin]), -1.0)));
  double best = -1e30;
  for (const Triple& normal : normals)
    for (const double sign : {1.0, -1.0}) {
      const double size = std::sqrt(inner(normal, normal));
      if (size < 1e-9) continue;
      double top = -1e30;
      for (std::size_t i = 0; i < 6; ++i)
        top = std::max(top, sign * inner(normal, triple(hull.vertices[i])));
      const double low =
          std::min(sign * inner(normal, from), sign * inner(normal, sum(from, along, 1)));
      best = std::max(best, (low - top) / size);
    }
  return best;
}

TEST(RodCollision, CapsuleHullPairsMatchTheDistanceInDoublePrecision) {
  const Octahedron shape;
  Draw draw;
  int met = 0;
  int sunk = 0;
  for (int i = 0; i < 6000; ++i) {
    const Vec<3> half = {
        {draw.within(0.3f, 1.5f), draw.within(0.3f, 1.5f), draw.within(0.3f, 1.5f)}};
    const Solid hull = shape.placed(half, draw.rotation(), draw.vector(0.5f));
    Rod rod = {draw.vector(1.6f), draw.vector(1.6f), draw.within(0.05f, 0.5f)};
    if (i % 4 == 1) rod.to = rod.from;
    if (i % 4 == 2)
      rod.to = rod.from + draw.within(0.2f, 1.0f) * (hull.vertices[0] - hull.vertices[2]);
    const double expected = hull_distance(shape, hull, rod) - rod.radius;
    const Manifold<3> m = solid_against_rod(hull, rod, 0.1f);
    ASSERT_TRUE(is_finite(m));
    if (std::abs(expected - 0.1) < 1e-5) continue;
    ASSERT_EQ(m.point_count == 0, expected > 0.1) << expected << " " << i;
    if (m.point_count == 0) continue;
    ++met;
    sunk += expected + rod.radius < 0.0;
    ASSERT_NEAR(deepest(m), expected, 1e-4) << i;
  }
  EXPECT_GT(met, 2000);
  EXPECT_GT(sunk, 500);
}

}  // namespace cycloid::solver
