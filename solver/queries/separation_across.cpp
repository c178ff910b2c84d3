#include "solver/queries/solid_queries.hpp"

namespace cycloid::solver {

/// A direction along which two cores are this far apart, and the points of them that tell it.
struct DepthAxis {
  bool found = false;
  float separation = -3.0e38f;
  Vec<3> normal = Vec<3>::zero();  ///< Unit, from a to b.
  Vec<3> on_b = Vec<3>::zero();    ///< Lowest point of b's core along it.
};

static void offer(DepthAxis& best, float separation, const Vec<3>& normal, const Vec<3>& on_b) {
  if (separation > best.separation) best = {true, separation, normal, on_b};
}

/// The faces of `faces` against the corners of `points`. `flipped`: the faces are those of b.
static void offer_faces(const Core<3>& faces, const Core<3>& points, bool flipped,
                        DepthAxis& best) {
  const std::uint32_t count = faces.one_sided() ? 1 : faces.face_count;
  for (std::uint32_t f = 0; f < count; ++f) {
    const Vec<3> normal = faces.face_normal(f);
    const Vec<3>& origin = faces.face_corner(f);
    std::uint32_t lowest = 0;
    float height = dot(normal, points.vertices[0] - origin);
    for (std::uint32_t j = 1; j < points.count; ++j) {
      const float other = dot(normal, points.vertices[j] - origin);
      if (other >= height) continue;
      height = other;
      lowest = j;
    }
    if (height <= best.separation) continue;
    const Vec<3>& corner = points.vertices[lowest];
    if (flipped)
      offer(best, height, -normal, corner - height * normal);
    else
      offer(best, height, normal, corner);
  }
}

/// An edge with the normals of the faces to its left and right.
struct DepthEdge {
  Vec<3> from;
  Vec<3> span;
  Vec<3> left;
  Vec<3> right;
};

static DepthEdge edge_of(const Core<3>& core, std::uint32_t half_edge) {
  const PolyhedronEdge& edge = core.edges[half_edge];
  const PolyhedronEdge& twin = core.edges[edge.twin];
  const Vec<3> from = core.vertices[edge.origin];
  return {from, core.vertices[twin.origin] - from, core.face_normal(edge.face),
          core.face_normal(twin.face)};
}

/// Below this sine edges count as parallel: the faces beside them tell the axis as well.
static constexpr float kParallel = 1.0e-3f;

/// Where the lines of two edges are nearest; `normal` is their common perpendicular.
static void offer_edges(const DepthEdge& a, const DepthEdge& b, const Vec<3>& perpendicular,
                        DepthAxis& best) {
  const float square = dot(perpendicular, perpendicular);
  if (square <= kParallel * kParallel * dot(a.span, a.span) * dot(b.span, b.span)) return;
  const Vec<3> normal = (1.0f / sqrt(square)) * perpendicular;
  const Vec<3> between = b.from - a.from;
  const float separation = dot(normal, between);
  if (separation <= best.separation) return;
  const float along =
      clamp(dot(cross(between, a.span), cross(a.span, b.span)) / square, 0.0f, 1.0f);
  offer(best, separation, normal, b.from + along * b.span);
}

/// Whether the arcs of both edges cross on the Gauss map, b's turned round.
static bool arcs_cross(const DepthEdge& a, const DepthEdge& b) {
  const float left_b = -dot(b.left, a.span);
  const float right_b = -dot(b.right, a.span);
  if (left_b * right_b >= 0.0f) return false;
  const float left_a = dot(a.left, b.span);
  const float right_a = dot(a.right, b.span);
  return left_a * right_a < 0.0f && left_b * right_a > 0.0f;
}

static void offer_edge_pairs(const Core<3>& a, const Core<3>& b, DepthAxis& best) {
  std::array<DepthEdge, kHullEdgesMax / 2> edges_b;
  std::uint32_t count_b = 0;
  for (std::uint32_t e = 0; e < b.edge_count; e += 2) edges_b[count_b++] = edge_of(b, e);
  for (std::uint32_t e = 0; e < a.edge_count; e += 2) {
    const DepthEdge edge_a = edge_of(a, e);
    for (std::uint32_t i = 0; i < count_b; ++i) {
      if (!arcs_cross(edge_a, edges_b[i])) continue;
      const Vec<3> across = cross(edge_a.span, edges_b[i].span);
      const bool outwards = dot(across, edge_a.left + edge_a.right) > 0.0f;
      offer_edges(edge_a, edges_b[i], outwards ? across : -across, best);
    }
  }
}

/// The edges of a solid against a line. `flipped`: the solid is b.
static void offer_line(const Core<3>& solid, const Core<3>& line, bool flipped, DepthAxis& best) {
  const Vec<3> span = line.vertices[1] - line.vertices[0];
  const DepthEdge along{line.vertices[0], span, span, span};
  for (std::uint32_t e = 0; e < solid.edge_count; e += 2) {
    const DepthEdge edge = edge_of(solid, e);
    if (!(dot(edge.left, span) * dot(edge.right, span) < 0.0f)) continue;
    const Vec<3> across = cross(edge.span, span);
    const bool outwards = dot(across, edge.left + edge.right) > 0.0f;
    const Vec<3> out = outwards ? across : -across;
    if (flipped)
      offer_edges(along, edge, -out, best);
    else
      offer_edges(edge, along, out, best);
  }
}

/// Cores without a face: across both if they are lines, or one of them, and as far up as possible.
static Vec<3> way_apart(const Core<3>& a, const Core<3>& b) {
  Vec<3> up = Vec<3>::zero();
  up[1] = 1.0f;  // Concentric balls part upwards, as in `collide`.
  if (a.count > 2 || b.count > 2) return up;
  const Vec<3> none = Vec<3>::zero();
  const Vec<3> line_a = a.count > 1 ? normalized_or(a.vertices[1] - a.vertices[0], none) : none;
  const Vec<3> line_b = b.count > 1 ? normalized_or(b.vertices[1] - b.vertices[0], none) : none;
  const Vec<3> across = cross(line_a, line_b);
  if (dot(across, across) > kParallel * kParallel) {
    const Vec<3> normal = normalized_or(across, up);
    return normal[1] < 0.0f ? -normal : normal;
  }
  const Vec<3> line = a.count > 1 ? line_a : line_b;
  const Vec<3> upwards = up - line[1] * line;
  if (dot(upwards, upwards) > kParallel * kParallel) return normalized_or(upwards, up);
  return {{1.0f, 0.0f, 0.0f}};
}

static void offer_way_apart(const Core<3>& a, const Core<3>& b, DepthAxis& best) {
  const Vec<3> normal = way_apart(a, b);
  float highest = dot(normal, a.vertices[0]);
  for (std::uint32_t i = 1; i < a.count; ++i) highest = max(highest, dot(normal, a.vertices[i]));
  std::uint32_t lowest = 0;
  for (std::uint32_t j = 1; j < b.count; ++j)
    if (dot(normal, b.vertices[j]) < dot(normal, b.vertices[lowest])) lowest = j;
  offer(best, dot(normal, b.vertices[lowest]) - highest, normal, b.vertices[lowest]);
}

Separation<3> separation_across(const Core<3>& a, const Core<3>& b) {
  DepthAxis axis;
  const bool surface = a.one_sided() || b.one_sided();
  if (a.one_sided() || !b.one_sided()) offer_faces(a, b, false, axis);
  if (!a.one_sided()) offer_faces(b, a, true, axis);
  if (!surface && a.count > 2 && b.count > 2) offer_edge_pairs(a, b, axis);
  if (!surface && b.count == 2) offer_line(a, b, false, axis);
  if (!surface && a.count == 2) offer_line(b, a, true, axis);
  if (!axis.found) offer_way_apart(a, b, axis);
  Separation<3> result{};
  result.by_axis = true;
  result.distance = axis.separation - (a.radius + b.radius);
  result.normal = axis.normal;
  result.point_a = axis.on_b + (a.radius - axis.separation) * axis.normal;
  result.point_b = axis.on_b - b.radius * axis.normal;
  return result;
}

Separation<3> separation_of_cores(const Core<3>& a, const Core<3>& b) {
  const NearestPoints nearest = nearest_points(a, b);
  if (nearest.enclosed || nearest.touching) {
    Separation<3> result = separation_across(a, b);
    result.crossing = nearest.enclosed && result.distance + a.radius + b.radius <= 0.0f;
    return result;
  }
  Separation<3> result{};
  result.normal = nearest.normal;
  result.distance = nearest.distance - (a.radius + b.radius);
  result.point_a = nearest.on_a + a.radius * result.normal;
  result.point_b = nearest.on_b - b.radius * result.normal;
  return result;
}

}  // namespace cycloid::solver
