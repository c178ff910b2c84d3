#include "solver/collision/rod.hpp"
#include "solver/collision/triangle.hpp"

namespace cycloid::solver {

/// The edge of the triangle that is nearest to the rod; of equal ones the first.
struct NearestEdge {
  std::uint32_t edge = 0;
  SegmentPair pair;
};

static NearestEdge nearest_edge(const Solid& triangle, const Rod& rod) {
  NearestEdge nearest;
  nearest.pair = nearest_to_edge(triangle, 0, rod);
  for (std::uint32_t i = 1; i < 3; ++i) {
    const SegmentPair pair = nearest_to_edge(triangle, 2 * i, rod);
    if (pair.distance < nearest.pair.distance) nearest = {i, pair};
  }
  return nearest;
}

/// The edges that the nearest point lies on.
static std::uint32_t edges_of(const NearestEdge& nearest) {
  if (nearest.pair.fraction_a == 0.0f) return edges_at(nearest.edge);
  if (nearest.pair.fraction_a == 1.0f) return edges_at(next_corner(nearest.edge));
  return 1u << nearest.edge;
}

static float height_at(const Solid& triangle, const Rod& rod, float fraction) {
  return dot(triangle.normals[0], point_on(rod, fraction) - triangle.vertices[0]);
}

/// How high the rod's axis is over the triangle's plane, m: at its ends, and within the part that
/// is over the triangle.
struct Heights {
  float from;
  float to;
  float low;
  float high;
};

/// The axis across an edge and the rod along which these are the least deep in each other, of those
/// that the surface allows.
struct WayOut {
  std::uint32_t edge = kNone;
  float separation = -3.0e38f;  ///< Of the edge and the rod's axis, m.
  Vec<3> normal;
};

/// Where the rod goes through the triangle, the axes that stand beside the triangle's normal. Each
/// edge makes one face of the Minkowski difference with the rod: that which the triangle is behind.
static WayOut way_out(const Solid& triangle, const Rod& rod) {
  const Vec<3> along = rod.to - rod.from;
  WayOut best;
  float refused = best.separation;
  for (std::uint32_t i = 0; i < 3; ++i) {
    const Vec<3> origin = triangle.vertices[i];
    const std::uint32_t next = next_corner(i);
    const Vec<3> side = triangle.vertices[next] - origin;
    const Vec<3> axis = cross(side, along);
    const float square = dot(axis, axis);
    // Nearly parallel: the triangle's normal stands in, as the rod lies almost in its plane.
    if (square <= 1.0e-5f * dot(side, side) * dot(along, along)) continue;
    const bool turned = dot(axis, triangle.vertices[next_corner(next)] - origin) > 0.0f;
    const Vec<3> normal = ((turned ? -1.0f : 1.0f) / sqrt(square)) * axis;
    const float separation = dot(normal, rod.from - origin);
    const bool allowed = dot(normal, triangle.normals[0]) >= -kFlat &&
                         leaning_of(triangle, 1u << i, normal) == Leaning::kAllowed;
    if (!allowed) refused = max(refused, separation);
    if (!allowed || separation <= best.separation) continue;
    best = {i, separation, normal};
  }
  // Along an axis that is not the shallowest of all the edge and the rod need not meet.
  return refused > best.separation ? WayOut{} : best;
}

/// The rod's axis goes through the triangle: the shallowest way out to the free side.
static void go_through(const Solid& triangle, const Rod& rod, const Span& span,
                       const Heights& heights, float margin, Manifold<3>& manifold) {
  const WayOut way = way_out(triangle, rod);
  const float slack = 2.0f * rounding_of(triangle, rod);
  if (way.edge == kNone || way.separation <= min(heights.from, heights.to) + slack) {
    add_span(triangle, 0, rod, span, margin, manifold);
    return;
  }
  manifold.normal = way.normal;
  const SegmentPair pair = nearest_to_edge(triangle, 2 * way.edge, rod);
  const float separation = way.separation - rod.radius;
  add_point(pair.on_b - (rod.radius + 0.5f * separation) * way.normal, separation,
            edge_feature(2 * way.edge), manifold);
}

/// Whether a rod that is behind the triangle where it is over it goes on to the free side beyond a
/// shared edge: it is in the neighbour, or behind it.
static bool leaves_over_neighbour(const Solid& triangle, const Rod& rod, const Span& span,
                                  bool upwards) {
  const Vec<3> leaves = point_on(rod, upwards ? span.to : span.from);
  std::uint32_t edge = 0;
  float least = 3.0e38f;
  for (std::uint32_t i = 0; i < 3; ++i) {
    const Vec<3> inward = -border_of(triangle, i).outward;
    const float distance = dot(inward, leaves - triangle.vertices[i]);
    if (distance >= least) continue;
    least = distance;
    edge = i;
  }
  return (triangle.ghosts >> edge & 1u) != 0;
}

/// A rod is met from the free side, by a rule without memory: its middle may lie behind the plane
/// by half of its radius where it is over the triangle, and is then pushed out along the
/// triangle's normal, and not at all where it is beside it. The other half of the radius is for
/// what lies on the back: triangles back to back would otherwise pull it through.
Manifold<3> triangle_against_rod(const Solid& triangle, const Rod& rod, float margin) {
  const float reach = rod.radius + margin;
  const float from = height_at(triangle, rod, 0.0f);
  const float to = height_at(triangle, rod, 1.0f);
  const float sunk = -0.5f * rod.radius;
  if (min(from, to) > reach || max(from, to) < sunk) return {};

  Manifold<3> manifold;
  manifold.normal = triangle.normals[0];
  const float slack = rounding_of(triangle, rod);
  const Span span = clip_to_face(triangle, 0, rod, 0.1f * slack);
  const bool over = span.from <= span.to;
  const float begin = height_at(triangle, rod, span.from);
  const float end = height_at(triangle, rod, span.to);
  const Heights heights = {from, to, min(begin, end), max(begin, end)};
  const bool end_over = over && (from <= to ? span.from == 0.0f : span.to == 1.0f);
  const bool behind = over && heights.high <= 0.0f;
  if (over && !behind && (end_over || heights.low <= 0.0f)) {
    if (0.5f * (from + to) < sunk) return {};
    if (heights.low > 0.0f)
      add_span(triangle, 0, rod, span, margin, manifold);
    else
      go_through(triangle, rod, span, heights, margin, manifold);
    return manifold;
  }
  // Behind the triangle as a whole, or a part of what goes through its neighbour.
  if (behind && (max(from, to) <= 0.0f || leaves_over_neighbour(triangle, rod, span, to > from))) {
    if (0.5f * (from + to) >= sunk) add_span(triangle, 0, rod, span, margin, manifold);
    return manifold;
  }

  const NearestEdge nearest = nearest_edge(triangle, rod);
  if (nearest.pair.distance > reach) return {};
  const Vec<3> normal = normal_between(edge_rod(triangle, 2 * nearest.edge), rod, nearest.pair);
  const Leaning leaning = leaning_of(triangle, edges_of(nearest), normal);
  const float upwards = dot(normal, triangle.normals[0]);
  // A rod across an edge where the surface goes on flat is over both triangles; so is, by a
  // rounding, one that lies on the triangle and sticks out over its edge.
  const bool lies_flat =
      upwards > kLiesFlat && heights.low <= nearest.pair.distance + 1.0e-4f * rod.radius;
  const bool barely_behind =
      behind && upwards < -kFlat && heights.low >= sunk && 0.5f * (from + to) >= sunk;
  if (over && (barely_behind || (!behind && (lies_flat || leaning == Leaning::kOwnOnly)))) {
    add_span(triangle, 0, rod, span, margin, manifold);
    return manifold;
  }
  if (leaning != Leaning::kAllowed || upwards < -kFlat) return {};
  // Beside the triangle by a rounding only: in the middle of a surface, where nothing may stumble.
  manifold.normal = upwards > 1.0f - kFlat * kFlat ? triangle.normals[0] : normal;
  add_edge_points(triangle, 2 * nearest.edge, rod, nearest.pair, margin, manifold);
  return manifold;
}

}  // namespace cycloid::solver
