#include "solver/collision/solid.hpp"

#include <algorithm>

#include "solver/transpose.hpp"

namespace cycloid::solver {

/// Faces, edges and corners of a solid whose shape is known beforehand.
template <int V, int F, int E>
struct Topology {
  PolyhedronVertex vertices[V];
  PolyhedronFace faces[F];
  PolyhedronEdge edges[E];
};

/// From the corners of each face, counter-clockwise seen from outside. Half-edges come in the order
/// of the faces, each new one followed by its twin.
template <int V, int F, int E, int N>
static constexpr Topology<V, F, E> link(const std::uint32_t (&corners)[F][N]) {
  Topology<V, F, E> topology{};
  std::uint32_t ends[E] = {};
  std::uint32_t count = 0;
  std::uint32_t half_edge_of[F][N] = {};
  for (std::uint32_t f = 0; f < F; ++f)
    for (std::uint32_t k = 0; k < N; ++k) {
      const std::uint32_t from = corners[f][k];
      const std::uint32_t to = corners[f][(k + 1) % N];
      std::uint32_t e = 0;
      while (e < count && !(topology.edges[e].origin == from && ends[e] == to)) ++e;
      if (e == count) {
        topology.edges[e] = {from, e + 1, 0, 0};
        topology.edges[e + 1] = {to, e, 0, 0};
        ends[e] = to;
        ends[e + 1] = from;
        count += 2;
      }
      half_edge_of[f][k] = e;
      topology.edges[e].face = f;
    }
  for (std::uint32_t f = 0; f < F; ++f) {
    std::uint32_t lowest = half_edge_of[f][0];
    for (std::uint32_t k = 0; k < N; ++k) {
      topology.edges[half_edge_of[f][k]].next = half_edge_of[f][(k + 1) % N];
      if (half_edge_of[f][k] < lowest) lowest = half_edge_of[f][k];
    }
    topology.faces[f].edge = lowest;
  }
  for (std::uint32_t e = E; e-- > 0;) topology.vertices[topology.edges[e].origin].edge = e;
  return topology;
}

static constexpr std::uint32_t kBoxCorners[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                                    {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
static constexpr std::uint32_t kTriangleCorners[2][3] = {{0, 1, 2}, {0, 2, 1}};
static constexpr Topology<8, 6, 24> kBox = link<8, 6, 24>(kBoxCorners);
static constexpr Topology<3, 2, 6> kTriangle = link<3, 2, 6>(kTriangleCorners);

PolyhedronView box_topology() {
  return {kBox.vertices, kBox.faces, kBox.edges};
}
PolyhedronView triangle_topology() {
  return {kTriangle.vertices, kTriangle.faces, kTriangle.edges};
}

static void set_topology(const PolyhedronView& view, Solid& solid) {
  solid.vertex_count = static_cast<std::uint32_t>(view.vertices.size());
  solid.face_count = static_cast<std::uint32_t>(view.faces.size());
  solid.edge_count = static_cast<std::uint32_t>(view.edges.size());
  solid.faces = view.faces.data();
  solid.edges = view.edges.data();
}

static void place_box(const Shape<3>& shape, const Rotation<3>& rotation, Solid& solid) {
  set_topology(box_topology(), solid);
  const Rotation<3> turned = compose(rotation, shape.rotation);
  solid.half = shape.half;
  for (int k = 0; k < 3; ++k) {
    Vec<3> axis = Vec<3>::zero();
    axis[k] = 1.0f;
    solid.axes[k] = rotate(turned, axis);
    const auto face = static_cast<std::size_t>(2 * k);
    solid.normals[face] = -solid.axes[k];
    solid.normals[face + 1] = solid.axes[k];
  }
  const Vec<3> arm[3] = {shape.half[0] * solid.axes[0], shape.half[1] * solid.axes[1],
                         shape.half[2] * solid.axes[2]};
  for (std::uint32_t i = 0; i < 8; ++i) {
    Vec<3> vertex = solid.centre;
    for (int k = 0; k < 3; ++k) vertex = (i >> k & 1u) != 0 ? vertex + arm[k] : vertex - arm[k];
    solid.vertices[i] = vertex;
  }
}

/// Three floats of each record, from its beginning, moved four records at a time.
template <class Record, class Move>
static void move_all(std::span<const Record> records, Move&& move, Vec<3>* moved) {
  using Four = Lanes<4>;
  const std::size_t count = records.size();
  for (std::size_t i = 0; i < count; i += 4) {
    LaneIndices<4> from;  // Behind the last one it stands again.
    for (std::size_t lane = 0; lane < 4; ++lane)
      from[lane] = static_cast<std::uint32_t>(std::min(i + lane, count - 1));
    Four columns[4];
    gather_floats<4>(records.data(), from, 0, columns);
    const Vec<3, Four> at = move(Vec<3, Four>{{columns[0], columns[1], columns[2]}});
    Quad rows[4] = {at[0].raw, at[1].raw, at[2].raw, at[2].raw};
    transpose(rows);
    for (std::size_t lane = 0; lane < std::min<std::size_t>(4, count - i); ++lane)
      std::memcpy(&moved[i + lane], &rows[lane], sizeof(Vec<3>));
  }
}

static void place_hull(const Shape<3>& shape, const Polyhedra& polyhedra,
                       const Rotation<3>& rotation, Solid& solid) {
  using Four = Lanes<4>;
  const PolyhedronView view = view_of(polyhedra, shape.polyhedron);
  set_topology(view, solid);
  const Rotation<3> turned = compose(rotation, shape.rotation);
  const Rotation<3, Four> turn = {{turned[0], turned[1], turned[2], turned[3]}};
  const Vec<3, Four> centre = {{solid.centre[0], solid.centre[1], solid.centre[2]}};
  move_all(
      view.vertices, [&](const Vec<3, Four>& at) { return centre + rotate(turn, at); },
      solid.vertices.data());
  move_all(
      view.faces, [&](const Vec<3, Four>& normal) { return rotate(turn, normal); },
      solid.normals.data());
}

static void place_triangle(const Shape<3>& shape, const Rotation<3>& rotation,
                           const Vec<3>& position, Solid& solid) {
  set_topology(triangle_topology(), solid);
  solid.ghosts = shape.ghosts;
  for (std::size_t i = 0; i < 3; ++i) {
    solid.vertices[i] = position + rotate(rotation, shape.vertices[i]);
    solid.ghost_points[i] = position + rotate(rotation, shape.vertices[3 + i]);
  }
  solid.normals[0] = rotate(rotation, shape.normal);
  solid.normals[1] = -solid.normals[0];
  solid.centre = (1.0f / 3.0f) * (solid.vertices[0] + solid.vertices[1] + solid.vertices[2]);
}

void place(const Shape<3>& shape, const Polyhedra& polyhedra, const Rotation<3>& rotation,
           const Vec<3>& position, Solid& solid) {
  solid.kind = shape.kind;
  solid.ghosts = 0;
  if (shape.kind == ShapeKind::kTriangle) return place_triangle(shape, rotation, position, solid);
  solid.centre = position + rotate(rotation, shape.vertices[0]);
  if (shape.kind == ShapeKind::kBox) return place_box(shape, rotation, solid);
  place_hull(shape, polyhedra, rotation, solid);
}

}  // namespace cycloid::solver
