#include "solver/collision/solid_clip.hpp"

#include <utility>

namespace cycloid::solver {

/// A convex face of n corners cut by m planes has at most n + m.
static constexpr std::size_t kClipMax = 2 * kHullVerticesMax;
/// In place of a clip edge: the point is a corner of the incident face.
static constexpr std::uint32_t kCorner = 0x3ffu;
/// Marks an edge of the reference face where one of the incident face is meant.
static constexpr std::uint32_t kCut = 0x200u;

struct ClipVertex {
  Vec<3> at;
  std::uint32_t feature;  ///< Lower 20 bits of a clip_feature.
  std::uint32_t
      edge;  ///< What leads to the next vertex: an incident edge, or kCut and a clip edge.
};

struct Polygon {
  ClipVertex vertices[kClipMax];
  std::size_t count;

  void add(const ClipVertex& vertex) {
    if (count < kClipMax) vertices[count++] = vertex;
  }
};

struct ClipPlane {
  Vec<3> normal;  ///< Outwards, as long as the edge.
  Vec<3> origin;
  float slop;  ///< m, times the length of the normal.
  std::uint32_t edge;
};

static std::uint32_t end_of(const Solid& solid, std::uint32_t edge) {
  return solid.edges[solid.edges[edge].twin].origin;
}

static ClipVertex crossing(const ClipVertex& from, const ClipVertex& to, float fraction,
                           std::uint32_t clip_edge, std::uint32_t onward) {
  return {from.at + fraction * (to.at - from.at), clip_feature(false, 0, from.edge, clip_edge),
          onward};
}

/// @return whether anything was cut; otherwise `out` is untouched and `in` stands.
static bool cut(const Polygon& in, const ClipPlane& plane, Polygon& out) {
  float height[kClipMax];
  bool sticks_out = false;
  for (std::size_t i = 0; i < in.count; ++i) {
    height[i] = dot(plane.normal, in.vertices[i].at - plane.origin);
    sticks_out |= height[i] > plane.slop;
  }
  if (!sticks_out) return false;
  out.count = 0;
  for (std::size_t i = 0; i < in.count; ++i) {
    const std::size_t j = i + 1 < in.count ? i + 1 : 0;
    const ClipVertex& vertex = in.vertices[i];
    const bool inside = height[i] <= plane.slop;
    const bool next_inside = height[j] <= plane.slop;
    // A vertex within the slop stands for the crossing next to it.
    const bool leaves_here = inside && !next_inside && height[i] >= 0.0f;
    if (inside) out.add(vertex);
    if (leaves_here) out.vertices[out.count - 1].edge = kCut | plane.edge;
    if (inside == next_inside || leaves_here || (next_inside && height[j] >= 0.0f)) continue;
    const float fraction = height[i] / (height[i] - height[j]);
    out.add(crossing(vertex, in.vertices[j], fraction, plane.edge,
                     inside ? kCut | plane.edge : vertex.edge));
  }
  return true;
}

static void start(const Solid& solid, std::uint32_t face, Polygon& polygon) {
  polygon.count = 0;
  const std::uint32_t first = solid.faces[face].edge;
  std::uint32_t edge = first;
  do {
    const std::uint32_t corner = solid.edges[edge].origin;
    polygon.add({solid.vertices[corner], clip_feature(false, 0, corner, kCorner), edge >> 1});
    edge = solid.edges[edge].next;
  } while (edge != first);
}

std::uint32_t opposed_face(const Solid& solid, const Vec<3>& normal) {
  std::uint32_t best = 0;
  float threshold = 2.0f;
  for (std::uint32_t i = 0; i < solid.face_count; ++i) {
    const float along = dot(solid.normals[i], normal);
    if (along >= threshold) continue;
    best = i;
    threshold = along - 1.0e-3f;
  }
  return best;
}

FacePair opposed_to(const Solid& a, const Solid& b, std::uint32_t face, bool on_b,
                    float separation) {
  const Solid& reference = on_b ? b : a;
  const Solid& incident = on_b ? a : b;
  return {reference, incident,  face, opposed_face(incident, reference.normals[face]),
          on_b,      separation};
}

float clip_faces(const FacePair& pair, const Vec<3>& a_to_b, float margin, Manifold<3>& manifold) {
  const Solid& reference = pair.reference;
  const Vec<3> normal = reference.normals[pair.reference_face];
  Polygon buffers[2];
  Polygon* polygon = &buffers[0];
  Polygon* spare = &buffers[1];
  start(pair.incident, pair.incident_face, *polygon);
  const std::uint32_t first = reference.faces[pair.reference_face].edge;
  std::uint32_t edge = first;
  const Vec<3> origin = reference.vertices[reference.edges[first].origin];
  Vec<3> from = origin;
  do {
    const std::uint32_t next = reference.edges[edge].next;
    const Vec<3> to = reference.vertices[reference.edges[next].origin];
    const Vec<3> along = to - from;
    const float run = length(along);
    const ClipPlane plane = {cross(along, normal), from, run * min(5.0e-4f, 1.0e-2f * run),
                             edge >> 1};
    if (cut(*polygon, plane, *spare)) std::swap(polygon, spare);
    from = to;
    edge = next;
  } while (edge != first);

  std::array<Candidate, kClipMax> found;
  std::size_t count = 0;
  float lowest = 1.0e30f;
  const std::uint32_t face = clip_feature(pair.on_b, pair.reference_face, 0, 0);
  for (std::size_t i = 0; i < polygon->count; ++i) {
    const ClipVertex& vertex = polygon->vertices[i];
    const float separation = dot(normal, vertex.at - origin);
    lowest = min(lowest, separation);
    if (separation > margin) continue;
    found[count++] = {vertex.at - (0.5f * separation) * normal, separation, face | vertex.feature};
  }
  manifold.normal = pair.on_b ? -normal : normal;
  reduce(std::span(found).first(count), a_to_b, manifold);
  return lowest;
}

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

/// How far b is from a along `normal`, m: never more than their distance.
static float gap(const Solid& a, const Solid& b, const Vec<3>& normal) {
  float highest = dot(normal, a.vertices[0]);
  for (std::uint32_t i = 1; i < a.vertex_count; ++i)
    highest = max(highest, dot(normal, a.vertices[i]));
  float lowest = dot(normal, b.vertices[0]);
  for (std::uint32_t i = 1; i < b.vertex_count; ++i)
    lowest = min(lowest, dot(normal, b.vertices[i]));
  return lowest - highest;
}

/// One point between p on a and q on b, with the axis on which the solids are farthest apart: the
/// line between them, or the one already known. No point where they are farther than the margin.
static Manifold<3> touch_between(const EdgePair& known, const NearestPoints& points,
                                 const Vec<3>& a_to_b, float margin) {
  const Vec<3> between = points.q - points.p;
  const float distance = length(between);
  if (distance > margin) return {};
  Manifold<3> manifold;
  manifold.normal = known.normal;
  float separation = known.separation;
  if (distance > 1.0e-6f) {
    const Vec<3> direction = (1.0f / distance) * between;
    const float apart = gap(known.a, known.b, direction);
    if (apart > separation) {
      manifold.normal = direction;
      separation = apart;
    }
  }
  add_point(points.p + 0.5f * between, separation, edge_feature(known.edge_a, known.edge_b), a_to_b,
            manifold);
  return manifold;
}

/// Between the nearest edges of the two faces.
static Manifold<3> touch_borders(const FacePair& pair, const Vec<3>& a_to_b, float margin) {
  const Solid& a = pair.on_b ? pair.incident : pair.reference;
  const Solid& b = pair.on_b ? pair.reference : pair.incident;
  const std::uint32_t first_a = a.faces[pair.on_b ? pair.incident_face : pair.reference_face].edge;
  const std::uint32_t first_b = b.faces[pair.on_b ? pair.reference_face : pair.incident_face].edge;
  const Vec<3> normal = pair.reference.normals[pair.reference_face];
  EdgePair nearest = {a, b, first_a, first_b, pair.on_b ? -normal : normal, pair.separation};
  NearestPoints points = {Vec<3>::zero(), Vec<3>::zero()};
  float least = 1.0e30f;
  std::uint32_t i = first_a;
  do {
    const Vec<3> p0 = a.vertices[a.edges[i].origin];
    const Vec<3> p1 = a.vertices[end_of(a, i)];
    std::uint32_t j = first_b;
    do {
      const NearestPoints here =
          nearest_points(p0, p1, b.vertices[b.edges[j].origin], b.vertices[end_of(b, j)]);
      const Vec<3> between = here.q - here.p;
      const float squared = dot(between, between);
      if (squared < least) {
        least = squared;
        points = here;
        nearest.edge_a = i;
        nearest.edge_b = j;
      }
      j = b.edges[j].next;
    } while (j != first_b);
    i = a.edges[i].next;
  } while (i != first_a);
  return touch_between(nearest, points, a_to_b, margin);
}

/// The corner of the other solid that is deepest below the reference face.
static Manifold<3> touch_corner(const FacePair& pair, const Vec<3>& a_to_b) {
  const Vec<3> normal = pair.reference.normals[pair.reference_face];
  std::uint32_t deepest = 0;
  float lowest = 1.0e30f;
  for (std::uint32_t i = 0; i < pair.incident.vertex_count; ++i) {
    const float height = dot(normal, pair.incident.vertices[i]);
    if (height >= lowest) continue;
    lowest = height;
    deepest = i;
  }
  Manifold<3> manifold;
  manifold.normal = pair.on_b ? -normal : normal;
  add_point(pair.incident.vertices[deepest] - (0.5f * pair.separation) * normal, pair.separation,
            clip_feature(pair.on_b, pair.reference_face, deepest, kCorner), a_to_b, manifold);
  return manifold;
}

Manifold<3> touch_faces(const FacePair& pair, const AxisTolerance& tolerance, const Vec<3>& a_to_b,
                        float margin) {
  Manifold<3> manifold;
  const float lowest = clip_faces(pair, a_to_b, margin, manifold);
  if (pair.separation <= 0.0f)
    return manifold.point_count > 0 ? manifold : touch_corner(pair, a_to_b);
  if (lowest <= tolerance.edge + pair.separation) return manifold;
  return touch_borders(pair, a_to_b, margin);
}

Manifold<3> touch_edges(const EdgePair& pair, const Vec<3>& a_to_b, float margin) {
  const Solid& a = pair.a;
  const Solid& b = pair.b;
  const NearestPoints points =
      nearest_points(a.vertices[a.edges[pair.edge_a].origin], a.vertices[end_of(a, pair.edge_a)],
                     b.vertices[b.edges[pair.edge_b].origin], b.vertices[end_of(b, pair.edge_b)]);
  if (pair.separation > 0.0f) return touch_between(pair, points, a_to_b, margin);
  Manifold<3> manifold;
  manifold.normal = pair.normal;
  add_point(0.5f * (points.p + points.q), pair.separation, edge_feature(pair.edge_a, pair.edge_b),
            a_to_b, manifold);
  return manifold;
}

}  // namespace cycloid::solver
