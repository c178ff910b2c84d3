#include "solver/queries/separation.hpp"

#include "solver/queries/solid_queries.hpp"

namespace cycloid::solver {

static void place_vertices(const Shape<2>& shape, const Rotation<2>& rotation,
                           const Vec<2>& position, const Polyhedra&, Core<2>& core) {
  core.count = shape.vertex_count;
  const std::uint32_t used = core.one_sided() ? 4 : core.count;
  for (std::uint32_t i = 0; i < used; ++i) {
    core.vertices[i] = position + rotate(rotation, shape.vertices[i]);
    core.normals[i] = rotate(rotation, shape.normals[i]);
  }
}

template <int D>
Core<D> core_of(const Shape<D>& shape, const Rotation<D>& rotation, const Vec<D>& position,
                const Polyhedra& polyhedra) {
  Core<D> core{};
  core.kind = shape.kind;
  core.radius = shape.radius;
  core.ghosts = shape.ghosts;
  if (core.half_space()) {
    core.normal = rotate(rotation, shape.normal);
    core.offset = shape.offset + dot(core.normal, position);
    return core;
  }
  place_vertices(shape, rotation, position, polyhedra, core);
  return core;
}

Core<2> core_of(const Probe<2>& probe, const Rotation<2>& rotation) {
  return core_of(shape_of(probe), rotation, Vec<2>::zero(), {});
}

/// The edge normal along which two cores are farthest apart.
template <int D>
struct CoreAxis {
  bool found = false;
  float separation = -3.0e38f;
  Vec<D> normal = Vec<D>::zero();
  std::uint32_t vertex = 0;  ///< Of the other core, lowest along the normal.
};

/// @param faces  of `a`: how many of its edges have a normal that counts.
template <int D>
static CoreAxis<D> best_axis(const Core<D>& a, const Core<D>& b, std::uint32_t faces) {
  CoreAxis<D> best;
  for (std::uint32_t i = 0; i < faces; ++i) {
    std::uint32_t lowest = 0;
    float height = dot(a.normals[i], b.vertices[0] - a.vertices[i]);
    for (std::uint32_t j = 1; j < b.count; ++j) {
      const float other = dot(a.normals[i], b.vertices[j] - a.vertices[i]);
      if (other < height) {
        height = other;
        lowest = j;
      }
    }
    if (height > best.separation) best = {true, height, a.normals[i], lowest};
  }
  return best;
}

/// The nearest points of two cores that do not cross.
template <int D>
struct CorePair {
  float square = 3.0e38f;
  Vec<D> on_a = Vec<D>::zero();
  Vec<D> on_b = Vec<D>::zero();
};

/// The vertices of `points` against the edges of `edges`.
template <int D>
static void nearest_pair(const Core<D>& edges, const Core<D>& points, bool flipped,
                         CorePair<D>& best) {
  const std::uint32_t edge_count = edges.count > 2 ? edges.count : 1;
  for (std::uint32_t i = 0; i < edge_count; ++i) {
    const Vec<D> from = edges.vertices[i];
    const Vec<D> span = edges.vertices[edges.next(i)] - from;
    const float square = dot(span, span);
    for (std::uint32_t j = 0; j < points.count; ++j) {
      const Vec<D> point = points.vertices[j];
      const float fraction =
          square > 0.0f ? clamp(dot(point - from, span) / square, 0.0f, 1.0f) : 0.0f;
      // The far end itself, not a sum that rounds beside it.
      const Vec<D> foot = fraction < 1.0f ? from + fraction * span : edges.vertices[edges.next(i)];
      const Vec<D> between = point - foot;
      const float distance = dot(between, between);
      if (distance >= best.square) continue;
      best.square = distance;
      best.on_a = flipped ? point : foot;
      best.on_b = flipped ? foot : point;
    }
  }
}

/// Whether two lines of two points cross. Nearly parallel ones count as apart: their ends are
/// then as near as they are.
static bool lines_cross(const Core<2>& a, const Core<2>& b) {
  const Vec<2> span_a = a.vertices[1] - a.vertices[0];
  const Vec<2> span_b = b.vertices[1] - b.vertices[0];
  const Vec<2> between = b.vertices[0] - a.vertices[0];
  const float area = cross(span_a, span_b);
  if (abs(area) <= 1.0e-6f * sqrt(dot(span_a, span_a) * dot(span_b, span_b))) return false;
  const float along_a = cross(between, span_b) / area;
  const float along_b = cross(between, span_a) / area;
  return along_a >= 0.0f && along_a <= 1.0f && along_b >= 0.0f && along_b <= 1.0f;
}

static bool cores_cross(const Core<2>& a, const Core<2>& b, float separation) {
  if (a.count < 2 && b.count < 2) return false;
  if (a.count > 2 || b.count > 2) return separation < 0.0f;
  // A point beside a line, or two lines: rounding may put every height below 0 far from any touch.
  return a.count == 2 && b.count == 2 && lines_cross(a, b);
}

/// The largest separation over all edge normals of both, without the rule for one-sided shapes.
template <int D>
static float axis_separation(const Core<D>& a, const Core<D>& b) {
  const auto all_faces = [](const Core<D>& core) { return core.count < 2 ? 0u : core.count; };
  return max(best_axis(a, b, all_faces(a)).separation, best_axis(b, a, all_faces(b)).separation);
}

template <int D>
static Separation<D> across(const Core<D>& a, const Core<D>& b) {
  CoreAxis<D> axis_a = best_axis(a, b, a.faces());
  CoreAxis<D> axis_b = best_axis(b, a, b.faces());
  if (a.one_sided()) axis_b.found = false;
  if (b.one_sided() && !a.one_sided()) axis_a.found = false;
  const bool flipped = axis_b.found && (!axis_a.found || axis_b.separation > axis_a.separation);
  Separation<D> result{};
  CoreAxis<D> axis = flipped ? axis_b : axis_a;
  const Core<D>& other = flipped ? a : b;
  const float reference_radius = flipped ? b.radius : a.radius;
  if (!axis.found) {
    axis.separation = 0.0f;
    axis.vertex = 0;
    axis.normal = Vec<D>::zero();
    axis.normal[1] = 1.0f;  // Concentric balls part upwards, as in `collide`.
  }
  const Vec<D> deepest = other.vertices[axis.vertex];
  const Vec<D> on_reference = deepest + (reference_radius - axis.separation) * axis.normal;
  const Vec<D> on_other = deepest - other.radius * axis.normal;
  result.distance = axis.separation - (a.radius + b.radius);
  result.normal = flipped ? -axis.normal : axis.normal;
  result.point_a = flipped ? on_other : on_reference;
  result.point_b = flipped ? on_reference : on_other;
  return result;
}

template <int D>
static Separation<D> from_half_space(const Core<D>& plane, const Core<D>& core) {
  std::uint32_t lowest = 0;
  float height = dot(plane.normal, core.vertices[0]);
  for (std::uint32_t i = 1; i < core.count; ++i) {
    const float other = dot(plane.normal, core.vertices[i]);
    if (other < height) {
      height = other;
      lowest = i;
    }
  }
  Separation<D> result{};
  const float core_height = height - plane.offset;
  result.distance = core_height - core.radius;
  result.normal = plane.normal;
  result.point_a = core.vertices[lowest] - core_height * plane.normal;
  result.point_b = core.vertices[lowest] - core.radius * plane.normal;
  result.crossing = core_height < 0.0f;
  return result;
}

static Separation<2> separation_of_cores(const Core<2>& a, const Core<2>& b) {
  if (cores_cross(a, b, axis_separation(a, b))) {
    Separation<2> result = across(a, b);
    result.crossing = true;
    return result;
  }
  CorePair<2> pair;
  nearest_pair(a, b, false, pair);
  nearest_pair(b, a, true, pair);
  const float distance = sqrt(pair.square);
  // Cores that all but touch have no direction between them.
  if (distance < 1.0e-6f) return across(a, b);
  Separation<2> result{};
  result.normal = (1.0f / distance) * (pair.on_b - pair.on_a);
  result.distance = distance - (a.radius + b.radius);
  result.point_a = pair.on_a + a.radius * result.normal;
  result.point_b = pair.on_b - b.radius * result.normal;
  return result;
}

template <int D>
Separation<D> separation_of(const Core<D>& a, const Core<D>& b) {
  if (a.half_space()) return from_half_space(a, b);
  if (b.half_space()) {
    Separation<D> result = from_half_space(b, a);
    const Vec<D> on_plane = result.point_a;
    result.normal = -result.normal;
    result.point_a = result.point_b;
    result.point_b = on_plane;
    return result;
  }
  return separation_of_cores(a, b);
}

bool allows(const Core<2>& core, const Vec<2>& normal) {
  if (!core.one_sided()) return true;
  const Vec<2> own = core.normals[0];
  if (dot(normal, own) < 0.0f) return false;
  // A sine: rounding must not close the seam between two segments to both of them.
  constexpr float kSlack = 1.0e-3f;
  const float turn = cross(own, normal);
  const bool towards_end = turn > 0.0f;
  if ((core.ghosts & (towards_end ? 2u : 1u)) == 0) return true;
  if (abs(turn) <= kSlack) return true;
  const Vec<2> edge =
      towards_end ? core.vertices[3] - core.vertices[1] : core.vertices[0] - core.vertices[2];
  const Vec<2> neighbour = normalized_or(Vec<2>{{edge[1], -edge[0]}}, own);
  // On a convex corner the normal may turn as far as the neighbour's, on a concave one not at all.
  const float corner = towards_end ? cross(own, neighbour) : cross(neighbour, own);
  const float left = towards_end ? cross(normal, neighbour) : cross(neighbour, normal);
  return corner > 0.0f && left >= -kSlack;
}

template Core<2> core_of(const Shape<2>&, const Rotation<2>&, const Vec<2>&, const Polyhedra&);
template Core<3> core_of(const Shape<3>&, const Rotation<3>&, const Vec<3>&, const Polyhedra&);
template Separation<2> separation_of(const Core<2>&, const Core<2>&);
template Separation<3> separation_of(const Core<3>&, const Core<3>&);

}  // namespace cycloid::solver
