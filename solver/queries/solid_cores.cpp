#include <utility>

#include "solver/collision/solid.hpp"
#include "solver/queries/solid_queries.hpp"

namespace cycloid::solver {

static void set_topology(const PolyhedronView& view, Core<3>& core) {
  core.face_count = static_cast<std::uint32_t>(view.faces.size());
  core.edge_count = static_cast<std::uint32_t>(view.edges.size());
  core.faces = view.faces.data();
  core.edges = view.edges.data();
}

/// As `place`, but without the normals of its faces, which most queries never ask for.
static void place_hull(const Shape<3>& shape, const Rotation<3>& rotation, const Vec<3>& position,
                       const Polyhedra& polyhedra, Core<3>& core) {
  const PolyhedronView view = view_of(polyhedra, shape.polyhedron);
  set_topology(view, core);
  core.count = static_cast<std::uint32_t>(view.vertices.size());
  core.rotation = compose(rotation, shape.rotation);
  core.centre = position + rotate(rotation, shape.vertices[0]);
  for (std::size_t i = 0; i < view.vertices.size(); ++i)
    core.vertices[i] = core.centre + rotate(core.rotation, view.vertices[i].position);
}

static void place_flat(const Shape<3>& shape, const Rotation<3>& rotation, const Vec<3>& position,
                       const Polyhedra& polyhedra, Core<3>& core) {
  Solid solid;
  place(shape, polyhedra, rotation, position, solid);
  core.count = solid.vertex_count;
  core.face_count = solid.face_count;
  core.edge_count = solid.edge_count;
  core.faces = solid.faces;
  core.edges = solid.edges;
  for (std::size_t i = 0; i < core.count; ++i) core.vertices[i] = solid.vertices[i];
  for (std::size_t i = 0; i < core.face_count; ++i) core.normals[i] = solid.normals[i];
  if (!core.one_sided()) return;
  for (std::size_t i = 0; i < 3; ++i) core.vertices[3 + i] = solid.ghost_points[i];
}

void place_vertices(const Shape<3>& shape, const Rotation<3>& rotation, const Vec<3>& position,
                    const Polyhedra& polyhedra, Core<3>& core) {
  if (shape.kind == ShapeKind::kHull) return place_hull(shape, rotation, position, polyhedra, core);
  if (shape.kind == ShapeKind::kBox || shape.kind == ShapeKind::kTriangle)
    return place_flat(shape, rotation, position, polyhedra, core);
  core.count = shape.kind == ShapeKind::kBall ? 1 : 2;
  for (std::uint32_t i = 0; i < core.count; ++i)
    core.vertices[i] = position + rotate(rotation, shape.vertices[i]);
}

/// Whether the edges from corner 0 to the corners i, j, k span a box of all eight corners, which
/// `order` then lists as `box_topology` does.
static bool spans_box(const Core<3>& core, std::uint32_t i, std::uint32_t j, std::uint32_t k,
                      std::uint32_t (&order)[8]) {
  const Vec<3>& origin = core.vertices[0];
  const Vec<3> x = core.vertices[i] - origin;
  const Vec<3> y = core.vertices[j] - origin;
  const Vec<3> z = core.vertices[k] - origin;
  const float square = dot(x, x) + dot(y, y) + dot(z, z);
  const float slack = 1.0e-5f * square;
  if (abs(dot(x, y)) > slack || abs(dot(y, z)) > slack || abs(dot(z, x)) > slack) return false;
  if (!(dot(cross(x, y), z) > 0.0f)) return false;
  std::uint32_t used = 0;
  for (std::uint32_t corner = 0; corner < 8; ++corner) {
    Vec<3> place = origin;
    if ((corner & 1u) != 0) place += x;
    if ((corner & 2u) != 0) place += y;
    if ((corner & 4u) != 0) place += z;
    std::uint32_t found = 8;
    for (std::uint32_t v = 8; v-- > 0;) {
      const Vec<3> off = core.vertices[v] - place;
      if (dot(off, off) <= 1.0e-10f * square) found = v;
    }
    if (found == 8 || (used >> found & 1u) != 0) return false;
    used |= 1u << found;
    order[corner] = found;
  }
  return true;
}

static void find_box(Core<3>& core) {
  std::uint32_t order[8];
  bool found = false;
  for (std::uint32_t i = 1; i < 8 && !found; ++i)
    for (std::uint32_t j = i + 1; j < 8 && !found; ++j)
      for (std::uint32_t k = j + 1; k < 8 && !found; ++k)
        found = spans_box(core, i, j, k, order) || spans_box(core, i, k, j, order);
  if (!found) return;
  core.kind = ShapeKind::kBox;
  set_topology(box_topology(), core);
  const Core<3> given = core;
  for (std::size_t i = 0; i < 8; ++i) core.vertices[i] = given.vertices[order[i]];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Vec<3> span = core.vertices[std::size_t{1} << axis] - core.vertices[0];
    core.normals[2 * axis + 1] = normalized_or(span, {{0.0f, 1.0f, 0.0f}});
    core.normals[2 * axis] = -core.normals[2 * axis + 1];
  }
}

/// Faces for the points of a probe, if there is a hull of them.
static void find_hull(const Probe<3>& probe, const Rotation<3>& rotation, Core<3>& core) {
  auto hull = std::make_shared<PolyhedronData>();
  if (!build_polyhedron(std::span(probe.points).first(probe.count), *hull).ok()) return;
  core.kind = ShapeKind::kHull;
  set_topology(hull->view(), core);
  core.count = static_cast<std::uint32_t>(hull->vertices.size());
  core.rotation = rotation;
  core.centre = rotate(rotation, hull->middle);
  for (std::size_t i = 0; i < core.count; ++i)
    core.vertices[i] = core.centre + rotate(rotation, hull->vertices[i].position);
  core.own = std::move(hull);
}

Core<3> core_of(const Probe<3>& probe, const Rotation<3>& rotation) {
  Core<3> core{};
  core.kind = ShapeKind::kBall;
  if (probe.count > 1) core.kind = ShapeKind::kCapsule;
  core.count = probe.count;
  core.radius = probe.radius;
  for (std::size_t i = 0; i < core.count; ++i) core.vertices[i] = rotate(rotation, probe.points[i]);
  if (core.count == 8) find_box(core);
  if (core.count >= 4 && core.kind != ShapeKind::kBox) find_hull(probe, rotation, core);
  return core;
}

/// Whether a neighbour across edge i of a triangle leaves `normal` to this one.
static bool allows_across(const Core<3>& core, std::uint32_t i, const Vec<3>& normal) {
  // A sine: rounding must not close the seam between two triangles to both of them.
  constexpr float kSlack = 1.0e-3f;
  if ((core.ghosts >> i & 1u) == 0) return true;
  const Vec<3>& own = core.normals[0];
  const Vec<3>& from = core.vertices[i];
  const Vec<3>& to = core.vertices[i < 2 ? i + 1 : 0];
  const Vec<3> edge = normalized_or(to - from, Vec<3>::zero());
  const Vec<3> neighbour = normalized_or(cross(from - to, core.vertices[3 + i] - to), own);
  // Over a convex edge the normal may turn as far as the neighbour's, over a concave one not.
  const float corner = dot(cross(own, neighbour), edge);
  const float left = dot(cross(normal, neighbour), edge);
  return corner > 0.0f && left >= -kSlack;
}

/// A normal that leans over an edge or a corner must be allowed by each neighbour it leans over:
/// a direction in the plane is one of the corner between whose edges' outward directions it lies.
bool allows(const Core<3>& core, const Vec<3>& normal) {
  if (!core.one_sided()) return true;
  constexpr float kSlack = 1.0e-3f;
  const Vec<3>& own = core.normals[0];
  const float rise = dot(normal, own);
  if (rise < 0.0f) return false;
  const Vec<3> lean = normal - rise * own;
  if (dot(lean, lean) <= kSlack * kSlack) return true;
  Vec<3> outwards[3];
  for (std::uint32_t i = 0; i < 3; ++i) {
    const Vec<3> edge = core.vertices[i < 2 ? i + 1 : 0] - core.vertices[i];
    outwards[i] = normalized_or(cross(edge, own), Vec<3>::zero());
  }
  for (std::uint32_t i = 0; i < 3; ++i) {
    const std::uint32_t before = i > 0 ? i - 1 : 2;
    const float from_before = dot(own, cross(outwards[before], lean));
    const float to_next = dot(own, cross(lean, outwards[i]));
    if (from_before < 0.0f || to_next < 0.0f) continue;
    if (to_next > kSlack && !allows_across(core, before, normal)) return false;
    if (from_before > kSlack && !allows_across(core, i, normal)) return false;
  }
  return true;
}

}  // namespace cycloid::solver
