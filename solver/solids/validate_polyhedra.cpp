#include "solver/solids/validate_polyhedra.hpp"

#include "solver/validate.hpp"

namespace cycloid::solver {

static Error corrupt(std::size_t index) {
  return {Code::kCorrupt, "polyhedron", static_cast<int>(index)};
}

static bool counts_fit(const Polyhedron& record) {
  return record.vertex_count >= 4 && record.vertex_count <= kHullVerticesMax &&
         record.face_count >= 4 && record.face_count <= kHullFacesMax &&
         record.edge_count <= kHullEdgesMax && record.edge_count % 2 == 0 &&
         record.vertex_count + record.face_count == record.edge_count / 2 + 2;
}

static bool is_zero(const Polyhedron& record) {
  return record.references == 0 && record.first_vertex == 0 && record.vertex_count == 0 &&
         record.first_face == 0 && record.face_count == 0 && record.first_edge == 0 &&
         record.edge_count == 0;
}

/// Every index in range, twins mutual, and each half-edge followed by one that starts where it ends
/// on the same face.
static bool links_fit(const PolyhedronView& hull) {
  const std::size_t count = hull.edges.size();
  for (std::uint32_t e = 0; e < count; ++e) {
    const PolyhedronEdge& edge = hull.edges[e];
    if (edge.twin != (e ^ 1u) || edge.next >= count) return false;
    if (edge.origin >= hull.vertices.size() || edge.face >= hull.faces.size()) return false;
  }
  for (const PolyhedronEdge& edge : hull.edges) {
    const PolyhedronEdge& next = hull.edges[edge.next];
    const PolyhedronEdge& twin = hull.edges[edge.twin];
    if (next.face != edge.face || next.origin != twin.origin) return false;
    if (twin.origin == edge.origin || twin.face == edge.face) return false;
  }
  return true;
}

/// Faces and corners name the lowest of their half-edges.
static bool names_lowest(const PolyhedronView& hull) {
  std::vector<std::uint32_t> of_vertex(hull.vertices.size(), kNone);
  std::vector<std::uint32_t> of_face(hull.faces.size(), kNone);
  for (std::size_t e = hull.edges.size(); e-- > 0;) {
    of_vertex[hull.edges[e].origin] = static_cast<std::uint32_t>(e);
    of_face[hull.edges[e].face] = static_cast<std::uint32_t>(e);
  }
  for (std::size_t v = 0; v < of_vertex.size(); ++v)
    if (of_vertex[v] == kNone || of_vertex[v] != hull.vertices[v].edge) return false;
  for (std::size_t f = 0; f < of_face.size(); ++f)
    if (of_face[f] == kNone || of_face[f] != hull.faces[f].edge) return false;
  return true;
}

/// One loop of three or more half-edges per face, and all half-edges in them.
static bool loops_close(const PolyhedronView& hull) {
  std::size_t walked = 0;
  for (const PolyhedronFace& face : hull.faces) {
    std::size_t sides = 0;
    std::uint32_t edge = face.edge;
    do {
      edge = hull.edges[edge].next;
      ++sides;
    } while (edge != face.edge && sides <= hull.edges.size());
    if (sides < 3 || edge != face.edge) return false;
    walked += sides;
  }
  return walked == hull.edges.size();
}

/// No corner outside of a face, and those of a face on it.
static bool is_convex(const PolyhedronView& hull) {
  float size = 0.0f;
  for (const PolyhedronVertex& vertex : hull.vertices) {
    if (!within(vertex.position, 2.0f * kSizeMax)) return false;
    size = max(size, length(vertex.position));
  }
  const float rounding = 1.0e-4f * size;
  for (const PolyhedronFace& face : hull.faces) {
    if (!within(dot(face.normal, face.normal), 0.999f, 1.001f)) return false;
    if (!within(face.offset, -4.0f * kSizeMax, 4.0f * kSizeMax)) return false;
    for (const PolyhedronVertex& vertex : hull.vertices)
      if (!(dot(face.normal, vertex.position) <= face.offset + rounding)) return false;
  }
  for (const PolyhedronEdge& edge : hull.edges) {
    const PolyhedronFace& face = hull.faces[edge.face];
    const Vec<3>& corner = hull.vertices[edge.origin].position;
    if (!(dot(face.normal, corner) >= face.offset - rounding)) return false;
  }
  return true;
}

/// Marks a range; false where it leaves the pool or meets another.
static bool take_range(std::uint32_t first, std::uint32_t count, std::vector<bool>& taken) {
  if (first > taken.size() || count > taken.size() - first) return false;
  for (std::uint32_t i = first; i < first + count; ++i) {
    if (taken[i]) return false;
    taken[i] = true;
  }
  return true;
}

static bool is_covered(const std::vector<bool>& taken) {
  for (const bool one : taken)
    if (!one) return false;
  return true;
}

/// The pools hold the hulls in the same order: where a hull starts among the vertices tells how
/// many faces and half-edges come before it.
static bool is_ordered(const Polyhedra& polyhedra) {
  std::vector<std::uint32_t> slot_at(polyhedra.vertices.size(), kNone);
  for (std::uint32_t slot = 0; slot < polyhedra.records.size(); ++slot)
    if (polyhedra.records[slot].references > 0)
      slot_at[polyhedra.records[slot].first_vertex] = slot;
  std::uint32_t faces = 0;
  std::uint32_t edges = 0;
  for (const std::uint32_t slot : slot_at) {
    if (slot == kNone) continue;
    const Polyhedron& record = polyhedra.records[slot];
    if (record.first_face != faces || record.first_edge != edges) return false;
    faces += record.face_count;
    edges += record.edge_count;
  }
  return true;
}

Error validate_polyhedra(const WorldState<2>& state) {
  const Polyhedra& all = state.polyhedra;
  const bool none =
      all.records.empty() && all.vertices.empty() && all.faces.empty() && all.edges.empty();
  return none ? Error{} : corrupt(0);
}

Error validate_polyhedra(const WorldState<3>& state) {
  const Polyhedra& all = state.polyhedra;
  std::vector<std::uint32_t> references(all.records.size(), 0);
  for (const Shape<3>& shape : state.shapes) {
    if (shape.kind != ShapeKind::kHull) continue;
    if (shape.polyhedron >= all.records.size()) return corrupt(0);
    ++references[shape.polyhedron];
  }
  std::vector<bool> vertices(all.vertices.size(), false);
  std::vector<bool> faces(all.faces.size(), false);
  std::vector<bool> edges(all.edges.size(), false);
  for (std::uint32_t slot = 0; slot < all.records.size(); ++slot) {
    const Polyhedron& record = all.records[slot];
    if (record.references != references[slot]) return corrupt(slot);
    if (record.references == 0) {
      if (!is_zero(record)) return corrupt(slot);
      continue;
    }
    if (!counts_fit(record) || !take_range(record.first_vertex, record.vertex_count, vertices) ||
        !take_range(record.first_face, record.face_count, faces) ||
        !take_range(record.first_edge, record.edge_count, edges))
      return corrupt(slot);
    const PolyhedronView hull = view_of(all, slot);
    if (!links_fit(hull) || !names_lowest(hull) || !loops_close(hull) || !is_convex(hull))
      return corrupt(slot);
  }
  if (!is_covered(vertices) || !is_covered(faces) || !is_covered(edges) || !is_ordered(all))
    return corrupt(0);
  return {};
}

}  // namespace cycloid::solver
