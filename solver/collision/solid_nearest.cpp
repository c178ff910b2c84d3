#include "solver/collision/segments.hpp"
#include "solver/collision/solid_clip.hpp"

namespace cycloid::solver {

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
struct SolidEdges {
  std::uint32_t index[kHullEdgesMax / 2];
  std::uint32_t count = 0;
};
static void edges_above(const Solid& solid, const Vec<3>& direction, float level,
                        SolidEdges& edges) {
  for (std::uint32_t e = 0; e < solid.edge_count; e += 2) {
    const float from = dot(direction, solid.vertices[solid.edges[e].origin]);
    const float to = dot(direction, solid.vertices[end_of(solid, e)]);
    if (max(from, to) >= level) edges.index[edges.count++] = e;
  }
}

/// An axis from a to b, unit, and how far the solids are apart along it, m.
struct SolidGap {
  Vec<3> normal;
  float separation;
};

/// Whether two edges are parallel within 0.01 rad and run along each other for a hundredth of the
/// shorter one.
static bool parallel(const Solid& a, std::uint32_t edge_a, const Solid& b, std::uint32_t edge_b) {
  const Vec<3> p = a.vertices[a.edges[edge_a].origin];
  const Vec<3> q = b.vertices[b.edges[edge_b].origin];
  const Vec<3> along_a = a.vertices[end_of(a, edge_a)] - p;
  const Vec<3> along_b = b.vertices[end_of(b, edge_b)] - q;
  const Vec<3> across = cross(along_a, along_b);
  const float square_a = dot(along_a, along_a);
  const float square_b = dot(along_b, along_b);
  if (dot(across, across) > 1.0e-4f * square_a * square_b) return false;
  const float inverse = inverse_or_zero(square_a);
  const float shared =
      nearest_fraction(p, along_a, inverse, q + along_b) - nearest_fraction(p, along_a, inverse, q);
  return shared * shared * square_a >= 1.0e-4f * min(square_a, square_b);
}

/// Two edges and their nearest points.
struct NearestSolidEdges {
  SegmentPair points;
  std::uint32_t edge_a;
  std::uint32_t edge_b;
};

/// The nearest points of any two edges, if they are no farther apart than `margin`: these lie
/// within the margin less the separation of the planes that bound the solids along the axis.
static NearestSolidEdges nearest_edges(const Solid& a, const Solid& b, const SolidGap& axis,
                                       float margin) {
  const float depth = margin - axis.separation;
  SolidEdges edges_a;
  SolidEdges edges_b;
  edges_above(a, axis.normal, extent_of(a, axis.normal).high - depth, edges_a);
  edges_above(b, -axis.normal, -extent_of(b, axis.normal).low - depth, edges_b);
  NearestSolidEdges nearest{};
  nearest.points.on_a = a.vertices[0];
  nearest.points.on_b = b.vertices[0];
  float least = 1.0e30f;
  bool is_parallel = false;
  for (std::uint32_t i = 0; i < edges_a.count; ++i) {
    const Vec<3> p0 = a.vertices[a.edges[edges_a.index[i]].origin];
    const Vec<3> p1 = a.vertices[end_of(a, edges_a.index[i])];
    for (std::uint32_t j = 0; j < edges_b.count; ++j) {
      const std::uint32_t edge = edges_b.index[j];
      const SegmentPair here =
          nearest_points(p0, p1, b.vertices[b.edges[edge].origin], b.vertices[end_of(b, edge)]);
      const Vec<3> between = here.on_b - here.on_a;
      const float squared = dot(between, between);
      // Of pairs that share a nearest corner, one that runs along each other tells more.
      const bool along_each_other =
          squared < 1.0002f * least && parallel(a, edges_a.index[i], b, edge);
      if (squared >= least && !(along_each_other && !is_parallel)) continue;
      if (squared > 0.9998f * least && is_parallel && !along_each_other) continue;
      is_parallel = along_each_other;
      least = min(least, squared);
      nearest = {here, edges_a.index[i], edge};
    }
  }
  return nearest;
}

/// Where two edges that are parallel run along each other, the other end of what
/// they share is a second point.
static void add_far_end(const Solid& a, const Solid& b, const NearestSolidEdges& edges,
                        Nearest& nearest) {
  constexpr float kAside = 5.0e-4f;  // m, between the points, seen along the normal.
  const Vec<3> p = a.vertices[a.edges[edges.edge_a].origin];
  const Vec<3> q = b.vertices[b.edges[edges.edge_b].origin];
  const Vec<3> along = a.vertices[end_of(a, edges.edge_a)] - p;
  const Vec<3> along_b = b.vertices[end_of(b, edges.edge_b)] - q;
  const float square = dot(along, along);
  const float square_b = dot(along_b, along_b);
  if (!parallel(a, edges.edge_a, b, edges.edge_b)) return;
  const float inverse = inverse_or_zero(square);
  const float from = nearest_fraction(p, along, inverse, q);
  const float to = nearest_fraction(p, along, inverse, q + along_b);
  const float here = nearest_fraction(p, along, inverse, nearest.on_a[0]);
  const float far = abs(from - here) > abs(to - here) ? from : to;
  nearest.on_a[1] = p + far * along;
  nearest.on_b[1] =
      q + nearest_fraction(q, along_b, inverse_or_zero(square_b), nearest.on_a[1]) * along_b;
  const Vec<3> aside = cross(nearest.normal, nearest.on_b[1] - nearest.on_a[1]);
  if (length(aside) > kAside) return;
  nearest.feature[1] = kNearest + 1;
  nearest.count = 2;
}

/// Solids apart whose nearest features are no axis' own: those are corners and edges. The axis is
/// the one along which they are farther apart, of `axis` and the line between the points.
static bool nearest_apart(const Solid& a, const Solid& b, SolidGap axis, float margin,
                          Nearest& nearest) {
  const NearestSolidEdges edges = nearest_edges(a, b, axis, margin);
  const Vec<3> between = edges.points.on_b - edges.points.on_a;
  if (length(between) > margin) return false;
  const Vec<3> line = normalized_or(between, axis.normal);
  const float gap = extent_of(b, line).low - extent_of(a, line).high;
  if (gap > axis.separation) axis = {line, gap};
  nearest.normal = axis.normal;
  nearest.separation = axis.separation;
  nearest.count = 1;
  nearest.on_a[0] = edges.points.on_a;
  nearest.on_b[0] = edges.points.on_b;
  nearest.feature[0] = kNearest;
  nearest.of_face = false;
  add_far_end(a, b, edges, nearest);
  return true;
}

/// The points of a pair of edges. @returns how far they are from where the axis says they are, m.
static float points_of_edges(const Solid& a, const Solid& b, const EdgeAxis& axis,
                             Nearest& nearest) {
  const SegmentPair points =
      nearest_points(a.vertices[a.edges[axis.edge_a].origin], a.vertices[end_of(a, axis.edge_a)],
                     b.vertices[b.edges[axis.edge_b].origin], b.vertices[end_of(b, axis.edge_b)]);
  nearest.normal = axis.normal;
  nearest.separation = axis.separation;
  nearest.count = 1;
  nearest.on_a[0] = points.on_a;
  nearest.on_b[0] = points.on_b;
  nearest.feature[0] = edge_feature(axis.edge_a, axis.edge_b);
  nearest.of_face = false;
  return length(points.on_b - points.on_a - axis.separation * axis.normal);
}

/// The lowest of what is under the reference face, of all faces of the other solid that share its
/// deepest corner: whatever feature of it is deepest has that corner. @returns as above.
static float points_of_face(const Solid& a, const Solid& b, const FaceAxis& axis, bool on_b,
                            float slack, Nearest& nearest) {
  const Solid& reference = on_b ? b : a;
  const Solid& incident = on_b ? a : b;
  const Vec<3> normal = reference.normals[axis.face];
  Candidate lowest = {incident.vertices[axis.support], axis.separation,
                      clip_feature(on_b, axis.face, axis.support, kCorner)};
  lowest.at -= (0.5f * lowest.separation) * normal;
  if (!faces_point(reference, axis.face, incident.vertices[axis.support])) {
    lowest.separation = 1.0e30f;
    Clipped clipped;
    for (std::uint32_t e = 0; e < incident.edge_count; ++e) {
      if (incident.edges[e].origin != axis.support) continue;
      const FacePair pair = {reference, incident, axis.face, incident.edges[e].face, on_b, 0.0f};
      clip_faces(pair, axis.separation + slack, clipped);
      for (std::size_t i = 0; i < clipped.count; ++i)
        if (clipped.candidates[i].separation < lowest.separation) lowest = clipped.candidates[i];
    }
  }
  const Vec<3> half = (lowest.separation > 1.0e29f ? 0.0f : 0.5f * lowest.separation) * normal;
  nearest.normal = on_b ? -normal : normal;
  nearest.separation = axis.separation;
  nearest.count = 1;
  nearest.on_a[0] = on_b ? lowest.at + half : lowest.at - half;
  nearest.on_b[0] = on_b ? lowest.at - half : lowest.at + half;
  nearest.feature[0] = lowest.feature;
  nearest.of_face = true;
  nearest.on_b_face = on_b;
  nearest.face = axis.face;
  return lowest.separation - axis.separation;
}

bool nearest_of(const Solid& a, const Solid& b, float slack, float margin, Nearest& nearest) {
  Axes axes;
  if (!find_axes(a, b, AxisTolerance(), margin, axes)) return false;
  const bool has_edges = axes.edges.separation > kNoSeparation;
  if (has_edges && points_of_edges(a, b, axes.edges, nearest) <= slack) return true;
  const bool first = axes.on_b(AxisTolerance());
  const float best = has_edges ? axes.edges.separation : axes.faces[first ? 1 : 0].separation;
  for (const bool on_b : {first, !first}) {
    const FaceAxis& face = axes.faces[on_b ? 1 : 0];
    // Axes of solids apart that have points are equally good.
    if (best < 0.0f && face.separation < best - slack) continue;
    if (points_of_face(a, b, face, on_b, slack, nearest) <= slack) return true;
  }
  const Vec<3> normal = has_edges ? axes.edges.normal
                        : first   ? -b.normals[axes.faces[1].face]
                                  : a.normals[axes.faces[0].face];
  if (best > 0.0f) return nearest_apart(a, b, {normal, best}, margin, nearest);
  // Rounding alone: one point of the best axis, as near as it gets.
  if (has_edges)
    points_of_edges(a, b, axes.edges, nearest);
  else
    points_of_face(a, b, axes.faces[first ? 1 : 0], first, slack, nearest);
  return true;
}

}  // namespace cycloid::solver
