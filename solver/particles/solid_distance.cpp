#include "solver/particles/solid_distance.hpp"

#include "solver/collision/solid.hpp"

namespace cycloid::solver {

static SignedDistance<3> to_point(const Vec<3>& corner, const Vec<3>& point,
                                  const Vec<3>& fallback) {
  const Vec<3> offset = point - corner;
  return {length(offset), normalized_or(offset, fallback)};
}

static SignedDistance<3> to_line(const Vec<3>& from, const Vec<3>& to, const Vec<3>& point,
                                 const Vec<3>& fallback) {
  const Vec<3> span = to - from;
  const float square = dot(span, span);
  const float along = dot(point - from, span);
  if (!(along > 0.0f)) return to_point(from, point, fallback);
  if (along >= square) return to_point(to, point, fallback);
  return to_point(from + (along / square) * span, point, fallback);
}

SignedDistance<3> distance_to_capsule(const Shape<3>& shape, const Vec<3>& point) {
  const Vec<3> axis =
      normalized_or(shape.vertices[1] - shape.vertices[0], Vec<3>{{0.0f, 1.0f, 0.0f}});
  Vec<3> sides[2];
  tangents(axis, sides);
  return to_line(shape.vertices[0], shape.vertices[1], point, sides[0]);
}

SignedDistance<3> distance_to_box(const Shape<3>& shape, const Vec<3>& point) {
  const Vec<3> at = rotate_back(shape.rotation, point - shape.vertices[0]);
  Vec<3> beyond = Vec<3>::zero();
  float highest = -3.0e38f;
  Vec<3> normal = Vec<3>::zero();
  for (int i = 0; i < 3; ++i) {
    const float height = abs(at[i]) - shape.half[i];
    const float side = at[i] < 0.0f ? -1.0f : 1.0f;
    if (height > 0.0f) beyond[i] = side * height;
    if (height <= highest) continue;
    highest = height;
    normal = Vec<3>::zero();
    normal[i] = side;
  }
  SignedDistance<3> result{highest, normal};
  if (highest > 0.0f) {
    result.distance = length(beyond);
    result.normal = normalized_or(beyond, normal);
  }
  result.normal = rotate(shape.rotation, result.normal);
  return result;
}

SignedDistance<3> distance_to_triangle(const Shape<3>& shape, const Vec<3>& point) {
  bool within = true;
  SignedDistance<3> nearest{3.0e38f, shape.normal};
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec<3>& from = shape.vertices[i];
    const Vec<3>& to = shape.vertices[i < 2 ? i + 1 : 0];
    const float beyond = dot(cross(to - from, shape.normal), point - from);
    if (beyond <= 0.0f) continue;
    within = false;
    const SignedDistance<3> edge = to_line(from, to, point, shape.normal);
    if (edge.distance < nearest.distance) nearest = edge;
  }
  if (!within) return nearest;
  return {dot(shape.normal, point - shape.vertices[0]), shape.normal};
}

/// The heights over the planes of all faces, and the highest; of equals the first.
static std::uint32_t highest_face(const PolyhedronView& hull, const Vec<3>& point,
                                  std::array<float, kHullFacesMax>& heights) {
  std::uint32_t best = 0;
  for (std::uint32_t f = 0; f < hull.faces.size(); ++f) {
    heights[f] = dot(hull.faces[f].normal, point) - hull.faces[f].offset;
    if (heights[f] > heights[best]) best = f;
  }
  return best;
}

static Vec<3> corner_of(const PolyhedronView& hull, std::uint32_t edge) {
  return hull.vertices[hull.edges[edge].origin].position;
}

static bool above_face(const PolyhedronView& hull, std::uint32_t face, const Vec<3>& point) {
  const std::uint32_t first = hull.faces[face].edge;
  std::uint32_t edge = first;
  do {
    const Vec<3> from = corner_of(hull, edge);
    const Vec<3> span = corner_of(hull, hull.edges[edge].next) - from;
    if (dot(cross(span, hull.faces[face].normal), point - from) > 0.0f) return false;
    edge = hull.edges[edge].next;
  } while (edge != first);
  return true;
}

/// Inside, the face of the highest plane is the nearest. Outside no point is nearer than that plane
/// is, so that face is the nearest if the point is right above it; otherwise an edge is, of a face
/// that the point is in front of.
static SignedDistance<3> local_distance(const PolyhedronView& hull, const Vec<3>& point) {
  std::array<float, kHullFacesMax> heights;
  const std::uint32_t face = highest_face(hull, point, heights);
  const Vec<3>& normal = hull.faces[face].normal;
  if (heights[face] <= 0.0f || above_face(hull, face, point)) return {heights[face], normal};
  SignedDistance<3> nearest{3.0e38f, normal};
  for (std::uint32_t e = 0; e < hull.edges.size(); e += 2) {
    if (!(max(heights[hull.edges[e].face], heights[hull.edges[e + 1].face]) > 0.0f)) continue;
    const SignedDistance<3> edge =
        to_line(corner_of(hull, e), corner_of(hull, e + 1), point, normal);
    if (edge.distance < nearest.distance) nearest = edge;
  }
  return nearest;
}

SignedDistance<3> distance_to_hull(const Shape<3>& shape, const Vec<3>& point,
                                   const Polyhedra& polyhedra) {
  const Vec<3> at = rotate_back(shape.rotation, point - shape.vertices[0]);
  SignedDistance<3> result = local_distance(view_of(polyhedra, shape.polyhedron), at);
  result.normal = rotate(shape.rotation, result.normal);
  return result;
}

}  // namespace cycloid::solver
