#include "solver/shapes.hpp"

#include "solver/solids/hull_builder.hpp"
#include "solver/solids/polyhedra.hpp"
#include "solver/solids/triangles.hpp"
#include "solver/validate.hpp"

namespace cycloid::solver {

template <int D>
static Shape<D> blank_shape(const ShapeDef<D>& def) {
  Shape<D> shape{};
  shape.kind = def.kind;
  shape.body = kNone;
  shape.next = kNone;
  shape.material = def.material;
  shape.filter = def.filter;
  shape.radius = def.radius;
  return shape;
}

/// Outward unit normals of counter-clockwise edges; false where an edge has no length.
static bool compute_normals(Shape<2>& shape) {
  for (std::uint32_t i = 0; i < shape.vertex_count; ++i) {
    const std::uint32_t next = i + 1 < shape.vertex_count ? i + 1 : 0;
    const Vec<2> edge = shape.vertices[next] - shape.vertices[i];
    const float edge_length = length(edge);
    if (edge_length < kSizeMin) return false;
    shape.normals[i] = {{edge[1] / edge_length, -edge[0] / edge_length}};
  }
  return true;
}

/// Every vertex lies strictly inside of every edge it does not belong to. That also refuses
/// polygons that wind twice, which a test of turns alone lets through.
static bool is_convex(const Shape<2>& shape) {
  for (std::uint32_t i = 0; i < shape.vertex_count; ++i)
    for (std::uint32_t j = 0; j < shape.vertex_count; ++j) {
      const std::uint32_t next = i + 1 < shape.vertex_count ? i + 1 : 0;
      if (j == i || j == next) continue;
      const float height = dot(shape.normals[i], shape.vertices[j] - shape.vertices[i]);
      if (height > -0.1f * kSizeMin) return false;
    }
  return true;
}

static float signed_area(const std::vector<Vec<2>>& points) {
  float area = 0.0f;
  for (std::size_t i = 1; i + 1 < points.size(); ++i)
    area += 0.5f * cross(points[i] - points[0], points[i + 1] - points[0]);
  return area;
}

static Error append_polygon(const ShapeDef<2>& def, int index, std::vector<Shape<2>>& into) {
  Shape<2> shape = blank_shape(def);
  shape.vertex_count = static_cast<std::uint32_t>(def.points.size());
  const bool clockwise = signed_area(def.points) < 0.0f;
  for (std::size_t i = 0; i < def.points.size(); ++i)
    shape.vertices[i] = def.points[clockwise ? def.points.size() - 1 - i : i];
  if (!compute_normals(shape) || !is_convex(shape)) return {Code::kInvalid, "points", index};
  into.push_back(shape);
  return {};
}

static Error append_capsule(const ShapeDef<2>& def, int index, std::vector<Shape<2>>& into) {
  Shape<2> shape = blank_shape(def);
  shape.vertex_count = 2;
  shape.vertices[0] = def.points[0];
  shape.vertices[1] = def.points[1];
  if (!compute_normals(shape)) return {Code::kInvalid, "points", index};
  into.push_back(shape);
  return {};
}

static Error append_chain(const ShapeDef<2>& def, int index, std::vector<Shape<2>>& into) {
  const std::size_t n = def.points.size();
  if (def.loop && n < 3) return {Code::kInvalid, "points", index};
  std::vector<Shape<2>> segments;
  for (std::size_t i = 0; i + 1 < n + (def.loop ? 1 : 0); ++i) {
    Shape<2> shape = blank_shape(def);
    shape.kind = ShapeKind::kSegment;
    shape.vertex_count = 2;
    // Stored against its direction, so that the normal of edge 0 points to the free side as the
    // normals of a counter-clockwise hull point outwards.
    shape.vertices[0] = def.points[(i + 1) % n];
    shape.vertices[1] = def.points[i];
    if (!compute_normals(shape)) return {Code::kInvalid, "points", index};
    if (def.loop || i + 2 < n) {
      shape.vertices[2] = def.points[(i + 2) % n];
      shape.ghosts |= 1u;
    }
    if (def.loop || i > 0) {
      shape.vertices[3] = def.points[(i + n - 1) % n];
      shape.ghosts |= 2u;
    }
    segments.push_back(shape);
  }
  into.insert(into.end(), segments.begin(), segments.end());
  return {};
}

static Error append_outline(const ShapeDef<2>& def, int index, std::vector<Shape<2>>& into,
                            Polyhedra&) {
  if (def.kind == ShapeKind::kPolygon) return append_polygon(def, index, into);
  if (def.kind == ShapeKind::kCapsule) return append_capsule(def, index, into);
  return append_chain(def, index, into);
}

static Error append_capsule(const ShapeDef<3>& def, int index, std::vector<Shape<3>>& into) {
  if (length(def.points[1] - def.points[0]) < kSizeMin) return {Code::kInvalid, "points", index};
  Shape<3> shape = blank_shape(def);
  shape.vertex_count = 2;
  shape.vertices[0] = def.points[0];
  shape.vertices[1] = def.points[1];
  into.push_back(shape);
  return {};
}

static Error append_box(const ShapeDef<3>& def, std::vector<Shape<3>>& into) {
  Shape<3> shape = blank_shape(def);
  shape.vertex_count = 1;
  shape.vertices[0] = def.points.empty() ? Vec<3>::zero() : def.points[0];
  shape.half = def.half;
  shape.rotation = normalized_or(def.rotation, identity_rotation<3>());
  into.push_back(shape);
  return {};
}

static Error append_hull(const ShapeDef<3>& def, int index, std::vector<Shape<3>>& into,
                         Polyhedra& hulls) {
  PolyhedronData hull;
  if (!build_polyhedron(def.points, hull).ok()) return {Code::kInvalid, "points", index};
  Shape<3> shape = blank_shape(def);
  shape.vertex_count = 1;
  shape.vertices[0] = hull.middle;
  shape.half = hull.half;
  shape.rotation = identity_rotation<3>();
  shape.polyhedron = intern(hull.view(), hulls);
  into.push_back(shape);
  return {};
}

static Error append_outline(const ShapeDef<3>& def, int index, std::vector<Shape<3>>& into,
                            Polyhedra& hulls) {
  switch (def.kind) {
    case ShapeKind::kCapsule:
      return append_capsule(def, index, into);
    case ShapeKind::kBox:
      return append_box(def, into);
    case ShapeKind::kHull:
      return append_hull(def, index, into, hulls);
    case ShapeKind::kMesh:
      return append_mesh(def, index, blank_shape(def), into);
    case ShapeKind::kHeightField:
      return append_height_field(def, index, blank_shape(def), into);
    default:
      return {Code::kInvalid, "kind", index};
  }
}

template <int D>
Error append_shapes(const ShapeDef<D>& def, int index, std::vector<Shape<D>>& into,
                    Polyhedra& hulls) {
  if (def.kind != ShapeKind::kBall && def.kind != ShapeKind::kHalfSpace)
    return append_outline(def, index, into, hulls);
  Shape<D> shape = blank_shape(def);
  if (def.kind == ShapeKind::kBall) {
    shape.vertex_count = 1;
    shape.vertices[0] = def.points.empty() ? Vec<D>::zero() : def.points[0];
  } else {
    shape.normal = normalized_or(def.normal, def.normal);
    shape.offset = def.offset;
  }
  into.push_back(shape);
  return {};
}

template <int D>
void shift_shape(const Vec<D>& local_center, Shape<D>& shape) {
  // A segment's ghosts and a triangle's are places too.
  std::uint32_t used = shape.vertex_count;
  if (shape.kind == ShapeKind::kSegment) used = 4;
  if (shape.kind == ShapeKind::kTriangle) used = 6;
  for (std::uint32_t i = 0; i < used; ++i) shape.vertices[i] -= local_center;
  shape.offset =
      shape.kind == ShapeKind::kHalfSpace ? shape.offset - dot(shape.normal, local_center) : 0.0f;
}

float extent_of(const Shape<2>& shape) {
  float extent = 0.0f;
  for (std::uint32_t v = 0; v < shape.vertex_count; ++v)
    extent = max(extent, length(shape.vertices[v]) + shape.radius);
  return extent;
}
float extent_of(const Shape<3>& shape) {
  float extent = 0.0f;
  for (std::uint32_t v = 0; v < shape.vertex_count; ++v)
    extent = max(extent, length(shape.vertices[v]) + shape.radius);
  return extent + length(shape.half);
}

float thickness_of(const Shape<2>& shape) {
  if (shape.kind != ShapeKind::kPolygon) return shape.radius;
  Vec<2> middle = Vec<2>::zero();
  for (std::uint32_t v = 0; v < shape.vertex_count; ++v)
    middle += (1.0f / static_cast<float>(shape.vertex_count)) * shape.vertices[v];
  float inner = kSizeMax;
  for (std::uint32_t v = 0; v < shape.vertex_count; ++v)
    inner = min(inner, dot(shape.normals[v], shape.vertices[v] - middle));
  return max(inner, 0.0f) + shape.radius;
}
float thickness_of(const Shape<3>& shape) {
  return shape.radius + min(shape.half[0], min(shape.half[1], shape.half[2]));
}

template Error append_shapes(const ShapeDef<2>&, int, std::vector<Shape<2>>&, Polyhedra&);
template Error append_shapes(const ShapeDef<3>&, int, std::vector<Shape<3>>&, Polyhedra&);
template void shift_shape(const Vec<2>&, Shape<2>&);
template void shift_shape(const Vec<3>&, Shape<3>&);

}  // namespace cycloid::solver
