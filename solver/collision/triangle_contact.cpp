#include "solver/collision/triangle_contact.hpp"

#include "solver/collision/segments.hpp"
#include "solver/collision/triangle.hpp"
#include "solver/collision/triangle_clip.hpp"

namespace cycloid::solver {

static constexpr std::uint32_t kEdges = 0x10000000u;  ///< A feature of two edges.

/// Points against a face that looks along `normal`, and the lowest height of any, m.
struct SolidHeights {
  const Vec<3>& normal;
  const Vec<3>& on_face;
  std::uint32_t face;
  bool on_b;
  float margin;
  std::array<Candidate, Polygon::kCornersMax + 1> found;
  std::size_t count = 0;
  float lowest = 3.0e38f;

  void add(const Vec<3>& at, std::uint32_t before, std::uint32_t after) {
    const float height = dot(normal, at - on_face);
    lowest = min(lowest, height);
    if (height > margin) return;
    found[count++] = {at - (0.5f * height) * normal, height,
                      clip_feature(on_b, face, before, after)};
  }
  void add(const Polygon& polygon) {
    for (std::uint32_t i = 0; i < polygon.count; ++i)
      add(polygon.corners[i], polygon.labels[i == 0 ? polygon.count - 1 : i - 1],
          polygon.labels[i]);
  }
};

/// The face that looks most against `normal`; of equal ones the first.
static std::uint32_t most_opposed_face(const Solid& solid, const Vec<3>& normal) {
  std::uint32_t best = 0;
  float least = dot(solid.normals[0], normal);
  for (std::uint32_t f = 1; f < solid.face_count; ++f) {
    const float along = dot(solid.normals[f], normal);
    if (along < least) {
      least = along;
      best = f;
    }
  }
  return best;
}

/// Whether a point is within the side planes of a face, each moved outwards by `slack` [m].
static bool is_over(const Solid& solid, std::uint32_t face, const Vec<3>& point, float slack) {
  const std::uint32_t first = solid.faces[face].edge;
  std::uint32_t edge = first;
  do {
    const PolyhedronEdge& half = solid.edges[edge];
    const Vec<3> origin = solid.vertices[half.origin];
    const Vec<3> along = solid.vertices[solid.edges[half.next].origin] - origin;
    const Vec<3> side = cross(along, solid.normals[face]);
    if (dot(side, point - origin) > slack * length(side)) return false;
    edge = half.next;
  } while (edge != first);
  return true;
}

/// The nearest points of any two edges of the triangle and the solid that are no farther apart than
/// the margin, and the triangle's edge.
struct NearestEdges {
  SegmentPair pair;
  std::uint32_t edge = 0;
};
static NearestEdges nearest_edges(const Solid& triangle, const Solid& solid, float margin) {
  NearestEdges nearest;
  nearest.pair.distance = 3.0e38f;
  for (std::uint32_t e = 0; e < solid.edge_count; e += 2) {
    const Vec<3> from = solid.vertices[solid.edges[e].origin];
    const Vec<3> to = solid.vertices[solid.edges[e + 1].origin];
    const float height = min(dot(triangle.normals[0], from - triangle.vertices[0]),
                             dot(triangle.normals[0], to - triangle.vertices[0]));
    if (height > margin) continue;
    for (std::uint32_t i = 0; i < 3; ++i) {
      const SegmentPair pair =
          nearest_points(triangle.vertices[i], triangle.vertices[next_corner(i)], from, to);
      if (pair.distance < nearest.pair.distance) nearest = {pair, i};
    }
  }
  return nearest;
}

/// How far the solid is from the triangle along a direction, m.
static float gap_along(const Solid& triangle, const Solid& solid, const Vec<3>& direction) {
  const Vec<3> origin = triangle.vertices[0];
  float low = dot(direction, solid.vertices[0] - origin);
  for (std::uint32_t i = 1; i < solid.vertex_count; ++i)
    low = min(low, dot(direction, solid.vertices[i] - origin));
  return low - max(0.0f, max(dot(direction, triangle.vertices[1] - origin),
                             dot(direction, triangle.vertices[2] - origin)));
}

/// Of solids apart: one point, on the axis along which they are farther apart, the best one or the
/// line between the nearest points.
static TriangleContact touch_nearest(const Solid& triangle, const Solid& solid,
                                     const NearestEdges& nearest, const Contacting& best,
                                     float preferred, float margin) {
  const SegmentPair& pair = nearest.pair;
  if (pair.distance > margin) return {{}, true};
  std::uint32_t edges = 1u << nearest.edge;
  if (pair.fraction_a == 0.0f) edges = edges_at(nearest.edge);
  if (pair.fraction_a == 1.0f) edges = edges_at(next_corner(nearest.edge));
  const Vec<3> between = pair.on_b - pair.on_a;
  const Vec<3> line = normalized_or(between, best.normal);
  if (dot(line, triangle.normals[0]) < -kFlat) return {{}, true};
  if (leaning_of(triangle, edges, line) != Leaning::kAllowed) return {{}, true};
  const float gap = gap_along(triangle, solid, line);
  if (max(gap, best.separation) < 0.0f) return {{}, true};
  TriangleContact contact;
  contact.manifold.normal = gap > best.separation ? line : best.normal;
  add_point(pair.on_a + 0.5f * between, max(gap, best.separation), kNearest, contact.manifold);
  contact.complete = gap >= pair.distance - preferred;
  return contact;
}

static TriangleContact touch_edges(const Solid& triangle, const Solid& solid,
                                   const Contacting& best, float preferred, float margin) {
  const Vec<3> from = solid.vertices[solid.edges[best.solid_edge].origin];
  const Vec<3> to = solid.vertices[solid.edges[best.solid_edge + 1].origin];
  const SegmentPair pair =
      nearest_points(triangle.vertices[best.triangle_edge],
                     triangle.vertices[next_corner(best.triangle_edge)], from, to);
  const bool meet = pair.distance <= abs(best.separation) + preferred;
  if (best.separation > 0.0f && !meet)
    return touch_nearest(triangle, solid, nearest_edges(triangle, solid, margin), best, preferred,
                         margin);
  TriangleContact contact;
  contact.manifold.normal = best.normal;
  add_point(0.5f * (pair.on_a + pair.on_b), best.separation,
            kEdges | best.solid_edge | (best.triangle_edge << 20), contact.manifold);
  contact.complete = meet;
  return contact;
}

static TriangleContact touch_faces(const Solid& triangle, const Solid& solid,
                                   const Contacting& best, const Judgement& judgement,
                                   float margin) {
  const float size = length(solid.vertices[0] - solid.centre);
  const float slack = judgement.strict ? 2.0f * judgement.preferred : 1.0e-5f * size;
  const bool own = best.kind == Contacting::kOwnFace;
  const Solid& reference = own ? triangle : solid;
  const Solid& other = own ? solid : triangle;
  const std::uint32_t face = own ? 0 : best.face;
  const std::uint32_t incident = own ? most_opposed_face(solid, best.normal) : 0;
  const Vec<3> on_face = reference.vertices[reference.edges[reference.faces[face].edge].origin];
  Polygon polygon;
  face_polygon(other, incident, polygon);
  clip_polygon(reference, face, slack, polygon);
  SolidHeights heights{reference.normals[face], on_face, own ? incident : face, !own, margin, {}};
  heights.add(polygon);
  bool complete = true;
  if (heights.lowest > best.separation + judgement.preferred) {
    const Vec<3> corner = other.vertices[best.lowest];
    if (is_over(reference, face, corner, slack)) {
      heights.add(corner, best.lowest, kCorner);
    } else if (max(best.separation, best.elsewhere()) > 0.0f) {
      const NearestEdges nearest = nearest_edges(triangle, solid, margin);
      if (nearest.pair.distance < heights.lowest - judgement.preferred)
        return touch_nearest(triangle, solid, nearest, best, judgement.preferred, margin);
    } else {
      complete = own && heights.count > 0;
    }
  }
  TriangleContact contact;
  contact.manifold.normal = best.normal;
  contact.complete = complete;
  reduce(std::span<const Candidate>(heights.found).first(heights.count), contact.manifold);
  return contact;
}

TriangleContact triangle_contact(const Solid& triangle, const Solid& solid, const Contacting& best,
                                 const Judgement& judgement, float margin) {
  const float preferred = judgement.preferred;
  // Apart along another axis, so they do not overlap, however deep one is behind the other's face.
  if (best.separation < 0.0f && best.elsewhere() > 0.0f)
    return touch_nearest(triangle, solid, nearest_edges(triangle, solid, margin), best, preferred,
                         margin);
  if (best.kind == Contacting::kEdges) return touch_edges(triangle, solid, best, preferred, margin);
  return touch_faces(triangle, solid, best, judgement, margin);
}

}  // namespace cycloid::solver
