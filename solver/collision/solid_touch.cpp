#include "solver/collision/segments.hpp"
#include "solver/collision/solid_clip.hpp"

namespace cycloid::solver {

/// The corner of the other solid that is deepest below the reference face.
static std::uint32_t deepest_corner(const FacePair& pair) {
  const Vec<3> normal = pair.reference.normals[pair.reference_face];
  std::uint32_t deepest = 0;
  float lowest = dot(normal, pair.incident.vertices[0]);
  for (std::uint32_t i = 1; i < pair.incident.vertex_count; ++i) {
    const float height = dot(normal, pair.incident.vertices[i]);
    if (height >= lowest) continue;
    lowest = height;
    deepest = i;
  }
  return deepest;
}

bool faces_point(const Solid& solid, std::uint32_t face, const Vec<3>& point) {
  const std::uint32_t first = solid.faces[face].edge;
  std::uint32_t edge = first;
  do {
    const Vec<3> from = solid.vertices[solid.edges[edge].origin];
    const Vec<3> along = solid.vertices[end_of(solid, edge)] - from;
    if (dot(cross(along, solid.normals[face]), point - from) > 0.0f) return false;
    edge = solid.edges[edge].next;
  } while (edge != first);
  return true;
}

/// Adds what is nearest as seen along `normal`, from a to b.
static void add_nearest(const Nearest& nearest, const Vec<3>& normal, float margin,
                        Clipped& clipped) {
  for (std::uint32_t i = 0; i < nearest.count; ++i) {
    const Vec<3> between = nearest.on_b[i] - nearest.on_a[i];
    const float separation = dot(normal, between);
    if (separation > margin) continue;
    clipped.candidates[clipped.count++] = {nearest.on_a[i] + 0.5f * between, separation,
                                           nearest.feature[i]};
  }
}

static Manifold<3> touch_nearest(const Solid& a, const Solid& b, const Nearest& nearest,
                                 const AxisTolerance& tolerance, float margin) {
  Clipped clipped;
  clipped.count = 0;
  clipped.lowest = 1.0e30f;
  if (nearest.of_face)
    clip_faces(opposed_to(a, b, nearest.face, nearest.on_b_face, nearest.separation), margin,
               clipped);
  if (clipped.count == 0 || clipped.lowest > nearest.separation + tolerance.face)
    add_nearest(nearest, nearest.normal, margin, clipped);
  Manifold<3> manifold;
  manifold.normal = nearest.normal;
  reduce(std::span(clipped.candidates).first(clipped.count), manifold);
  return manifold;
}

/// As touch_faces where what is clipped is not as deep as the axis says. Not inlined, as it is
/// rare.
[[gnu::noinline]] static Manifold<3> touch_beside(const FacePair& pair,
                                                  const AxisTolerance& tolerance, float margin,
                                                  Clipped& clipped) {
  const Vec<3> outwards = pair.reference.normals[pair.reference_face];
  Manifold<3> manifold;
  manifold.normal = pair.on_b ? -outwards : outwards;
  const std::uint32_t corner = deepest_corner(pair);
  const Vec<3> at = pair.incident.vertices[corner];
  if (faces_point(pair.reference, pair.reference_face, at)) {
    clipped.candidates[clipped.count++] = {
        at - (0.5f * pair.separation) * outwards, pair.separation,
        clip_feature(pair.on_b, pair.reference_face, corner, kCorner)};
  } else {
    const Solid& a = pair.on_b ? pair.incident : pair.reference;
    const Solid& b = pair.on_b ? pair.reference : pair.incident;
    Nearest nearest;
    if (!nearest_of(a, b, tolerance.slack(), margin, nearest)) return {};
    if (clipped.count == 0 || clipped.lowest > nearest.separation + tolerance.face) {
      const float aside = length(cross(manifold.normal, nearest.normal)) * abs(nearest.separation);
      if (clipped.count == 0 || aside > tolerance.edge)
        return touch_nearest(a, b, nearest, tolerance, margin);
      add_nearest(nearest, manifold.normal, margin, clipped);
    }
  }
  reduce(std::span(clipped.candidates).first(clipped.count), manifold);
  return manifold;
}

Manifold<3> touch_faces(const FacePair& pair, const AxisTolerance& tolerance, float margin) {
  Clipped clipped;
  clip_faces(pair, margin, clipped);
  if (clipped.lowest > pair.separation + tolerance.face)
    return touch_beside(pair, tolerance, margin, clipped);
  const Vec<3> outwards = pair.reference.normals[pair.reference_face];
  Manifold<3> manifold;
  manifold.normal = pair.on_b ? -outwards : outwards;
  reduce(std::span(clipped.candidates).first(clipped.count), manifold);
  return manifold;
}

Manifold<3> touch_edges(const EdgePair& pair, const AxisTolerance& tolerance, float margin) {
  const Solid& a = pair.a;
  const Solid& b = pair.b;
  const SegmentPair points =
      nearest_points(a.vertices[a.edges[pair.edge_a].origin], a.vertices[end_of(a, pair.edge_a)],
                     b.vertices[b.edges[pair.edge_b].origin], b.vertices[end_of(b, pair.edge_b)]);
  const Vec<3> between = points.on_b - points.on_a;
  // Where the nearest points do not lie within the edges, others are nearer or deeper.
  if (length(between - pair.separation * pair.normal) > 1.0e-4f) {
    Nearest nearest;
    if (!nearest_of(a, b, tolerance.slack(), margin, nearest)) return {};
    return touch_nearest(a, b, nearest, tolerance, margin);
  }
  Manifold<3> manifold;
  manifold.normal = pair.normal;
  add_point(points.on_a + 0.5f * between, pair.separation, edge_feature(pair.edge_a, pair.edge_b),
            manifold);
  return manifold;
}

}  // namespace cycloid::solver
