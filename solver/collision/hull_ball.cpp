#include "solver/collision/hull.hpp"

namespace cycloid::solver {

/// (x0, y0, x1, y1, ...) as (x0, x1, ...) and (y0, y1, ...).
static Four by_coordinate(const Vec<2>* from) {
  using Raw = Lanes<4>::Raw;
  const Raw low = Lanes<4>::load(from[0].v).raw;
  const Raw high = Lanes<4>::load(from[2].v).raw;
  return {{Lanes<4>(Raw{low[0], low[2], high[0], high[2]}),
           Lanes<4>(Raw{low[1], low[3], high[1], high[3]})}};
}

Hull make_hull(const Shape<2>& shape, const Rotation<2>& rotation, const Vec<2>& position) {
  Hull hull;
  hull.count = shape.vertex_count;
  hull.radius = shape.radius;
  hull.ghosts = shape.ghosts;
  hull.one_sided = shape.kind == ShapeKind::kSegment;
  const std::uint32_t used = hull.one_sided ? 4 : hull.count;
  const Four turn = in_each_lane(rotation);
  for (std::uint32_t i = 0; i < used; i += 4) {
    const Four vertices = in_each_lane(position) + rotate(turn, by_coordinate(&shape.vertices[i]));
    vertices[0].store(&hull.vertex_x[i]);
    vertices[1].store(&hull.vertex_y[i]);
    const Four normals = rotate(turn, by_coordinate(&shape.normals[i]));
    normals[0].store(&hull.normal_x[i]);
    normals[1].store(&hull.normal_y[i]);
  }
  for (std::uint32_t i = used; i % 4 != 0; ++i) {
    hull.vertex_x[i] = hull.vertex_x[0];
    hull.vertex_y[i] = hull.vertex_y[0];
    hull.normal_x[i] = hull.normal_x[0];
    hull.normal_y[i] = hull.normal_y[0];
  }
  return hull;
}

static Manifold<2> one_point(const Vec<2>& normal, const Vec<2>& surface, float separation,
                             std::uint32_t feature) {
  Manifold<2> manifold;
  manifold.normal = normal;
  add_point(surface + (0.5f * separation) * normal, separation, feature, manifold);
  return manifold;
}

/// Whether the region of the vertex where a chain's segment ends belongs to the neighbour, which
/// will make the contact itself: the centre lies over the neighbour's edge.
static bool neighbour_takes_end(const Hull& segment, bool at_start, const Vec<2>& centre) {
  const std::uint32_t bit = at_start ? 1u : 2u;
  if ((segment.ghosts & bit) == 0) return false;
  const Vec<2> joint = segment.vertex(at_start ? 0 : 1);
  const Vec<2> far = segment.vertex(at_start ? 2 : 3);
  return dot(centre - joint, far - joint) > 0.0f;
}

/// Whether the segment that ends where this one starts sees the centre on its free side.
static bool predecessor_sees(const Hull& segment, const Vec<2>& centre) {
  if ((segment.ghosts & 1u) == 0) return false;
  const Vec<2> edge = segment.vertex(0) - segment.vertex(2);
  const Vec<2> normal = {{edge[1], -edge[0]}};
  return dot(normal, centre - segment.vertex(0)) >= 0.0f;
}

static Manifold<2> segment_against_ball(const Hull& segment, const Vec<2>& centre, float radius,
                                        float margin) {
  const Vec<2> a = segment.vertex(0);
  const Vec<2> b = segment.vertex(1);
  const Vec<2> normal = segment.normal(0);
  const float height = dot(normal, centre - a);
  const float reach = segment.radius + radius;
  if (height < 0.0f || height > reach + margin) return {};
  const Vec<2> edge = b - a;
  const float along = dot(centre - a, edge);
  const bool before = along < 0.0f;
  const bool after = along > dot(edge, edge);
  if (!before && !after)
    return one_point(normal, a + (along / dot(edge, edge)) * edge + segment.radius * normal,
                     height - reach, 0);
  if (neighbour_takes_end(segment, before, centre)) return {};
  // Both edges may meet the ball at this vertex; the one that ends there keeps it.
  if (before && predecessor_sees(segment, centre)) return {};
  const Vec<2> corner = before ? a : b;
  const Vec<2> offset = centre - corner;
  const float distance = length(offset);
  if (distance > reach + margin) return {};
  const Vec<2> direction = normalized_or(offset, normal);
  return one_point(direction, corner + segment.radius * direction, distance - reach,
                   before ? 1 : 2);
}

Manifold<2> hull_against_ball(const Hull& hull, const Vec<2>& centre, float radius, float margin) {
  if (hull.one_sided) return segment_against_ball(hull, centre, radius, margin);
  const float reach = hull.radius + radius;
  std::uint32_t best = 0;
  float highest = -3.0e38f;
  const Four at = in_each_lane(centre);
  for (std::uint32_t first = 0; first < hull.count; first += 4) {
    const Greatest most =
        greatest_of(dot(four_normals(hull, first), at - four_vertices(hull, first)));
    if (most.value > highest) {
      highest = most.value;
      best = first + most.lane;
    }
  }
  if (highest > reach + margin) return {};
  const std::uint32_t next = best + 1 < hull.count ? best + 1 : 0;
  const Vec<2> a = hull.vertex(best);
  const Vec<2> b = hull.vertex(next);
  const Vec<2> normal = hull.normal(best);
  const Vec<2> edge = b - a;
  const float along = dot(centre - a, edge);
  const bool before = along < 0.0f;
  const bool after = along > dot(edge, edge);
  // Feature: the edge, or 16 + the vertex.
  if (highest < 0.0f || (!before && !after)) {
    const Vec<2> foot = centre - highest * normal;
    return one_point(normal, foot + hull.radius * normal, highest - reach, best);
  }
  const Vec<2> corner = before ? a : b;
  const Vec<2> offset = centre - corner;
  const float distance = length(offset);
  if (distance > reach + margin) return {};
  const Vec<2> direction = normalized_or(offset, normal);
  return one_point(direction, corner + hull.radius * direction, distance - reach,
                   16 + (before ? best : next));
}

}  // namespace cycloid::solver
