#include <bit>

#include "solver/collision/solid_clip.hpp"
#include "solver/lanes.hpp"

namespace cycloid::solver {

/// So many faces, corners or arcs are tried at once.
static constexpr int kWide = 4;
using WideLanes = Lanes<kWide>;

/// Vectors, kMost at the most, of which kWide are at hand from any place on: behind the last one
/// comes what is not looked at.
template <std::uint32_t kMost>
struct WideVectors {
  float part[3][kMost + kWide];

  Vec<3> at(std::uint32_t i) const { return {{part[0][i], part[1][i], part[2][i]}}; }
  void set(std::uint32_t i, const Vec<3>& v) {
    for (int k = 0; k < 3; ++k) part[k][i] = v[k];
  }
  WideLanes dot_at(std::uint32_t i, const Vec<3>& v) const {
    return WideLanes::load(&part[0][i]) * v[0] + WideLanes::load(&part[1][i]) * v[1] +
           WideLanes::load(&part[2][i]) * v[2];
  }
};

/// Bits of places from i on, as far as there are `count`.
static std::uint32_t bits_before(std::uint32_t bits, std::uint32_t i, std::uint32_t count) {
  return count - i < kWide ? bits & ((1u << (count - i)) - 1) : bits;
}

/// Of kWide numbers from `heights` on, those that are above `threshold`.
static std::uint32_t bits_above(const WideLanes& heights, float threshold) {
  return bits_of<kWide>(heights > WideLanes(threshold));
}

/// The faces of a solid as planes.
struct WidePlanes {
  explicit WidePlanes(const Solid& solid) : count(solid.face_count) {
    for (std::uint32_t face = 0; face < count; ++face) {
      normals.set(face, solid.normals[face]);
      offsets[face] = solid.offset(face);
    }
    for (std::uint32_t i = count; i < count + kWide; ++i) {
      normals.set(i, Vec<3>::zero());
      offsets[i] = 0.0f;
    }
  }

  WideLanes heights(std::uint32_t face, const Vec<3>& point) const {
    return normals.dot_at(face, point) - WideLanes::load(offsets + face);
  }
  /// The first face from this one on that a point is farther outside of than `threshold`.
  std::uint32_t first_below(std::uint32_t face, const Vec<3>& point, float threshold) const {
    for (; face < count; face += kWide) {
      const std::uint32_t bits =
          bits_before(bits_above(heights(face, point), threshold), face, count);
      if (bits != 0) return face + static_cast<std::uint32_t>(std::countr_zero(bits));
    }
    return count;
  }

  std::uint32_t count;
  WideVectors<kHullFacesMax> normals;
  float offsets[kHullFacesMax + kWide];
};

/// The corners of a solid, and how far they are outside of a face of another.
struct WideCorners {
  explicit WideCorners(const Solid& solid) : count(solid.vertex_count) {
    for (std::uint32_t i = 0; i < count + kWide; ++i)
      points.set(i, solid.vertices[i < count ? i : count - 1]);
  }

  /// Looks at the corners in order, up to the first one that is not above `threshold`. @returns its
  /// number, or `count` where all are; then `lowest` is the least height.
  std::uint32_t survey(const Vec<3>& normal, float offset, float threshold, float& lowest) {
    WideLanes least(3.4e38f);
    for (std::uint32_t i = 0; i < count; i += kWide) {
      const WideLanes height = points.dot_at(i, normal) - WideLanes(offset);
      const std::uint32_t bits = bits_before(~bits_above(height, threshold), i, count) & 0xfu;
      if (bits != 0) return i + static_cast<std::uint32_t>(std::countr_zero(bits));
      height.store(heights + i);
      least = min(least, height);
    }
    lowest = least.raw[0];
    for (int lane = 1; lane < kWide; ++lane) lowest = min(lowest, least.raw[lane]);
    return count;
  }
  /// The first corner of that height. @pre `survey` has found it.
  std::uint32_t first_at(float height) const {
    std::uint32_t i = 0;
    std::uint32_t bits = 0;
    for (; bits == 0; i += kWide)
      bits = bits_of<kWide>(WideLanes::load(heights + i) == WideLanes(height));
    return i - kWide + static_cast<std::uint32_t>(std::countr_zero(bits));
  }

  std::uint32_t count;
  WideVectors<kHullVerticesMax> points;
  float heights[kHullVerticesMax + kWide];
};

/// The face of a that b is farthest outside of. A face is given up at the first vertex of b that
/// shows that it cannot win; the vertex that was deepest last is tried first, of many faces at
/// once.
static FaceAxis best_face(const WidePlanes& a, const Solid& b, const AxisTolerance& tolerance,
                          float margin) {
  FaceAxis best;
  WideCorners corners(b);
  float threshold = kNoSeparation;
  std::uint32_t guess = 0;
  for (std::uint32_t face = a.first_below(0, b.vertices[guess], threshold); face < a.count;
       face = a.first_below(face + 1, b.vertices[guess], threshold)) {
    const Vec<3> normal = a.normals.at(face);
    const float offset = a.offsets[face];
    float lowest = 0.0f;
    const std::uint32_t loses = corners.survey(normal, offset, threshold, lowest);
    if (loses < corners.count) {
      guess = loses;
      continue;
    }
    // Of equals the guess stays, else the first one is it.
    if (dot(normal, b.vertices[guess]) - offset != lowest) guess = corners.first_at(lowest);
    best = {face, guess, lowest};
    if (lowest > margin) break;
    threshold = tolerance.beyond(lowest);
  }
  return best;
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
  std::uint8_t below[kHullFacesMax + kWide];
  for (std::uint32_t face = 0; face < planes.count; face += kWide) {
    const WideLanes level = WideLanes::load(planes.offsets + face) + limit;
    const std::uint32_t centre = bits_of<kWide>(planes.normals.dot_at(face, b.centre) > level);
    const std::uint32_t vertex =
        bits_of<kWide>(planes.normals.dot_at(face, b.vertices[support]) > level);
    for (std::uint32_t lane = 0; lane < kWide; ++lane)
      below[face + lane] =
          static_cast<std::uint8_t>((~centre >> lane & 1u) | (~vertex >> lane & 1u) << 1);
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
    const WideLanes from_b = arcs.from.dot_at(i, a.along);
    const WideLanes to_b = arcs.to.dot_at(i, a.along);
    const WideLanes from_a = arcs.along.dot_at(i, a.from);
    const WideLanes to_a = arcs.along.dot_at(i, a.to);
    max(max(from_b * to_b, from_a * to_a), from_b * to_a).store(crossing + i);
  }
}

/// Edges that are parallel within 1e-3 rad have no axis.
static constexpr float kParallelSquared = 1.0e-6f;

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
  axes.faces[0] = best_face(planes_a, b, tolerance, margin);
  if (axes.faces[0].separation > margin) return false;
  const WidePlanes planes_b(b);
  axes.faces[1] = best_face(planes_b, a, tolerance, margin);
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
