#include "solver/collision/rod.hpp"
#include "solver/collision/triangle.hpp"
#include "solver/collision/triangle_clip.hpp"

namespace cycloid::solver {

/// Which features meet: the triangle's face, a face of the solid, or an edge of each.
struct Contacting {
  enum Kind { kOwnFace, kSolidFace, kEdges } kind = kOwnFace;
  Vec<3> normal;  ///< From the triangle to the solid.
  float separation = 0.0f;
  std::uint32_t face = 0;
  std::uint32_t triangle_edge = 0;
  std::uint32_t solid_edge = 0;
  float own_separation = 0.0f;  ///< Along the triangle's normal, m.
  float refused = -3.0e38f;     ///< Along the best axis that is a neighbour's, m.
  float flat = -3.0e38f;        ///< Along the best axis over an edge that is not convex, m.
};

/// How much farther apart than the best so far an axis has to be to take its place, m, so that
/// what rests does not change its axis from tick to tick.
static float preference(const Solid& solid) {
  return 1.0e-4f * length(solid.vertices[0] - solid.centre);
}

static std::uint32_t farthest_corner(const Solid& triangle, const Vec<3>& direction) {
  std::uint32_t best = 0;
  for (std::uint32_t i = 1; i < 3; ++i)
    if (dot(direction, triangle.vertices[i] - triangle.vertices[best]) > 0.0f) best = i;
  return best;
}

/// Whether an axis may take the place of the best one. Where it is better, but beyond a convex
/// neighbour's normal or behind the triangle, notes that: others have to make the contact.
static bool takes_over(const Solid& triangle, std::uint32_t edges, const Vec<3>& normal,
                       float separation, Contacting& best) {
  const float along = dot(normal, triangle.normals[0]);
  if (along > kLiesFlat) return false;
  const Leaning leaning = leaning_of(triangle, edges, normal);
  if (leaning == Leaning::kOwnOnly) {
    best.flat = max(best.flat, separation);
    return false;
  }
  if (leaning == Leaning::kAllowed && along >= -kFlat) return true;
  best.refused = max(best.refused, separation);
  return false;
}

/// False where a face of the solid separates by more than the margin.
static bool survey_faces(const Solid& triangle, const Solid& solid, float margin,
                         Contacting& best) {
  const float preferred = preference(solid);
  for (std::uint32_t f = 0; f < solid.face_count; ++f) {
    const Vec<3> on_face = solid.vertices[solid.edges[solid.faces[f].edge].origin];
    const Vec<3> normal = -solid.normals[f];
    const std::uint32_t corner = farthest_corner(triangle, normal);
    const float separation = dot(normal, on_face - triangle.vertices[corner]);
    if (separation > margin) return false;
    if (separation <= best.separation + preferred) continue;
    if (!takes_over(triangle, edges_at(corner), normal, separation, best)) continue;
    best.kind = Contacting::kSolidFace;
    best.normal = normal;
    best.separation = separation;
    best.face = f;
  }
  return true;
}

/// Pairs of edges that are a face of the Minkowski difference: both faces of the solid's edge lie
/// behind the axis, and so does the triangle. False where a pair separates by more than the margin.
/// Source: Gregorius, "The Separating Axis Test between Convex Polyhedra" (GDC 2013); of a triangle
/// the arc of an edge's normals is half a circle.
static bool survey_edges(const Solid& triangle, const Solid& solid, float margin,
                         Contacting& best) {
  const Vec<3> own = triangle.normals[0];
  const float preferred = preference(solid);
  Vec<3> sides[3];
  std::array<float, kHullFacesMax> turns[3];
  for (std::uint32_t i = 0; i < 3; ++i) {
    sides[i] = triangle.vertices[i == 2 ? 0 : i + 1] - triangle.vertices[i];
    for (std::uint32_t f = 0; f < solid.face_count; ++f)
      turns[i][f] = dot(solid.normals[f], sides[i]);
  }
  for (std::uint32_t e = 0; e < solid.edge_count; e += 2) {
    const PolyhedronEdge& half = solid.edges[e];
    const PolyhedronEdge& twin = solid.edges[e + 1];
    const Vec<3> origin = solid.vertices[half.origin];
    const Vec<3> along = solid.vertices[twin.origin] - origin;
    const float rise = dot(along, own);
    for (std::uint32_t i = 0; i < 3; ++i) {
      const float turn = turns[i][half.face];
      if (turn * turns[i][twin.face] >= 0.0f || turn * rise <= 0.0f) continue;
      const Vec<3> axis = turn > 0.0f ? cross(sides[i], along) : cross(along, sides[i]);
      const float square = dot(axis, axis);
      // Nearly parallel edges: the faces stand in for them.
      if (square < 1.0e-5f * dot(along, along) * dot(sides[i], sides[i])) continue;
      const float scale = 1.0f / sqrt(square);
      const float separation = scale * dot(axis, origin - triangle.vertices[i]);
      if (separation > margin) return false;
      if (separation <= best.separation + preferred) continue;
      const Vec<3> normal = scale * axis;
      if (!takes_over(triangle, 1u << i, normal, separation, best)) continue;
      best.kind = Contacting::kEdges;
      best.normal = normal;
      best.separation = separation;
      best.triangle_edge = i;
      best.solid_edge = e;
    }
  }
  return true;
}

/// The corners of a clipped polygon as points against a face that looks along `normal`. The
/// polygon is of the other shape.
static void add_polygon(const Polygon& polygon, const Vec<3>& normal, const Vec<3>& on_face,
                        std::uint32_t face, bool on_b, const Vec<3>& a_to_b, float margin,
                        Manifold<3>& manifold) {
  std::array<Candidate, Polygon::kCornersMax> found;
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < polygon.count; ++i) {
    const float height = dot(normal, polygon.corners[i] - on_face);
    if (height > margin) continue;
    const std::uint32_t before = polygon.labels[i == 0 ? polygon.count - 1 : i - 1];
    found[count++] = {polygon.corners[i] - (0.5f * height) * normal, height,
                      clip_feature(on_b, face, before, polygon.labels[i])};
  }
  reduce(std::span<const Candidate>(found).first(count), a_to_b, manifold);
}

/// The face that looks most against `normal`; of equal ones the first.
static std::uint32_t opposed_face(const Solid& solid, const Vec<3>& normal) {
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

static void add_contact(const Solid& triangle, const Solid& solid, const Contacting& best,
                        const Vec<3>& a_to_b, float margin, Manifold<3>& manifold) {
  manifold.normal = best.normal;
  const float slack = 1.0e-5f * length(solid.vertices[0] - solid.centre);
  Polygon polygon;
  if (best.kind == Contacting::kOwnFace) {
    const std::uint32_t face = opposed_face(solid, best.normal);
    face_polygon(solid, face, polygon);
    clip_polygon(triangle, 0, slack, polygon);
    add_polygon(polygon, best.normal, triangle.vertices[0], face, false, a_to_b, margin, manifold);
  } else if (best.kind == Contacting::kSolidFace) {
    face_polygon(triangle, 0, polygon);
    clip_polygon(solid, best.face, slack, polygon);
    const Vec<3> on_face = solid.vertices[solid.edges[solid.faces[best.face].edge].origin];
    add_polygon(polygon, solid.normals[best.face], on_face, best.face, true, a_to_b, margin,
                manifold);
  } else {
    const PolyhedronEdge& half = solid.edges[best.solid_edge];
    const std::uint32_t next = best.triangle_edge == 2 ? 0 : best.triangle_edge + 1;
    const Vec<3> from = solid.vertices[half.origin];
    const Vec<3> to = solid.vertices[solid.edges[half.twin].origin];
    const SegmentPair pair =
        nearest_points(triangle.vertices[best.triangle_edge], triangle.vertices[next], from, to);
    add_point(0.5f * (pair.on_a + pair.on_b), best.separation,
              edge_feature(best.solid_edge) | (best.triangle_edge << 20), a_to_b, manifold);
  }
}

/// Whether the triangle's own normal would push a solid far out over an edge that it only grazes
/// from beside: a box against a step does not jump onto it. Where the surface is fine and round,
/// both ways are about as long, and the own normal is right.
static bool is_another_s(const Contacting& best, float preferred) {
  if (best.kind != Contacting::kOwnFace || best.refused <= best.separation + preferred)
    return false;
  return -best.separation > 4.0f * max(-best.refused, 0.0f) + preferred;
}

/// A solid is met from the free side, by a rule without memory: its centre must not lie behind the
/// triangle's plane, so what is pushed out is sunk by less than half of its extent.
Manifold<3> triangle_against_solid(const Solid& triangle, const Solid& solid, const Vec<3>& a_to_b,
                                   float margin) {
  Contacting best;
  best.normal = triangle.normals[0];
  if (dot(best.normal, solid.centre - triangle.vertices[0]) < 0.0f) return {};
  best.separation = 3.0e38f;
  for (std::uint32_t i = 0; i < solid.vertex_count; ++i)
    best.separation =
        min(best.separation, dot(best.normal, solid.vertices[i] - triangle.vertices[0]));
  if (best.separation > margin) return {};
  best.own_separation = best.separation;
  if (!survey_faces(triangle, solid, margin, best)) return {};
  if (!survey_edges(triangle, solid, margin, best)) return {};
  // A pair of edges that is not the best of all axes need not meet at all.
  if (best.kind == Contacting::kEdges && max(best.refused, best.flat) > best.separation) {
    best.kind = Contacting::kOwnFace;
    best.normal = triangle.normals[0];
    best.separation = best.own_separation;
  }
  if (is_another_s(best, preference(solid))) return {};
  Manifold<3> manifold;
  add_contact(triangle, solid, best, a_to_b, margin, manifold);
  return manifold;
}

}  // namespace cycloid::solver
