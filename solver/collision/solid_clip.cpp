#include "solver/collision/solid_clip.hpp"

#include <utility>

namespace cycloid::solver {

/// Marks an edge of the reference face where one of the incident face is meant.
static constexpr std::uint32_t kCut = 0x200u;

struct ClipVertex {
  Vec<3> at;
  std::uint32_t feature;  ///< Lower 20 bits of a clip_feature.
  std::uint32_t edge;     ///< To the next vertex: an incident edge, or kCut and a clip edge.
};

struct ClippedPolygon {
  ClipVertex vertices[kClipMax];
  std::size_t count;

  void add(const ClipVertex& vertex) {
    if (count < kClipMax) vertices[count++] = vertex;
  }
};

struct ClipPlane {
  Vec<3> normal;  ///< Outwards, as long as the edge.
  Vec<3> origin;
  float slop;  ///< m, times the length of the normal.
  std::uint32_t edge;
};

static ClipVertex crossing(const ClipVertex& from, const ClipVertex& to, float fraction,
                           std::uint32_t clip_edge, std::uint32_t onward) {
  return {from.at + fraction * (to.at - from.at), clip_feature(false, 0, from.edge, clip_edge),
          onward};
}

/// @return whether anything was cut; otherwise `out` is untouched and `in` stands.
static bool cut(const ClippedPolygon& in, const ClipPlane& plane, ClippedPolygon& out) {
  float height[kClipMax];
  bool sticks_out = false;
  for (std::size_t i = 0; i < in.count; ++i) {
    height[i] = dot(plane.normal, in.vertices[i].at - plane.origin);
    sticks_out |= height[i] > plane.slop;
  }
  if (!sticks_out) return false;
  out.count = 0;
  for (std::size_t i = 0; i < in.count; ++i) {
    const std::size_t j = i + 1 < in.count ? i + 1 : 0;
    const ClipVertex& vertex = in.vertices[i];
    const bool inside = height[i] <= plane.slop;
    const bool next_inside = height[j] <= plane.slop;
    // A vertex within the slop stands for the crossing next to it.
    const bool leaves_here = inside && !next_inside && height[i] >= 0.0f;
    if (inside) out.add(vertex);
    if (leaves_here) out.vertices[out.count - 1].edge = kCut | plane.edge;
    if (inside == next_inside || leaves_here || (next_inside && height[j] >= 0.0f)) continue;
    const float fraction = height[i] / (height[i] - height[j]);
    out.add(crossing(vertex, in.vertices[j], fraction, plane.edge,
                     inside ? kCut | plane.edge : vertex.edge));
  }
  return true;
}

static void start(const Solid& solid, std::uint32_t face, ClippedPolygon& polygon) {
  polygon.count = 0;
  const std::uint32_t first = solid.faces[face].edge;
  std::uint32_t edge = first;
  do {
    const std::uint32_t corner = solid.edges[edge].origin;
    polygon.add({solid.vertices[corner], clip_feature(false, 0, corner, kCorner), edge >> 1});
    edge = solid.edges[edge].next;
  } while (edge != first);
}

std::uint32_t opposed_face(const Solid& solid, const Vec<3>& normal) {
  std::uint32_t best = 0;
  float threshold = 2.0f;
  for (std::uint32_t i = 0; i < solid.face_count; ++i) {
    const float along = dot(solid.normals[i], normal);
    if (along >= threshold) continue;
    best = i;
    threshold = along - 1.0e-3f;
  }
  return best;
}

FacePair opposed_to(const Solid& a, const Solid& b, std::uint32_t face, bool on_b,
                    float separation) {
  const Solid& reference = on_b ? b : a;
  const Solid& incident = on_b ? a : b;
  return {reference, incident,  face, opposed_face(incident, reference.normals[face]),
          on_b,      separation};
}

/// How much of the slop a face's corner bears: a point within the slop of both sides of a sharp
/// corner may be far from it. shares[i]: of the corner where edge i of the face starts; one more
/// for the end of the last.
[[gnu::noinline]] static void share_slop(const Solid& solid, std::uint32_t face, float* shares) {
  const std::uint32_t first = solid.faces[face].edge;
  const Vec<3>* corner = &solid.vertices[solid.edges[first].origin];
  std::uint32_t edge = solid.edges[first].next;
  Vec<3> before = solid.vertices[solid.edges[edge].origin] - *corner;
  for (std::uint32_t i = 1;; ++i) {
    corner = &solid.vertices[solid.edges[edge].origin];
    const Vec<3> along = solid.vertices[end_of(solid, edge)] - *corner;
    float share = 1.0f;
    if (dot(before, along) < 0.0f)
      share = length(cross(before, along)) / sqrt(dot(before, before) * dot(along, along));
    shares[i] = share;
    if (edge == first) {
      shares[0] = share;
      return;
    }
    before = along;
    edge = solid.edges[edge].next;
  }
}

void clip_faces(const FacePair& pair, float margin, Clipped& clipped) {
  const Solid& reference = pair.reference;
  const Vec<3> normal = reference.normals[pair.reference_face];
  ClippedPolygon buffers[2];
  ClippedPolygon* polygon = &buffers[0];
  ClippedPolygon* spare = &buffers[1];
  start(pair.incident, pair.incident_face, *polygon);
  const std::uint32_t first = reference.faces[pair.reference_face].edge;
  std::uint32_t edge = first;
  const Vec<3> origin = reference.vertices[reference.edges[first].origin];
  Vec<3> from = origin;
  float shares[kHullVerticesMax + 1];
  const bool square = reference.kind == ShapeKind::kBox;
  if (!square) share_slop(reference, pair.reference_face, shares);
  std::uint32_t i = 0;
  do {
    const std::uint32_t next = reference.edges[edge].next;
    const Vec<3> to = reference.vertices[reference.edges[next].origin];
    const Vec<3> along = to - from;
    const float run = length(along);
    float slop = run * min(5.0e-4f, 1.0e-2f * run);
    if (!square) slop *= min(shares[i], shares[i + 1]);
    ++i;
    const ClipPlane plane = {cross(along, normal), from, slop, edge >> 1};
    if (cut(*polygon, plane, *spare)) std::swap(polygon, spare);
    from = to;
    edge = next;
  } while (edge != first);

  clipped.count = 0;
  clipped.lowest = 1.0e30f;
  const std::uint32_t face = clip_feature(pair.on_b, pair.reference_face, 0, 0);
  for (std::size_t k = 0; k < polygon->count; ++k) {
    const ClipVertex& vertex = polygon->vertices[k];
    const float separation = dot(normal, vertex.at - origin);
    clipped.lowest = min(clipped.lowest, separation);
    if (separation > margin) continue;
    clipped.candidates[clipped.count++] = {vertex.at - (0.5f * separation) * normal, separation,
                                           face | vertex.feature};
  }
}

}  // namespace cycloid::solver
