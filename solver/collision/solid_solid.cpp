#include "solver/collision/solid_clip.hpp"
#include "solver/lane_widths.hpp"

namespace cycloid::solver {

/// So many faces or arcs are tried at once.
static constexpr int kWide = 4;
using WideLanes = Lanes<kWide>;

/// The dot products with a vector of kWide others, from `i` on.
template <std::uint32_t kMost>
static WideLanes dots_at(const WideVectors<kMost>& vectors, std::uint32_t i, const Vec<3>& with) {
  return WideLanes::load(&vectors.part[0][i]) * with[0] +
         WideLanes::load(&vectors.part[1][i]) * with[1] +
         WideLanes::load(&vectors.part[2][i]) * with[2];
}

static void find_best_face(const WidePlanes& a, const Solid& b, const AxisTolerance& tolerance,
                           float margin, FaceAxis& best) {
  const Vec<3>* corners = b.vertices.data();
  at_widest([&]<int W>() {
    SolidKernels<W>::best_face(a, corners, b.vertex_count, tolerance.of_faces(), margin, best);
  });
}

/// Even half-edges, in their order.
struct Edges {
  std::uint32_t index[kHullEdgesMax / 2];
  std::uint32_t count = 0;
};

/// The edges of a that may give an axis with a separation above `threshold`. Every axis of an edge
/// lies between the normals of its faces, so a point of b below both of them by -threshold tells
/// that none does; the points tried are b's centre and `support`.
static void promising_edges(const Solid& a, const WidePlanes& planes, const Solid& b,
                            std::uint32_t support, float threshold, Edges& edges) {
  const WideLanes limit(min(threshold, 0.0f));
  std::int32_t below[in_whole_lanes(kHullFacesMax)];  // Bit 0: the centre; bit 1: the support.
  for (std::uint32_t face = 0; face < planes.count; face += kWide) {
    const WideLanes level = WideLanes::load(planes.offsets + face) + limit;
    const auto above_centre = dots_at(planes.normals, face, b.centre) > level;
    const auto above_support = dots_at(planes.normals, face, b.vertices[support]) > level;
    const WideLanes::Mask bits = (~above_centre & 1) | (~above_support & 2);
    std::memcpy(below + face, &bits, sizeof bits);
  }
  for (std::uint32_t e = 0; e < a.edge_count; e += 2)
    if ((below[a.edges[e].face] & below[a.edges[e + 1].face]) == 0) edges.index[edges.count++] = e;
}

/// An edge as an arc between the normals of its faces.
struct Arc {
  Vec<3> from;
  Vec<3> to;
  Vec<3> along;  ///< The edge, m: along cross(from, to).
  Vec<3> origin;
};
static Arc arc_of(const Solid& solid, std::uint32_t edge) {
  const PolyhedronEdge& half = solid.edges[edge];
  const PolyhedronEdge& twin = solid.edges[edge + 1];
  const Vec<3> origin = solid.vertices[half.origin];
  return {solid.normals[half.face], solid.normals[twin.face], solid.vertices[twin.origin] - origin,
          origin};
}

/// Many arcs, kWide of which are tried at once.
struct Arcs {
  WideVectors<kHullEdgesMax / 2> from;
  WideVectors<kHullEdgesMax / 2> to;
  WideVectors<kHullEdgesMax / 2> along;
};
static void set_arcs(const Solid& solid, const Edges& edges, Arcs& arcs) {
  for (std::uint32_t i = 0; i < edges.count + kWide; ++i) {
    const Vec<3> none = Vec<3>::zero();
    const Arc arc = i < edges.count ? arc_of(solid, edges.index[i]) : Arc{none, none, none, none};
    arcs.from.set(i, arc.from);
    arcs.to.set(i, arc.to);
    arcs.along.set(i, arc.along);
  }
}

/// Below zero for each arc that, turned round, crosses that of a: whose edge makes a face of the
/// Minkowski difference with the edge of a.
static void try_arcs(const Arc& a, const Arcs& arcs, std::uint32_t count, float* crossing) {
  for (std::uint32_t i = 0; i < count; i += kWide) {
    const WideLanes from_b = dots_at(arcs.from, i, a.along);
    const WideLanes to_b = dots_at(arcs.to, i, a.along);
    const WideLanes from_a = dots_at(arcs.along, i, a.from);
    const WideLanes to_a = dots_at(arcs.along, i, a.to);
    max(max(from_b * to_b, from_a * to_a), from_b * to_a).store(crossing + i);
  }
}

/// The first edge pair that exceeds `threshold`, and of later ones what is better beyond tolerance.
static EdgeAxis best_edges(const Solid& a, const Edges& edges_a, const Solid& b,
                           const Edges& edges_b, const AxisTolerance& tolerance, float threshold) {
  EdgeAxis best;
  if (edges_a.count == 0 || edges_b.count == 0) return best;
  Arcs arcs;
  float crossing[kHullEdgesMax / 2 + kWide];
  set_arcs(b, edges_b, arcs);
  for (std::uint32_t i = 0; i < edges_a.count; ++i) {
    const Arc arc_a = arc_of(a, edges_a.index[i]);
    const Vec<3> middle = arc_a.from + arc_a.to;
    try_arcs(arc_a, arcs, edges_b.count, crossing);
    for (std::uint32_t j = 0; j < edges_b.count; ++j) {
      if (!(crossing[j] < 0.0f)) continue;
      const Arc arc_b = arc_of(b, edges_b.index[j]);
      Vec<3> across = cross(arc_a.along, arc_b.along);
      const float squared = dot(across, across);
      const float parallel =
          kParallelSquared * dot(arc_a.along, arc_a.along) * dot(arc_b.along, arc_b.along);
      if (squared <= parallel) continue;
      if (dot(across, middle) < 0.0f) across = -across;
      const float size = sqrt(squared);
      const float scaled = dot(across, arc_b.origin - arc_a.origin);
      if (scaled <= threshold * size) continue;
      best = {edges_a.index[i], edges_b.index[j], scaled / size, (1.0f / size) * across};
      threshold = tolerance.beyond(best.separation);
    }
  }
  return best;
}

/// A length that does not change as the solid turns.
static float size_of(const Solid& solid) {
  if (solid.kind == ShapeKind::kBox) return min(min(solid.half[0], solid.half[1]), solid.half[2]);
  return length(solid.vertices[0] - solid.centre);
}

bool find_axes(const Solid& a, const Solid& b, const AxisTolerance& tolerance, float margin,
               Axes& axes) {
  const WidePlanes planes_a(a);
  find_best_face(planes_a, b, tolerance, margin, axes.faces[0]);
  if (axes.faces[0].separation > margin) return false;
  const WidePlanes planes_b(b);
  find_best_face(planes_b, a, tolerance, margin, axes.faces[1]);
  if (axes.faces[1].separation > margin) return false;
  const FaceAxis& face = axes.faces[axes.on_b(tolerance) ? 1 : 0];
  const float threshold = tolerance.beyond_faces(face.separation);
  Edges edges_a;
  Edges edges_b;
  promising_edges(a, planes_a, b, axes.faces[0].support, threshold, edges_a);
  if (edges_a.count > 0) promising_edges(b, planes_b, a, axes.faces[1].support, threshold, edges_b);
  axes.edges = best_edges(a, edges_a, b, edges_b, tolerance, threshold);
  return axes.edges.separation <= margin;
}

/// Source: Gregorius, "The Separating Axis Test between Convex Polyhedra" (GDC 2013).
Manifold<3> solid_against_solid(const Solid& a, const Solid& b, float margin) {
  const AxisTolerance tolerance(min(size_of(a), size_of(b)));
  Axes axes;
  if (!find_axes(a, b, tolerance, margin, axes)) return {};
  const EdgeAxis& edges = axes.edges;
  if (edges.separation > kNoSeparation)
    return touch_edges({a, b, edges.edge_a, edges.edge_b, edges.normal, edges.separation},
                       tolerance, margin);
  const bool on_b = axes.on_b(tolerance);
  const FaceAxis& face = axes.faces[on_b ? 1 : 0];
  return touch_faces(opposed_to(a, b, face.face, on_b, face.separation), tolerance, margin);
}

}  // namespace cycloid::solver
