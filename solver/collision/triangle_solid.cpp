#include "solver/collision/rod.hpp"
#include "solver/collision/triangle.hpp"
#include "solver/collision/triangle_contact.hpp"

namespace cycloid::solver {

/// How much farther apart than the best so far an axis has to be to take its place, m, so that
/// what rests does not change its axis from tick to tick.
static float preference(const Solid& solid) {
  return 1.0e-4f * length(solid.vertices[0] - solid.centre);
}

static std::uint32_t lowest_corner(const Solid& solid, const Vec<3>& normal) {
  std::uint32_t lowest = 0;
  float least = dot(normal, solid.vertices[0]);
  for (std::uint32_t i = 1; i < solid.vertex_count; ++i) {
    const float height = dot(normal, solid.vertices[i]);
    if (height >= least) continue;
    least = height;
    lowest = i;
  }
  return lowest;
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
                       float separation, bool strict, Contacting& best) {
  const float along = dot(normal, triangle.normals[0]);
  if (along > kLiesFlat && !strict) {
    best.upright = max(best.upright, separation);
    return false;
  }
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
static bool survey_faces(const Solid& triangle, const Solid& solid, const Judgement& judgement,
                         float margin, Contacting& best) {
  const float preferred = judgement.strict ? 0.0f : judgement.preferred;
  for (std::uint32_t f = 0; f < solid.face_count; ++f) {
    const Vec<3> on_face = solid.vertices[solid.edges[solid.faces[f].edge].origin];
    const Vec<3> normal = -solid.normals[f];
    const std::uint32_t corner = farthest_corner(triangle, normal);
    const float separation = dot(normal, on_face - triangle.vertices[corner]);
    if (separation > margin) return false;
    if (separation <= best.separation + preferred) continue;
    if (!takes_over(triangle, edges_at(corner), normal, separation, judgement.strict, best))
      continue;
    best.kind = Contacting::kSolidFace;
    best.normal = normal;
    best.separation = separation;
    best.face = f;
    best.lowest = corner;
  }
  return true;
}

/// Pairs of edges that are a face of the Minkowski difference: both faces of the solid's edge lie
/// behind the axis, and so does the triangle. False where a pair separates by more than the margin.
/// Source: Gregorius, "The Separating Axis Test between Convex Polyhedra" (GDC 2013); of a triangle
/// the arc of an edge's normals is half a circle.
static bool survey_edges(const Solid& triangle, const Solid& solid, const Judgement& judgement,
                         float margin, Contacting& best) {
  const Vec<3> own = triangle.normals[0];
  const float preferred = judgement.strict ? 0.0f : judgement.preferred;
  Vec<3> sides[3];
  std::array<float, kHullFacesMax> turns[3];
  for (std::uint32_t i = 0; i < 3; ++i) {
    sides[i] = triangle.vertices[next_corner(i)] - triangle.vertices[i];
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
      if (!takes_over(triangle, 1u << i, normal, separation, judgement.strict, best)) continue;
      best.kind = Contacting::kEdges;
      best.normal = normal;
      best.separation = separation;
      best.triangle_edge = i;
      best.solid_edge = e;
    }
  }
  return true;
}

/// Whether the triangle's own normal would push a solid far out over an edge that it only grazes
/// from beside: a box against a step does not jump onto it. Where the surface is fine and round,
/// both ways are about as long, and the own normal is right.
static bool is_another_s(const Contacting& best, float preferred) {
  if (best.kind != Contacting::kOwnFace || best.refused <= best.separation + preferred)
    return false;
  return best.refused <= 0.0f && -best.separation > -4.0f * best.refused + preferred;
}

/// The best axis from a start at the triangle's own normal. False: apart by more than the margin.
static bool survey(const Solid& triangle, const Solid& solid, const Judgement& judgement,
                   float margin, Contacting& best) {
  const Contacting own = best;
  if (!survey_faces(triangle, solid, judgement, margin, best)) return false;
  if (!survey_edges(triangle, solid, judgement, margin, best)) return false;
  // A pair of edges that is not the best of all axes need not meet at all.
  const float better = max(best.elsewhere(), best.upright);
  if (best.kind != Contacting::kEdges || better <= best.separation) return true;
  best.kind = own.kind;
  best.normal = own.normal;
  best.separation = own.separation;
  best.lowest = own.lowest;
  return true;
}

/// A solid is met from the free side, by a rule without memory: its centre must not lie behind the
/// triangle's plane, so what is pushed out is sunk by less than half of its extent.
Manifold<3> triangle_against_solid(const Solid& triangle, const Solid& solid, float margin) {
  Contacting own;
  own.normal = triangle.normals[0];
  if (dot(own.normal, solid.centre - triangle.vertices[0]) < 0.0f) return {};
  own.lowest = lowest_corner(solid, own.normal);
  own.separation = dot(own.normal, solid.vertices[own.lowest] - triangle.vertices[0]);
  if (own.separation > margin) return {};

  Judgement judgement = {false, preference(solid)};
  Contacting best = own;
  if (!survey(triangle, solid, judgement, margin, best)) return {};
  if (is_another_s(best, judgement.preferred)) return {};
  const TriangleContact first = triangle_contact(triangle, solid, best, judgement, margin);
  if (first.complete) return first.manifold;

  // An axis that is almost the best, and was taken since it changes less from tick to tick, need
  // not be one along which anything meets.
  judgement.strict = true;
  best = own;
  if (!survey(triangle, solid, judgement, margin, best)) return {};
  const TriangleContact again = triangle_contact(triangle, solid, best, judgement, margin);
  return again.manifold.point_count > 0 ? again.manifold : first.manifold;
}

}  // namespace cycloid::solver
