#pragma once

#include "solver/collision/solid.hpp"

namespace cycloid::solver {

/// By how much [m] a later axis has to beat the best one before it, so that shapes at rest do not
/// flip between features from tick to tick: a face another face, or an edge pair another; and an
/// edge pair the best face. Parts of the shapes' size, and bounded for large ones.
struct AxisTolerance {
  float face;
  float edge;

  /// @param size  of the smaller solid, m: for a box its least half extent.
  explicit AxisTolerance(float size)
      : face(min(5.0e-4f, 5.0e-3f * size)), edge(min(2.0e-3f, 2.0e-2f * size)) {}

  /// The separation that a face, or an edge pair after an edge pair, has to exceed.
  float beyond(float best) const { return best + face + 1.0e-3f * abs(best); }
  /// The separation that the first edge pair has to exceed.
  float beyond_faces(float best) const { return best + edge + 2.0e-2f * abs(best); }
};

/// Lower than any separation, and finite with a tolerance added.
inline constexpr float kNoSeparation = -1.0e30f;

/// A face of one solid that the most opposed face of the other is clipped to.
struct FacePair {
  const Solid& reference;
  const Solid& incident;
  std::uint32_t reference_face;
  std::uint32_t incident_face;
  bool on_b;         ///< The reference is solid b.
  float separation;  ///< Of the solids along the reference face's normal, m.
};

/// Two crossing edges, as half-edges of a and b.
struct EdgePair {
  const Solid& a;
  const Solid& b;
  std::uint32_t edge_a;
  std::uint32_t edge_b;
  Vec<3> normal;     ///< From a to b, unit.
  float separation;  ///< Of the solids along it, m.
};

/// The corner to which a half-edge leads.
inline std::uint32_t end_of(const Solid& solid, std::uint32_t edge) {
  return solid.edges[solid.edges[edge].twin].origin;
}

/// The face whose normal is most opposed to `normal`; of those within 1e-3 the lowest.
std::uint32_t opposed_face(const Solid& solid, const Vec<3>& normal);

/// The face of a, or of b, with the face of the other that is most opposed to it.
FacePair opposed_to(const Solid& a, const Solid& b, std::uint32_t face, bool on_b,
                    float separation);

/// The points nearest to each other on the segments from p0 to p1 and from q0 to q1, of positive
/// length; of parallel ones some such pair. Source: Ericson (2005), 5.1.9.
struct NearestPoints {
  Vec<3> p;
  Vec<3> q;
};
NearestPoints nearest_points(const Vec<3>& p0, const Vec<3>& p1, const Vec<3>& q0,
                             const Vec<3>& q1);

/// In place of a clip edge: the point is a corner of the incident solid, in place of its edge.
inline constexpr std::uint32_t kCorner = 0x3ffu;

/// A convex face of n corners cut by m planes has at most n + m.
inline constexpr std::size_t kClipMax = 2 * kHullVerticesMax;

struct Clipped {
  std::array<Candidate, kClipMax + 1> candidates;  ///< And room for one more.
  std::size_t count;
  float lowest;  ///< Separation of the nearest point, within the margin or not; 1e30: none, m.
};

/// Cuts the incident face by the planes through the reference face's edges, and keeps what is no
/// farther than `margin` along the normal. Corners that stick out by less than 0.5 mm (and less
/// than a hundredth of the edge) count as inside, so that flush boxes keep their corners.
/// Source: Sutherland and Hodgman (1974).
void clip_faces(const FacePair& pair, float margin, Clipped& clipped);

/// The manifold of a face: what is clipped. Where the solids overlap and that is not as deep as
/// they are, also the other's deepest corner; where they are apart and the nearest features are not
/// under the face, one point between those instead. Of solids apart, no separation exceeds their
/// distance by more than the tolerance of edges.
Manifold<3> touch_faces(const FacePair& pair, const AxisTolerance& tolerance, const Vec<3>& a_to_b,
                        float margin);

/// One point between the nearest points of the two edges.
Manifold<3> touch_edges(const EdgePair& pair, const Vec<3>& a_to_b, float margin);

/// The feature of a point between two edges, unlike any of `clip_feature`.
constexpr std::uint32_t edge_feature(std::uint32_t edge_a, std::uint32_t edge_b) {
  return 0x40000000u | (edge_a >> 1 << 10) | (edge_b >> 1);
}

}  // namespace cycloid::solver
