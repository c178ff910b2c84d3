#include "solver/collision/solid_clip.hpp"

namespace cycloid::solver {

/// The feature of the one point of solids apart whose nearest features are not an axis' own.
static constexpr std::uint32_t kNearest = 0x60000000u;

NearestPoints nearest_points(const Vec<3>& p0, const Vec<3>& p1, const Vec<3>& q0,
                             const Vec<3>& q1) {
  const Vec<3> u = p1 - p0;
  const Vec<3> v = q1 - q0;
  const Vec<3> r = p0 - q0;
  const float a = dot(u, u);
  const float e = dot(v, v);
  const float b = dot(u, v);
  const float c = dot(u, r);
  const float f = dot(v, r);
  const float denominator = a * e - b * b;
  // Parallel within 1e-3 rad: any pair across will do; the ends are settled below.
  float s = denominator > 1.0e-6f * a * e ? clamp((b * f - c * e) / denominator, 0.0f, 1.0f) : 0.0f;
  float t = (b * s + f) / e;
  if (t < 0.0f) {
    t = 0.0f;
    s = clamp(-c / a, 0.0f, 1.0f);
  } else if (t > 1.0f) {
    t = 1.0f;
    s = clamp((b - c) / a, 0.0f, 1.0f);
  }
  return {p0 + s * u, q0 + t * v};
}

/// The extent of a solid along a direction, m.
struct Extent {
  float low;
  float high;
};
static Extent extent_of(const Solid& solid, const Vec<3>& direction) {
  Extent extent = {dot(direction, solid.vertices[0]), dot(direction, solid.vertices[0])};
  for (std::uint32_t i = 1; i < solid.vertex_count; ++i) {
    const float along = dot(direction, solid.vertices[i]);
    extent = {min(extent.low, along), max(extent.high, along)};
  }
  return extent;
}

/// Even half-edges of which an end reaches `level` along a direction.
struct Edges {
  std::uint32_t index[kHullEdgesMax / 2];
  std::uint32_t count = 0;
};
static void edges_above(const Solid& solid, const Vec<3>& direction, float level, Edges& edges) {
  for (std::uint32_t e = 0; e < solid.edge_count; e += 2) {
    const float from = dot(direction, solid.vertices[solid.edges[e].origin]);
    const float to = dot(direction, solid.vertices[end_of(solid, e)]);
    if (max(from, to) >= level) edges.index[edges.count++] = e;
  }
}

/// An axis from a to b, unit, and how far the solids are apart along it, m.
struct Separation {
  Vec<3> normal;
  float separation;
};

/// The nearest points of any two edges, if they are no farther apart than `margin`: these lie
/// within the margin less the separation of the planes that bound the solids along the axis.
static NearestPoints nearest_edges(const Solid& a, const Solid& b, const Separation& axis,
                                   float margin) {
  const float depth = margin - axis.separation;
  Edges edges_a;
  Edges edges_b;
  edges_above(a, axis.normal, extent_of(a, axis.normal).high - depth, edges_a);
  edges_above(b, -axis.normal, -extent_of(b, axis.normal).low - depth, edges_b);
  NearestPoints nearest = {a.vertices[0], b.vertices[0]};
  float least = 1.0e30f;
  for (std::uint32_t i = 0; i < edges_a.count; ++i) {
    const Vec<3> p0 = a.vertices[a.edges[edges_a.index[i]].origin];
    const Vec<3> p1 = a.vertices[end_of(a, edges_a.index[i])];
    for (std::uint32_t j = 0; j < edges_b.count; ++j) {
      const std::uint32_t edge = edges_b.index[j];
      const NearestPoints here =
          nearest_points(p0, p1, b.vertices[b.edges[edge].origin], b.vertices[end_of(b, edge)]);
      const Vec<3> between = here.q - here.p;
      const float squared = dot(between, between);
      if (squared >= least) continue;
      least = squared;
      nearest = here;
    }
  }
  return nearest;
}

/// One point between p on a and q on b, on the axis along which the solids are farther apart: the
/// one given or the line between the points. None where these are farther than the margin.
static Manifold<3> touch_between(const Solid& a, const Solid& b, Separation axis,
                                 const NearestPoints& points, std::uint32_t feature,
                                 const Vec<3>& a_to_b, float margin) {
  Manifold<3> manifold;
  const Vec<3> between = points.q - points.p;
  if (length(between) > margin) return manifold;
  const Vec<3> line = normalized_or(between, axis.normal);
  const float gap = extent_of(b, line).low - extent_of(a, line).high;
  if (gap > axis.separation) axis = {line, gap};
  manifold.normal = axis.normal;
  add_point(points.p + 0.5f * between, axis.separation, feature, a_to_b, manifold);
  return manifold;
}

/// Of solids apart, whose nearest features are not those of the axis.
static Manifold<3> touch_nearest(const Solid& a, const Solid& b, const Separation& axis,
                                 const Vec<3>& a_to_b, float margin) {
  return touch_between(a, b, axis, nearest_edges(a, b, axis, margin), kNearest, a_to_b, margin);
}

/// The corner of the other solid that is deepest below the reference face.
static std::uint32_t deepest_corner(const FacePair& pair) {
  const Vec<3> normal = pair.reference.normals[pair.reference_face];
  std::uint32_t deepest = 0;
  float lowest = dot(normal, pair.incident.vertices[0]);
  for (std::uint32_t i = 1; i < pair.incident.vertex_count; ++i) {
    const float height = dot(normal, pair.incident.vertices[i]);
    if (height >= lowest) continue;
    lowest = height;
    deepest = i;
  }
  return deepest;
}

/// Whether a point is above or below the reference face, within its borders.
static bool faces_point(const FacePair& pair, const Vec<3>& point) {
  const Solid& solid = pair.reference;
  const std::uint32_t first = solid.faces[pair.reference_face].edge;
  std::uint32_t edge = first;
  do {
    const Vec<3> from = solid.vertices[solid.edges[edge].origin];
    const Vec<3> along = solid.vertices[end_of(solid, edge)] - from;
    if (dot(cross(along, solid.normals[pair.reference_face]), point - from) > 0.0f) return false;
    edge = solid.edges[edge].next;
  } while (edge != first);
  return true;
}

Manifold<3> touch_faces(const FacePair& pair, const AxisTolerance& tolerance, const Vec<3>& a_to_b,
                        float margin) {
  Clipped clipped;
  clip_faces(pair, margin, clipped);
  const Vec<3> normal = pair.reference.normals[pair.reference_face];
  if (clipped.lowest > pair.separation + tolerance.edge) {
    const std::uint32_t corner = deepest_corner(pair);
    const Vec<3> at = pair.incident.vertices[corner];
    if (pair.separation > 0.0f && !faces_point(pair, at)) {
      const Separation axis = {pair.on_b ? -normal : normal, pair.separation};
      return touch_nearest(pair.on_b ? pair.incident : pair.reference,
                           pair.on_b ? pair.reference : pair.incident, axis, a_to_b, margin);
    }
    clipped.candidates[clipped.count++] = {
        at - (0.5f * pair.separation) * normal, pair.separation,
        clip_feature(pair.on_b, pair.reference_face, corner, kCorner)};
  }
  Manifold<3> manifold;
  manifold.normal = pair.on_b ? -normal : normal;
  reduce(std::span(clipped.candidates).first(clipped.count), a_to_b, manifold);
  return manifold;
}

Manifold<3> touch_edges(const EdgePair& pair, const Vec<3>& a_to_b, float margin) {
  const Solid& a = pair.a;
  const Solid& b = pair.b;
  const NearestPoints points =
      nearest_points(a.vertices[a.edges[pair.edge_a].origin], a.vertices[end_of(a, pair.edge_a)],
                     b.vertices[b.edges[pair.edge_b].origin], b.vertices[end_of(b, pair.edge_b)]);
  const Vec<3> between = points.q - points.p;
  // Apart, and the nearest points do not lie within the edges, so there may be nearer ones.
  if (pair.separation > 0.0f && length(between) > pair.separation + 1.0e-4f)
    return touch_nearest(a, b, {pair.normal, pair.separation}, a_to_b, margin);
  Manifold<3> manifold;
  manifold.normal = pair.normal;
  add_point(points.p + 0.5f * between, pair.separation, edge_feature(pair.edge_a, pair.edge_b),
            a_to_b, manifold);
  return manifold;
}

}  // namespace cycloid::solver
