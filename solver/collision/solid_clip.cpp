#include "solver/collision/solid_clip.hpp"

#include <utility>

namespace cycloid::solver {

/// In place of a clip edge: the point is a corner of the incident face.
static constexpr std::uint32_t kCorner = 0x3ffu;
/// Marks an edge of the reference face where one of the incident face is meant.
static constexpr std::uint32_t kCut = 0x200u;

/// The feature of the one point of solids apart whose nearest features are not an axis' own.
static constexpr std::uint32_t kNearest = 0x60000000u;

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

void clip_faces(const FacePair& pair, float margin, Clipped& clipped) {
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

  clipped.count = 0;
  clipped.lowest = 1.0e30f;
  const std::uint32_t face = clip_feature(pair.on_b, pair.reference_face, 0, 0);
  for (std::size_t i = 0; i < polygon->count; ++i) {
    const ClipVertex& vertex = polygon->vertices[i];
    const float separation = dot(normal, vertex.at - origin);
    clipped.lowest = min(clipped.lowest, separation);
    if (separation > margin) continue;
    clipped.candidates[clipped.count++] = {vertex.at - (0.5f * separation) * normal, separation,
                                           face | vertex.feature};
  }
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

/// An axis from a to b, unit, and how far the solids are apart along it, m.
struct Separation {
  Vec<3> normal;
  float separation;
};

/// Takes the line between two points of a and b as the axis where that is better.
/// @return the line's direction; the axis' where the points are too near to tell.
static Vec<3> improve(const Solid& a, const Solid& b, const NearestPoints& points,
                      Separation& axis) {
  const Vec<3> direction = normalized_or(points.q - points.p, axis.normal);
  const float apart = gap(a, b, direction);
  if (apart > axis.separation) axis = {direction, apart};
  return direction;
}

/// One point between p on a and q on b; none where they are farther apart than the margin.
static Manifold<3> touch_between(const Separation& axis, const NearestPoints& points,
                                 std::uint32_t feature, const Vec<3>& a_to_b, float margin) {
  Manifold<3> manifold;
  if (length(points.q - points.p) > margin) return manifold;
  manifold.normal = axis.normal;
  add_point(0.5f * (points.p + points.q), axis.separation, feature, a_to_b, manifold);
  return manifold;
}

/// The nearest points on the borders of a face of a and a face of b.
static NearestPoints nearest_borders(const Solid& a, std::uint32_t face_a, const Solid& b,
                                     std::uint32_t face_b) {
  NearestPoints nearest = {Vec<3>::zero(), Vec<3>::zero()};
  float least = 1.0e30f;
  const std::uint32_t first_a = a.faces[face_a].edge;
  const std::uint32_t first_b = b.faces[face_b].edge;
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
        nearest = here;
      }
      j = b.edges[j].next;
    } while (j != first_b);
    i = a.edges[i].next;
  } while (i != first_a);
  return nearest;
}

/// Of solids apart: between the nearest points of the borders of the two faces, or where the gap
/// along the line between these shows that others are nearer, of the faces that look along it.
static Manifold<3> touch_borders(const FacePair& pair, const Vec<3>& a_to_b, float margin) {
  const Solid& a = pair.on_b ? pair.incident : pair.reference;
  const Solid& b = pair.on_b ? pair.reference : pair.incident;
  std::uint32_t face_a = pair.on_b ? pair.incident_face : pair.reference_face;
  std::uint32_t face_b = pair.on_b ? pair.reference_face : pair.incident_face;
  const Vec<3> normal = pair.reference.normals[pair.reference_face];
  Separation best = {pair.on_b ? -normal : normal, pair.separation};
  NearestPoints points = {Vec<3>::zero(), Vec<3>::zero()};
  float least = 1.0e30f;
  for (int round = 0; round < 3; ++round) {
    const NearestPoints here = nearest_borders(a, face_a, b, face_b);
    const float distance = length(here.q - here.p);
    if (distance >= least) break;
    least = distance;
    points = here;
    const Vec<3> direction = improve(a, b, here, best);
    if (distance <= best.separation + 1.0e-4f) break;
    face_a = opposed_face(a, -direction);
    face_b = opposed_face(b, direction);
  }
  return touch_between(best, points, kNearest, a_to_b, margin);
}

/// The corner of the other solid that is deepest below the reference face.
static Candidate deepest_corner(const FacePair& pair) {
  const Vec<3> normal = pair.reference.normals[pair.reference_face];
  std::uint32_t deepest = 0;
  float lowest = dot(normal, pair.incident.vertices[0]);
  for (std::uint32_t i = 1; i < pair.incident.vertex_count; ++i) {
    const float height = dot(normal, pair.incident.vertices[i]);
    if (height >= lowest) continue;
    lowest = height;
    deepest = i;
  }
  return {pair.incident.vertices[deepest] - (0.5f * pair.separation) * normal, pair.separation,
          clip_feature(pair.on_b, pair.reference_face, deepest, kCorner)};
}

Manifold<3> touch_faces(const FacePair& pair, const AxisTolerance& tolerance, const Vec<3>& a_to_b,
                        float margin) {
  Clipped clipped;
  clip_faces(pair, margin, clipped);
  if (clipped.lowest > pair.separation + tolerance.edge) {
    if (pair.separation > 0.0f) return touch_borders(pair, a_to_b, margin);
    clipped.candidates[clipped.count++] = deepest_corner(pair);
  }
  Manifold<3> manifold;
  const Vec<3> normal = pair.reference.normals[pair.reference_face];
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
  Separation axis = {pair.normal, pair.separation};
  if (pair.separation <= 0.0f)
    margin = 1.0e30f;  // Of overlapping ones the ends may be far apart.
  else
    improve(a, b, points, axis);
  return touch_between(axis, points, edge_feature(pair.edge_a, pair.edge_b), a_to_b, margin);
}

}  // namespace cycloid::solver
