#include "solver/collision/hull.hpp"

#include "solver/collision/closest_fractions.hpp"

namespace cycloid::solver {

/// An edge of one hull as the reference of a manifold.
struct Axis {
  std::uint32_t edge = 0;
  float separation = -3.0e38f;  ///< Of the cores, along the edge's normal, m.
};

/// Of four edges each: how far the lowest of four vertices lies outside.
[[gnu::always_inline]] inline Lanes<4> lowest_of_four(const Four& normals, const Four& starts,
                                                      const Four& vertices) {
  const auto height = [&](Lanes<4> x, Lanes<4> y) { return dot(normals, Four{{x, y}} - starts); };
  Lanes<4> lowest = height(each_is<0>(vertices[0]), each_is<0>(vertices[1]));
  lowest = min(height(each_is<1>(vertices[0]), each_is<1>(vertices[1])), lowest);
  lowest = min(height(each_is<2>(vertices[0]), each_is<2>(vertices[1])), lowest);
  return min(height(each_is<3>(vertices[0]), each_is<3>(vertices[1])), lowest);
}
[[gnu::always_inline]] inline Lanes<4> lowest_of_two(const Four& normals, const Four& starts,
                                                     const Four& vertices) {
  const auto height = [&](Lanes<4> x, Lanes<4> y) { return dot(normals, Four{{x, y}} - starts); };
  return min(height(each_is<1>(vertices[0]), each_is<1>(vertices[1])),
             height(each_is<0>(vertices[0]), each_is<0>(vertices[1])));
}

/// The edge of `a` that `b` is farthest outside of. For a segment only its free side counts.
static inline Axis deepest_axis(const Hull& a, const Hull& b) {
  Axis best;
  const std::uint32_t edges = a.one_sided ? 1 : a.count;
  for (std::uint32_t first = 0; first < edges; first += 4) {
    const Four normals = four_normals(a, first);
    const Four starts = four_vertices(a, first);
    const Four vertices = four_vertices(b, 0);
    Lanes<4> lowest = b.count == 2 ? lowest_of_two(normals, starts, vertices)
                                   : lowest_of_four(normals, starts, vertices);
    if (b.count > 4) lowest = min(lowest_of_four(normals, starts, four_vertices(b, 4)), lowest);
    if (a.one_sided) return {0, lowest.raw[0]};
    const Greatest most = greatest_of(lowest);
    if (most.value > best.separation) best = {first + most.lane, most.value};
  }
  return best;
}

/// The edge of `hull` whose normal is most opposed to `normal`.
static std::uint32_t incident_edge(const Hull& hull, const Vec<2>& normal) {
  std::uint32_t best = 0;
  float lowest = 3.0e38f;
  for (std::uint32_t first = 0; first < hull.count; first += 4) {
    const Lanes<4> along = dot(four_normals(hull, first), in_each_lane(normal));
    if (hull.one_sided) return along.raw[1] < along.raw[0] ? 1 : 0;
    const Greatest least = greatest_of(-along);
    if (-least.value < lowest) {
      lowest = -least.value;
      best = first + least.lane;
    }
  }
  return best;
}

struct Edge {
  std::uint32_t from;
  std::uint32_t to;
};
static Edge edge_of(const Hull& hull, std::uint32_t i) {
  return {i, i + 1 < hull.count ? i + 1 : 0};
}

/// What the two reference choices share: the reference hull, its edge, and the incident hull.
struct Reference {
  const Hull& hull;
  const Hull& other;
  std::uint32_t edge;
  bool flipped;  ///< The reference is shape b.
};

/// Of a feature of the reference and one of the other: the same whichever of the shapes is the
/// reference. Two overlapping boxes change that from tick to tick, and a point that lost its
/// impulses for it would have to find them again: a pyramid never came to rest.
static std::uint32_t feature_id(const Reference& reference, std::uint32_t own,
                                std::uint32_t of_other) {
  const std::uint32_t a = reference.flipped ? of_other : own;
  const std::uint32_t b = reference.flipped ? own : of_other;
  return (a << 4) | (b << 1);
}

/// The line between two vertices, where these are what is closest; no point otherwise.
static bool vertex_against_vertex(const Reference& reference, const Edge& incident, float margin,
                                  Manifold<2>& manifold) {
  const Edge edge = edge_of(reference.hull, reference.edge);
  const Vec<2> p = reference.hull.vertex(edge.from);
  const Vec<2> q = reference.other.vertex(incident.from);
  const Vec<2> d1 = reference.hull.vertex(edge.to) - p;
  const Vec<2> d2 = reference.other.vertex(incident.to) - q;
  const auto [s, t] = closest_fractions(p, d1, q, d2);
  const bool ends = (s == 0.0f || s == 1.0f) && (t == 0.0f || t == 1.0f);
  if (!ends) return false;
  const Vec<2> on_reference = p + s * d1;
  const Vec<2> on_other = q + t * d2;
  const Vec<2> between = on_other - on_reference;
  const float distance = length(between);
  if (distance < 1.0e-6f) return false;
  const float reach = reference.hull.radius + reference.other.radius;
  if (distance - reach > margin) return true;
  const Vec<2> direction = (1.0f / distance) * between;
  const float separation = distance - reach;
  manifold.normal = reference.flipped ? -direction : direction;
  const Vec<2> surface = on_reference + reference.hull.radius * direction;
  const std::uint32_t feature = feature_id(reference, s == 0.0f ? edge.from : edge.to,
                                           t == 0.0f ? incident.from : incident.to);
  add_point(surface + (0.5f * separation) * direction, separation, 0x400u | feature, manifold);
  return true;
}

/// The incident edge cut to the width of the reference edge: first the end that comes first along
/// the edge of shape a.
static void clip_edges(const Reference& reference, const Edge& incident, float margin,
                       Manifold<2>& manifold) {
  const Edge edge = edge_of(reference.hull, reference.edge);
  const Vec<2> normal = reference.hull.normal(reference.edge);
  const Vec<2> from = reference.hull.vertex(edge.from);
  const Vec<2> span = reference.hull.vertex(edge.to) - from;
  const float width = length(span);
  const Vec<2> tangent = (1.0f / width) * span;
  // The incident edge runs against the reference edge; take its far end first.
  const Vec<2> q[2] = {reference.other.vertex(incident.to), reference.other.vertex(incident.from)};
  const float x[2] = {dot(q[0] - from, tangent), dot(q[1] - from, tangent)};
  if (x[1] < 0.0f || x[0] > width) return;

  const float reach = reference.hull.radius + reference.other.radius;
  manifold.normal = reference.flipped ? -normal : normal;
  const float run = x[1] - x[0];
  const std::uint32_t feature = feature_id(reference, reference.edge, incident.from);
  for (int side = 0; side < 2; ++side) {
    const int i = reference.flipped ? 1 - side : side;
    const float bound = i == 0 ? 0.0f : width;
    const bool outside = i == 0 ? x[0] < bound : x[1] > bound;
    const float fraction = outside && run > 1.0e-9f ? (bound - x[0]) / run : (i == 0 ? 0.0f : 1.0f);
    const Vec<2> point = q[0] + fraction * (q[1] - q[0]);
    const float height = dot(normal, point - from);
    const float separation = height - reach;
    if (separation > margin) continue;
    // Midway between the two surfaces along the normal.
    const Vec<2> at =
        point + (0.5f * (reference.hull.radius - reference.other.radius - height)) * normal;
    add_point(at, separation, feature | static_cast<std::uint32_t>(side), manifold);
  }
}

/// Whether a normal that another hull's edge proposes against a chain segment is one that the
/// chain's own corner allows: between the segment's normal and its neighbour's.
static bool chain_allows(const Hull& segment, const Vec<2>& normal) {
  const Vec<2> own = segment.normal(0);
  if (dot(normal, own) <= 0.0f) return false;
  const bool towards_end = cross(own, normal) > 0.0f;
  if ((segment.ghosts & (towards_end ? 2u : 1u)) == 0) return true;
  const Vec<2> edge =
      towards_end ? segment.vertex(3) - segment.vertex(1) : segment.vertex(0) - segment.vertex(2);
  const Vec<2> neighbour = {{edge[1], -edge[0]}};
  // On a convex corner the normal may turn as far as the neighbour's, on a concave one not at all.
  const float corner = towards_end ? cross(own, neighbour) : cross(neighbour, own);
  const float left = towards_end ? cross(normal, neighbour) : cross(neighbour, normal);
  return corner > 0.0f && left >= 0.0f;
}

Manifold<2> hull_against_hull(const Hull& a, const Hull& b, float margin) {
  const float reach = a.radius + b.radius;
  const Axis axis_a = deepest_axis(a, b);
  if (axis_a.separation > reach + margin) return {};
  Axis axis_b = deepest_axis(b, a);
  if (axis_b.separation > reach + margin) return {};
  // A tie goes to shape a, so that resting boxes do not swap their reference from tick to tick.
  constexpr float kPreference = 1.0e-4f;
  bool flipped = axis_b.separation > axis_a.separation + kPreference;
  if (a.one_sided && flipped) flipped = chain_allows(a, -b.normal(axis_b.edge));
  if (b.one_sided && !flipped) flipped = !chain_allows(b, -a.normal(axis_a.edge));

  const Reference reference =
      flipped ? Reference{b, a, axis_b.edge, true} : Reference{a, b, axis_a.edge, false};
  const Axis& axis = flipped ? axis_b : axis_a;
  const Vec<2> normal = reference.hull.normal(reference.edge);
  const Edge incident = edge_of(reference.other, incident_edge(reference.other, normal));
  Manifold<2> manifold;
  const bool chain = a.one_sided || b.one_sided;
  // Two capsules in one line have no separating axis among their sides.
  const bool ends_may_be_closest = axis.separation > 1.0e-4f || (a.count == 2 && b.count == 2);
  if (ends_may_be_closest && !chain && vertex_against_vertex(reference, incident, margin, manifold))
    return manifold;
  clip_edges(reference, incident, margin, manifold);
  return manifold;
}

Manifold<2> half_space_against_hull(const Vec<2>& normal, float offset, const Hull& hull,
                                    float margin) {
  std::uint32_t first = 0;
  std::uint32_t second = 0;
  float height[8];
  for (std::uint32_t i = 0; i < hull.count; ++i) {
    height[i] = dot(normal, hull.vertex(i)) - offset;
    if (height[i] < height[first]) first = i;
  }
  second = first == 0 ? 1 : 0;
  for (std::uint32_t i = 0; i < hull.count; ++i)
    if (i != first && height[i] < height[second]) second = i;

  Manifold<2> manifold;
  manifold.normal = normal;
  // In index order, not by depth, so that two nearly equal depths do not swap the points.
  const std::uint32_t low = first < second ? first : second;
  const std::uint32_t high = first < second ? second : first;
  for (const std::uint32_t i : {low, high}) {
    const float separation = height[i] - hull.radius;
    if (separation > margin) continue;
    const Vec<2> at = hull.vertex(i) - (hull.radius + 0.5f * separation) * normal;
    add_point(at, separation, i, manifold);
  }
  return manifold;
}

}  // namespace cycloid::solver
