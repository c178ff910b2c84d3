#include "solver/collision/hull.hpp"

namespace cycloid::solver {

Hull make_hull(const Shape<2>& shape, const Rotation<2>& rotation, const Vec<2>& position) {
  Hull hull;
  hull.count = shape.vertex_count;
  hull.radius = shape.radius;
  hull.ghosts = shape.ghosts;
  hull.one_sided = shape.kind == ShapeKind::kSegment;
  const std::uint32_t used = hull.one_sided ? 4 : hull.count;
  for (std::uint32_t i = 0; i < used; ++i) {
    hull.vertices[i] = position + rotate(rotation, shape.vertices[i]);
    hull.normals[i] = rotate(rotation, shape.normals[i]);
  }
  return hull;
}

static Manifold<2> one_point(const Vec<2>& normal, const Vec<2>& surface, float separation,
                             std::uint32_t feature, const Vec<2>& a_to_b) {
  Manifold<2> manifold;
  manifold.normal = normal;
  add_point(surface + (0.5f * separation) * normal, separation, feature, a_to_b, manifold);
  return manifold;
}

/// Whether the region of the vertex where a chain's segment ends belongs to the neighbour, which
/// will make the contact itself: the centre lies over the neighbour's edge.
static bool neighbour_takes_end(const Hull& segment, bool at_start, const Vec<2>& centre) {
  const std::uint32_t bit = at_start ? 1u : 2u;
  if ((segment.ghosts & bit) == 0) return false;
  const Vec<2> joint = segment.vertices[at_start ? 0 : 1];
  const Vec<2> far = segment.vertices[at_start ? 2 : 3];
  return dot(centre - joint, far - joint) > 0.0f;
}

/// Whether the segment that ends where this one starts sees the centre on its free side.
static bool predecessor_sees(const Hull& segment, const Vec<2>& centre) {
  if ((segment.ghosts & 1u) == 0) return false;
  const Vec<2> edge = segment.vertices[0] - segment.vertices[2];
  const Vec<2> normal = {{edge[1], -edge[0]}};
  return dot(normal, centre - segment.vertices[0]) >= 0.0f;
}

static Manifold<2> segment_against_ball(const Hull& segment, const Vec<2>& centre, float radius,
                                        const Vec<2>& a_to_b, float margin) {
  const Vec<2> a = segment.vertices[0];
  const Vec<2> b = segment.vertices[1];
  const Vec<2> normal = segment.normals[0];
  const float height = dot(normal, centre - a);
  const float reach = segment.radius + radius;
  if (height < 0.0f || height > reach + margin) return {};
  const Vec<2> edge = b - a;
  const float along = dot(centre - a, edge);
  const bool before = along < 0.0f;
  const bool after = along > dot(edge, edge);
  if (!before && !after)
    return one_point(normal, a + (along / dot(edge, edge)) * edge + segment.radius * normal,
                     height - reach, 0, a_to_b);
  if (neighbour_takes_end(segment, before, centre)) return {};
  // Both edges may meet the ball at this vertex; the one that ends there keeps it.
  if (before && predecessor_sees(segment, centre)) return {};
  const Vec<2> corner = before ? a : b;
  const Vec<2> offset = centre - corner;
  const float distance = length(offset);
  if (distance > reach + margin) return {};
  const Vec<2> direction = normalized_or(offset, normal);
  return one_point(direction, corner + segment.radius * direction, distance - reach, before ? 1 : 2,
                   a_to_b);
}

Manifold<2> hull_against_ball(const Hull& hull, const Vec<2>& centre, float radius,
                              const Vec<2>& a_to_b, float margin) {
  if (hull.one_sided) return segment_against_ball(hull, centre, radius, a_to_b, margin);
  const float reach = hull.radius + radius;
  std::uint32_t best = 0;
  float highest = dot(hull.normals[0], centre - hull.vertices[0]);
  for (std::uint32_t i = 1; i < hull.count; ++i) {
    const float height = dot(hull.normals[i], centre - hull.vertices[i]);
    if (height > highest) {
      highest = height;
      best = i;
    }
  }
  if (highest > reach + margin) return {};
  const std::uint32_t next = best + 1 < hull.count ? best + 1 : 0;
  const Vec<2> a = hull.vertices[best];
  const Vec<2> b = hull.vertices[next];
  const Vec<2> normal = hull.normals[best];
  const Vec<2> edge = b - a;
  const float along = dot(centre - a, edge);
  const bool before = along < 0.0f;
  const bool after = along > dot(edge, edge);
  // Feature: the edge, or 16 + the vertex.
  if (highest < 0.0f || (!before && !after)) {
    const Vec<2> foot = centre - highest * normal;
    return one_point(normal, foot + hull.radius * normal, highest - reach, best, a_to_b);
  }
  const Vec<2> corner = before ? a : b;
  const Vec<2> offset = centre - corner;
  const float distance = length(offset);
  if (distance > reach + margin) return {};
  const Vec<2> direction = normalized_or(offset, normal);
  return one_point(direction, corner + hull.radius * direction, distance - reach,
                   16 + (before ? best : next), a_to_b);
}

}  // namespace cycloid::solver
