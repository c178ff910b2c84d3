#include "solver/queries/visit_shapes.hpp"

namespace cycloid::solver {

/// A ray in the frame of a shape: start and way. `fraction` above 1: nothing was met.
template <int D>
struct Ray {
  Vec<D> from;
  Vec<D> way;
};
template <int D>
struct Met {
  float fraction = 2.0f;
  Vec<D> normal = Vec<D>::zero();
};

template <int D>
static Met<D> inside(const Ray<D>& ray) {
  return {0.0f, normalized_or(-ray.way, -ray.way)};
}

/// |from + t way - centre| = radius, from outside: the smaller root.
template <int D>
static Met<D> ray_against_ball(const Ray<D>& ray, const Vec<D>& centre, float radius) {
  const Vec<D> offset = ray.from - centre;
  const float outside = dot(offset, offset) - radius * radius;
  if (outside <= 0.0f) return inside(ray);
  const float along = dot(offset, ray.way);
  const float square = dot(ray.way, ray.way);
  if (along >= 0.0f || square == 0.0f) return {};
  // The distance of the ray from the centre, by the foot of the perpendicular: along^2 - square *
  // outside would lose its digits far away.
  const Vec<D> foot = offset - (along / square) * ray.way;
  const float room = radius * radius - dot(foot, foot);
  if (room < 0.0f) return {};
  const float fraction = -along / square - sqrt(room / square);
  if (fraction > 1.0f) return {};
  const Vec<D> at = offset + fraction * ray.way;
  return {max(fraction, 0.0f), normalized_or(at, -ray.way)};
}

template <int D>
static Met<D> ray_against_half_space(const Ray<D>& ray, const Vec<D>& normal, float offset) {
  const float height = dot(normal, ray.from) - offset;
  if (height <= 0.0f) return inside(ray);
  const float speed = dot(normal, ray.way);
  if (speed >= 0.0f || height > -speed) return {};
  return {height / -speed, normal};
}

/// One straight side of a rounded outline: `start` to `end` moved out by the radius.
static Met<2> ray_against_side(const Ray<2>& ray, const Vec<2>& start, const Vec<2>& end,
                               const Vec<2>& normal, float radius) {
  const float height = dot(normal, ray.from - start) - radius;
  const float speed = dot(normal, ray.way);
  if (speed >= 0.0f || height < 0.0f || height > -speed) return {};
  const float fraction = height / -speed;
  const Vec<2> edge = end - start;
  const float along = dot(ray.from + fraction * ray.way - start, edge);
  if (along < 0.0f || along > dot(edge, edge)) return {};
  return {fraction, normal};
}

static bool contains(const Shape<2>& shape, const Vec<2>& point) {
  float highest = -3.0e38f;
  std::uint32_t best = 0;
  for (std::uint32_t i = 0; i < shape.vertex_count; ++i) {
    const float height = dot(shape.normals[i], point - shape.vertices[i]);
    if (height > highest) {
      highest = height;
      best = i;
    }
  }
  // A capsule has no inside but its radius.
  if (highest <= 0.0f && shape.vertex_count > 2) return true;
  if (highest > shape.radius) return false;
  const Vec<2> start = shape.vertices[best];
  const Vec<2> edge = shape.vertices[(best + 1) % shape.vertex_count] - start;
  const float share = clamp(dot(point - start, edge) / dot(edge, edge), 0.0f, 1.0f);
  const Vec<2> offset = point - (start + share * edge);
  return dot(offset, offset) <= shape.radius * shape.radius;
}

static Met<2> ray_against_hull(const Ray<2>& ray, const Shape<2>& shape) {
  const bool segment = shape.kind == ShapeKind::kSegment;
  if (!segment && contains(shape, ray.from)) return inside(ray);
  Met<2> first;
  const std::uint32_t sides = segment ? 1 : shape.vertex_count;
  for (std::uint32_t i = 0; i < sides; ++i) {
    const std::uint32_t next = (i + 1) % shape.vertex_count;
    const Met<2> met = ray_against_side(ray, shape.vertices[i], shape.vertices[next],
                                        shape.normals[i], shape.radius);
    if (met.fraction < first.fraction) first = met;
  }
  if (shape.radius == 0.0f) return first;
  for (std::uint32_t i = 0; i < shape.vertex_count; ++i) {
    const Met<2> met = ray_against_ball(ray, shape.vertices[i], shape.radius);
    const bool from_behind = segment && dot(shape.normals[0], met.normal) < 0.0f;
    if (!from_behind && met.fraction < first.fraction) first = met;
  }
  return first;
}
/// Space has no hulls yet.
static Met<3> ray_against_hull(const Ray<3>&, const Shape<3>&) {
  return {};
}

template <int D>
static Met<D> ray_against(const Ray<D>& ray, const Shape<D>& shape) {
  switch (shape.kind) {
    case ShapeKind::kBall:
      return ray_against_ball(ray, shape.vertices[0], shape.radius);
    case ShapeKind::kHalfSpace:
      return ray_against_half_space(ray, shape.normal, shape.offset);
    default:
      return ray_against_hull(ray, shape);
  }
}

template <int D>
std::vector<QueryHit<D>> ray_cast(const WorldState<D>& state, const Vec<D>& from, const Vec<D>& to,
                                  const QueryFilter& filter) {
  std::vector<QueryHit<D>> hits;
  const Vec<D> way = to - from;
  visit_shapes(state, way_bounds<D>({from, from}, way), filter,
               [&](std::uint32_t, const Shape<D>& shape, const Body<D>& body) {
                 const Ray<D> ray = {rotate_back(body.rotation, from - body.position),
                                     rotate_back(body.rotation, way)};
                 const Met<D> met = ray_against(ray, shape);
                 if (met.fraction > 1.0f) return;
                 QueryHit<D> hit = hit_of(shape, body);
                 hit.fraction = met.fraction;
                 hit.point = from + met.fraction * way;
                 hit.normal = rotate(body.rotation, met.normal);
                 hits.push_back(hit);
               });
  return hits;
}

template <int D>
std::optional<QueryHit<D>> ray_cast_first(const WorldState<D>& state, const Vec<D>& from,
                                          const Vec<D>& to, const QueryFilter& filter) {
  return first_of(ray_cast(state, from, to, filter));
}

template std::vector<QueryHit<2>> ray_cast(const WorldState<2>&, const Vec<2>&, const Vec<2>&,
                                           const QueryFilter&);
template std::vector<QueryHit<3>> ray_cast(const WorldState<3>&, const Vec<3>&, const Vec<3>&,
                                           const QueryFilter&);
template std::optional<QueryHit<2>> ray_cast_first(const WorldState<2>&, const Vec<2>&,
                                                   const Vec<2>&, const QueryFilter&);
template std::optional<QueryHit<3>> ray_cast_first(const WorldState<3>&, const Vec<3>&,
                                                   const Vec<3>&, const QueryFilter&);

}  // namespace cycloid::solver
