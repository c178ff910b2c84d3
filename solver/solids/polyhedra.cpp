#include "solver/solids/polyhedra.hpp"

#include <cstring>

namespace cycloid::solver {

// Equality of bits needs records without padding: visit.hpp asserts that there is none.
template <class T>
static bool has_equal_bits(std::span<const T> a, std::span<const T> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

static std::uint32_t first_free(const Polyhedra& polyhedra) {
  std::uint32_t slot = 0;
  while (slot < polyhedra.records.size() && polyhedra.records[slot].references > 0) ++slot;
  return slot;
}

template <class T>
static std::uint32_t append(std::span<const T> from, std::vector<T>& to) {
  const auto first = static_cast<std::uint32_t>(to.size());
  to.insert(to.end(), from.begin(), from.end());
  return first;
}

std::uint32_t intern(const PolyhedronView& hull, Polyhedra& polyhedra) {
  for (std::uint32_t slot = 0; slot < polyhedra.records.size(); ++slot) {
    if (polyhedra.records[slot].references == 0) continue;
    const PolyhedronView known = view_of(polyhedra, slot);
    if (!has_equal_bits(known.vertices, hull.vertices) ||
        !has_equal_bits(known.faces, hull.faces) || !has_equal_bits(known.edges, hull.edges))
      continue;
    ++polyhedra.records[slot].references;
    return slot;
  }
  const std::uint32_t slot = first_free(polyhedra);
  if (slot == polyhedra.records.size()) polyhedra.records.emplace_back();
  Polyhedron& record = polyhedra.records[slot];
  record.references = 1;
  record.first_vertex = append(hull.vertices, polyhedra.vertices);
  record.vertex_count = static_cast<std::uint32_t>(hull.vertices.size());
  record.first_face = append(hull.faces, polyhedra.faces);
  record.face_count = static_cast<std::uint32_t>(hull.faces.size());
  record.first_edge = append(hull.edges, polyhedra.edges);
  record.edge_count = static_cast<std::uint32_t>(hull.edges.size());
  return slot;
}

template <class T>
static void erase_range(std::uint32_t first, std::uint32_t count, std::vector<T>& from) {
  const auto begin = from.begin() + static_cast<std::ptrdiff_t>(first);
  from.erase(begin, begin + static_cast<std::ptrdiff_t>(count));
}

void release(std::uint32_t slot, Polyhedra& polyhedra) {
  const Polyhedron gone = polyhedra.records[slot];
  if (gone.references > 1) {
    --polyhedra.records[slot].references;
    return;
  }
  erase_range(gone.first_vertex, gone.vertex_count, polyhedra.vertices);
  erase_range(gone.first_face, gone.face_count, polyhedra.faces);
  erase_range(gone.first_edge, gone.edge_count, polyhedra.edges);
  polyhedra.records[slot] = Polyhedron{};
  // The three pools hold the hulls in the same order.
  for (Polyhedron& record : polyhedra.records) {
    if (record.first_vertex <= gone.first_vertex) continue;
    record.first_vertex -= gone.vertex_count;
    record.first_face -= gone.face_count;
    record.first_edge -= gone.edge_count;
  }
}

void adopt_hull(const Polyhedra&, Polyhedra&, Shape<2>&) {}
void adopt_hull(const Polyhedra& from, Polyhedra& to, Shape<3>& shape) {
  if (shape.kind == ShapeKind::kHull)
    shape.polyhedron = intern(view_of(from, shape.polyhedron), to);
}

void abandon_hull(const Shape<2>&, Polyhedra&) {}
void abandon_hull(const Shape<3>& shape, Polyhedra& polyhedra) {
  if (shape.kind == ShapeKind::kHull) release(shape.polyhedron, polyhedra);
}

}  // namespace cycloid::solver
