#include "solver/collision/rod.hpp"
#include "solver/collision/triangle.hpp"

namespace cycloid::solver {

/// The edge of the triangle that is nearest to the rod; of equal ones the first.
struct NearestEdge {
  std::uint32_t edge = 0;
  SegmentPair pair;
};

static NearestEdge nearest_edge(const Solid& triangle, const Rod& rod) {
  NearestEdge nearest;
  nearest.pair = nearest_to_edge(triangle, 0, rod);
  for (std::uint32_t i = 1; i < 3; ++i) {
    const SegmentPair pair = nearest_to_edge(triangle, 2 * i, rod);
    if (pair.distance < nearest.pair.distance) nearest = {i, pair};
  }
  return nearest;
}

/// The edges that the nearest point lies on.
static std::uint32_t edges_of(const NearestEdge& nearest) {
  if (nearest.pair.fraction_a == 0.0f) return edges_at(nearest.edge);
  if (nearest.pair.fraction_a == 1.0f) return edges_at(nearest.edge == 2 ? 0 : nearest.edge + 1);
  return 1u << nearest.edge;
}

static float height_at(const Solid& triangle, const Rod& rod, float fraction) {
  return dot(triangle.normals[0], point_on(rod, fraction) - triangle.vertices[0]);
}

/// A rod is met from the free side, by a rule without memory: its middle may lie behind the plane
/// by half of its radius where it is over the triangle, and is then pushed out along the
/// triangle's normal, and not at all where it is beside it. The other half of the radius is for
/// what lies on the back: triangles back to back would otherwise pull it through.
Manifold<3> triangle_against_rod(const Solid& triangle, const Rod& rod, const Vec<3>& a_to_b,
                                 float margin) {
  const float reach = rod.radius + margin;
  const float from = height_at(triangle, rod, 0.0f);
  const float to = height_at(triangle, rod, 1.0f);
  if (min(from, to) > reach || max(from, to) < -0.5f * rod.radius) return {};

  Manifold<3> manifold;
  manifold.normal = triangle.normals[0];
  const float slack = rounding_of(triangle, rod);
  const Span span = clip_to_face(triangle, 0, rod, 0.1f * slack);
  const bool over = span.from <= span.to;
  const float low = min(height_at(triangle, rod, span.from), height_at(triangle, rod, span.to));
  const bool end_over = over && (from <= to ? span.from == 0.0f : span.to == 1.0f);
  if (over && (end_over || low <= 0.0f)) {
    if (0.5f * (from + to) >= -0.5f * rod.radius)
      add_span(triangle, 0, rod, span, a_to_b, margin, manifold);
    return manifold;
  }

  const NearestEdge nearest = nearest_edge(triangle, rod);
  if (nearest.pair.distance > reach) return {};
  const Vec<3> normal = normal_between(edge_rod(triangle, 2 * nearest.edge), rod, nearest.pair);
  const Leaning leaning = leaning_of(triangle, edges_of(nearest), normal);
  // A rod across an edge where the surface goes on flat is over both triangles; so is, by a
  // rounding, one that lies on the triangle and sticks out over its edge.
  const bool lies_flat = dot(normal, triangle.normals[0]) > kLiesFlat &&
                         low <= nearest.pair.distance + 1.0e-4f * rod.radius;
  if (over && (lies_flat || leaning == Leaning::kOwnOnly)) {
    add_span(triangle, 0, rod, span, a_to_b, margin, manifold);
    return manifold;
  }
  if (leaning != Leaning::kAllowed) return {};
  if (dot(normal, triangle.normals[0]) < -kFlat) return {};
  // Beside the triangle by a rounding only: in the middle of a surface, where nothing may stumble.
  const bool upright = dot(normal, triangle.normals[0]) > 1.0f - kFlat * kFlat;
  manifold.normal = upright ? triangle.normals[0] : normal;
  add_edge_points(triangle, 2 * nearest.edge, rod, nearest.pair, a_to_b, margin, manifold);
  return manifold;
}

}  // namespace cycloid::solver
