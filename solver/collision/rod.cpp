#include "solver/collision/rod.hpp"

namespace cycloid::solver {

static Vec<3> without(const Vec<3>& vector, const Vec<3>& direction) {
  const float square = dot(direction, direction);
  return vector - (dot(vector, direction) * inverse_or_zero(square)) * direction;
}

/// Across `direction`, upwards as far as possible; where that is nearly upwards itself, along x.
static Vec<3> upwards_across(const Vec<3>& direction) {
  const Vec<3> up = {{0.0f, 1.0f, 0.0f}};
  const Vec<3> across = without(up, direction);
  if (dot(across, across) > 0.01f) return normalized_or(across, up);
  const Vec<3> aside = {{1.0f, 0.0f, 0.0f}};
  return normalized_or(without(aside, direction), aside);
}

Vec<3> normal_between(const Rod& a, const Rod& b, const SegmentPair& pair) {
  const Vec<3> d1 = a.to - a.from;
  const Vec<3> d2 = b.to - b.from;
  const Vec<3> between = pair.on_b - pair.on_a;
  Vec<3> middles = 0.5f * ((b.from - a.from) + (b.to - a.to));
  const float size = length(d1) + length(d2) + a.radius + b.radius;
  const bool apart = pair.distance > 1.0e-6f * size;
  if (pair.crossing) {
    const Vec<3> axis = cross(d1, d2);
    // normalized_or takes very short vectors for none.
    const Vec<3> normal = normalized_or((1.0f / max(dot(d1, d1), dot(d2, d2))) * axis, axis);
    float along = dot(normal, apart ? between : middles);
    if (!apart && abs(along) <= 1.0e-6f * size) along = normal[1];
    return along < 0.0f ? -normal : normal;
  }
  if (apart) return (1.0f / pair.distance) * between;
  const bool inside_a = pair.fraction_a > 0.0f && pair.fraction_a < 1.0f;
  const bool inside_b = pair.fraction_b > 0.0f && pair.fraction_b < 1.0f;
  if (inside_a) middles = without(middles, d1);
  if (inside_b) middles = without(middles, d2);
  const float distance = length(middles);
  if (distance > 1.0e-4f * size) return (1.0f / distance) * middles;
  return upwards_across(dot(d1, d1) > 0.0f ? d1 : d2);
}

bool parallel_points(const Rod& a, const Rod& b, const Vec<3>& normal, AxisPoints (&ends)[2]) {
  const Vec<3> d1 = a.to - a.from;
  const Vec<3> d2 = b.to - b.from;
  const float square_a = dot(d1, d1);
  const float square_b = dot(d2, d2);
  const Vec<3> turn = cross(d1, d2);
  if (!(square_a > 0.0f && square_b > 0.0f)) return false;
  if (dot(turn, turn) > 0.01f * square_a * square_b) return false;
  const float inverse_a = inverse_or_zero(square_a);
  const float inverse_b = inverse_or_zero(square_b);
  const float s[2] = {nearest_fraction(a.from, d1, inverse_a, b.from),
                      nearest_fraction(a.from, d1, inverse_a, b.to)};
  const float overlap = abs(s[1] - s[0]);
  if (overlap * overlap * square_a < 1.0e-4f * min(square_a, square_b)) return false;
  const float reach = min(0.1f * (a.radius + b.radius), 0.03f * overlap * sqrt(square_a));
  for (int k = 0; k < 2; ++k) {
    const float fraction = k == 0 ? min(s[0], s[1]) : max(s[0], s[1]);
    const Vec<3> on_a = a.from + fraction * d1;
    const Vec<3> on_b = b.from + nearest_fraction(b.from, d2, inverse_b, on_a) * d2;
    const Vec<3> between = on_b - on_a;
    const float height = dot(between, normal);
    const Vec<3> aside = between - height * normal;
    if (dot(aside, aside) > reach * reach) return false;
    ends[k] = {on_a, on_b, height};
  }
  return true;
}

Span clip_to_face(const Solid& solid, std::uint32_t face, const Rod& rod, float slack) {
  Span span = {0.0f, 1.0f};
  const std::uint32_t first = solid.faces[face].edge;
  std::uint32_t edge = first;
  do {
    const PolyhedronEdge& half = solid.edges[edge];
    const Vec<3> origin = solid.vertices[half.origin];
    const Vec<3> along = solid.vertices[solid.edges[half.next].origin] - origin;
    const Vec<3> side = cross(along, solid.normals[face]);
    const float bound = slack * length(side);
    const float from = dot(side, rod.from - origin) - bound;
    const float to = dot(side, rod.to - origin) - bound;
    if (from > 0.0f && to > 0.0f) return {1.0f, 0.0f};
    if (from > 0.0f) span.from = max(span.from, from / (from - to));
    if (to > 0.0f) span.to = min(span.to, from / (from - to));
    edge = half.next;
  } while (edge != first);
  return span;
}

void add_span(const Solid& solid, std::uint32_t face, const Rod& rod, const Span& span,
              float margin, Manifold<3>& manifold) {
  const Vec<3> on_face = solid.vertices[solid.edges[solid.faces[face].edge].origin];
  const Vec<3> along = rod.to - rod.from;
  const float run = span.to - span.from;
  const bool point = run * run * dot(along, along) <= 1.0e-6f * rod.radius * rod.radius;
  const float fraction[2] = {span.from, span.to};
  // Of a span without length its lower end, which is the nearer one up to rounding.
  const bool last = dot(manifold.normal, along) < 0.0f;
  for (std::uint32_t k = 0; k < 2; ++k) {
    if (point && (k == 1) != last) continue;
    const Vec<3> at = rod.from + fraction[k] * along;
    const float separation = dot(manifold.normal, at - on_face) - rod.radius;
    if (separation > margin) continue;
    add_point(at - (rod.radius + 0.5f * separation) * manifold.normal, separation,
              clip_feature(false, face, k, 0), manifold);
  }
}

float rounding_of(const Solid& solid, const Rod& rod) {
  const Vec<3> arm = solid.vertices[0] - solid.centre;
  return 1.0e-5f * (sqrt(dot(arm, arm)) + rod.radius);
}

Rod edge_rod(const Solid& solid, std::uint32_t edge) {
  const PolyhedronEdge& half = solid.edges[edge];
  return {solid.vertices[half.origin], solid.vertices[solid.edges[half.twin].origin], 0.0f};
}

SegmentPair nearest_to_edge(const Solid& solid, std::uint32_t edge, const Rod& rod) {
  const Rod line = edge_rod(solid, edge);
  return nearest_points(line.from, line.to, rod.from, rod.to);
}

void add_edge_points(const Solid& solid, std::uint32_t edge, const Rod& rod,
                     const SegmentPair& pair, float margin, Manifold<3>& manifold) {
  const Vec<3> normal = manifold.normal;
  AxisPoints ends[2];
  if (parallel_points(edge_rod(solid, edge), rod, normal, ends)) {
    for (std::uint32_t k = 0; k < 2; ++k) {
      const float separation = ends[k].height - rod.radius;
      if (separation > margin) continue;
      add_point(ends[k].on_b - (rod.radius + 0.5f * separation) * normal, separation,
                edge_feature(edge + k), manifold);
    }
    if (manifold.point_count > 0) return;
  }
  const float separation = pair.distance - rod.radius;
  const PolyhedronEdge& half = solid.edges[edge];
  std::uint32_t feature = edge_feature(edge);
  if (pair.fraction_a == 0.0f) feature = corner_feature(half.origin);
  if (pair.fraction_a == 1.0f) feature = corner_feature(solid.edges[half.twin].origin);
  add_point(pair.on_b - (rod.radius + 0.5f * separation) * normal, separation, feature, manifold);
}

}  // namespace cycloid::solver
