#include "solver/particles/shape_distance.hpp"

#include "solver/particles/solid_distance.hpp"

namespace cycloid::solver {

template <int D>
static SignedDistance<D> distance_to_point(const Vec<D>& corner, const Vec<D>& point,
                                           const Vec<D>& fallback) {
  const Vec<D> offset = point - corner;
  return {length(offset), normalized_or(offset, fallback)};
}

/// The edge whose line the point is highest over; of equals the first.
static std::uint32_t highest_edge(const Shape<2>& shape, const Vec<2>& point) {
  std::uint32_t best = 0;
  float highest = dot(shape.normals[0], point - shape.vertices[0]);
  for (std::uint32_t i = 1; i < shape.vertex_count; ++i) {
    const float height = dot(shape.normals[i], point - shape.vertices[i]);
    if (height > highest) {
      highest = height;
      best = i;
    }
  }
  return best;
}

/// To the edge from a to b, seen from its outer side or from beyond its ends.
static SignedDistance<2> distance_to_edge(const Vec<2>& a, const Vec<2>& b, const Vec<2>& normal,
                                          const Vec<2>& point) {
  const Vec<2> edge = b - a;
  if (dot(point - a, edge) < 0.0f) return distance_to_point(a, point, normal);
  if (dot(point - b, edge) > 0.0f) return distance_to_point(b, point, normal);
  return {dot(normal, point - a), normal};
}

/// A core without an inside: both of its sides are asked by one height, for two that are rounded
/// apart could both be below zero on the axis beyond an end.
static SignedDistance<2> distance_to_capsule_core(const Shape<2>& shape, const Vec<2>& point) {
  const Vec<2> a = shape.vertices[0];
  const Vec<2> b = shape.vertices[1];
  const bool on_first_side = dot(shape.normals[0], point - a) >= 0.0f;
  return distance_to_edge(a, b, on_first_side ? shape.normals[0] : -shape.normals[0], point);
}

/// Inside, the highest edge is the nearest. Outside it is the nearest or ends in the nearest
/// corner, because of all normals those of a corner's two edges are next to the way out of the
/// corner.
static SignedDistance<2> distance_to_core(const Shape<2>& shape, const Vec<2>& point) {
  const std::uint32_t edge = highest_edge(shape, point);
  const std::uint32_t next = edge + 1 < shape.vertex_count ? edge + 1 : 0;
  const Vec<2> normal = shape.normals[edge];
  const float height = dot(normal, point - shape.vertices[edge]);
  if (height < 0.0f) return {height, normal};
  return distance_to_edge(shape.vertices[edge], shape.vertices[next], normal, point);
}

static SignedDistance<2> local_distance(const Shape<2>& shape, const Vec<2>& point,
                                        const Polyhedra&) {
  SignedDistance<2> result;
  if (shape.kind == ShapeKind::kSegment)
    result = distance_to_edge(shape.vertices[0], shape.vertices[1], shape.normals[0], point);
  else if (shape.kind == ShapeKind::kBall)
    result = distance_to_point(shape.vertices[0], point, {{1.0f, 0.0f}});
  else if (shape.kind == ShapeKind::kCapsule)
    result = distance_to_capsule_core(shape, point);
  else
    result = distance_to_core(shape, point);
  result.distance -= shape.radius;
  return result;
}

static SignedDistance<3> core_distance(const Shape<3>& shape, const Vec<3>& point,
                                       const Polyhedra& polyhedra) {
  switch (shape.kind) {
    case ShapeKind::kCapsule:
      return distance_to_capsule(shape, point);
    case ShapeKind::kBox:
      return distance_to_box(shape, point);
    case ShapeKind::kHull:
      return distance_to_hull(shape, point, polyhedra);
    case ShapeKind::kTriangle:
      return distance_to_triangle(shape, point);
    default:
      return distance_to_point(shape.vertices[0], point, {{1.0f, 0.0f, 0.0f}});
  }
}
static SignedDistance<3> local_distance(const Shape<3>& shape, const Vec<3>& point,
                                        const Polyhedra& polyhedra) {
  SignedDistance<3> result = core_distance(shape, point, polyhedra);
  result.distance -= shape.radius;
  return result;
}

template <int D>
SignedDistance<D> signed_distance(const Shape<D>& shape, const Pose<D>& pose, const Vec<D>& point,
                                  const Polyhedra& polyhedra) {
  if (shape.kind == ShapeKind::kHalfSpace) {
    // The body may be far away; the point adds its own digits last.
    const Vec<D> normal = rotate(pose.rotation, shape.normal);
    return {dot(normal, point) - (shape.offset + dot(normal, pose.position)), normal};
  }
  SignedDistance<D> result =
      local_distance(shape, rotate_back(pose.rotation, point - pose.position), polyhedra);
  result.normal = rotate(pose.rotation, result.normal);
  return result;
}

template SignedDistance<2> signed_distance(const Shape<2>&, const Pose<2>&, const Vec<2>&,
                                           const Polyhedra&);
template SignedDistance<3> signed_distance(const Shape<3>&, const Pose<3>&, const Vec<3>&,
                                           const Polyhedra&);

}  // namespace cycloid::solver
