#pragma once

#include "solver/collision/solid_kernels.hpp"

namespace cycloid::solver {

/// By how much a later axis has to beat the best one before it, so that shapes at rest do not flip
/// between features from tick to tick: a face another face, or an edge pair another; and an edge
/// pair the best face. Parts of the shapes' size, and bounded for large ones, and parts of depth.
struct AxisTolerance {
  float face = 0.0f;  ///< m
  float edge = 0.0f;  ///< m
  float face_of_depth = 0.0f;
  float edge_of_depth = 0.0f;

  /// None: the best axis wins, of equal ones the first.
  AxisTolerance() = default;
  /// @param size  of the smaller solid, m: for a box its least half extent.
  explicit AxisTolerance(float size)
      : face(min(5.0e-4f, 5.0e-3f * size)),
        edge(min(2.0e-3f, 2.0e-2f * size)),
        face_of_depth(1.0e-3f),
        edge_of_depth(2.0e-2f) {}

  FaceTolerance of_faces() const { return {face, face_of_depth}; }
  /// How far points may be from where an exact axis says they are, m.
  float slack() const { return 0.2f * face; }
  /// The separation that a face, or an edge pair after an edge pair, has to exceed.
  float beyond(float best) const { return of_faces().beyond(best); }
  /// The separation that the first edge pair has to exceed.
  float beyond_faces(float best) const { return best + edge + edge_of_depth * max(-best, 0.0f); }
};

/// Edges that are parallel within 1e-3 rad have no axis across them: the square of their sine.
inline constexpr float kParallelSquared = 1.0e-6f;

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

/// A pair of edges as an axis. Without one the separation is kNoSeparation.
struct EdgeAxis {
  std::uint32_t edge_a = 0;
  std::uint32_t edge_b = 0;
  float separation = kNoSeparation;
  Vec<3> normal;
};

/// The best axes of two solids.
struct Axes {
  FaceAxis faces[2] = {{0, 0, kNoSeparation}, {0, 0, kNoSeparation}};  ///< Of a and of b.
  EdgeAxis edges;  ///< Only where it beats both faces.

  /// Whether the face of b is the better one.
  bool on_b(const AxisTolerance& tolerance) const {
    return faces[1].separation > tolerance.beyond(faces[0].separation);
  }
};

/// Axes in the order: faces of a, faces of b, edges of a across edges of b, a's first; a later one
/// has to be better by `tolerance`. @returns false where one separates by more than `margin`.
bool find_axes(const Solid& a, const Solid& b, const AxisTolerance& tolerance, float margin,
               Axes& axes);

/// The corner to which a half-edge leads.
inline std::uint32_t end_of(const Solid& solid, std::uint32_t edge) {
  return solid.edges[solid.edges[edge].twin].origin;
}

/// The face whose normal is most opposed to `normal`; of those within 1e-3 the lowest.
std::uint32_t opposed_face(const Solid& solid, const Vec<3>& normal);

/// The face of a, or of b, with the face of the other that is most opposed to it.
FacePair opposed_to(const Solid& a, const Solid& b, std::uint32_t face, bool on_b,
                    float separation);

/// A convex face of n corners cut by m planes has at most n + m.
inline constexpr std::size_t kClipMax = 2 * kHullVerticesMax;

struct Clipped {
  std::array<Candidate, kClipMax + 2> candidates;  ///< And room for two more.
  std::size_t count;
  float lowest;  ///< Separation of the nearest point, within the margin or not; 1e30: none, m.
};

/// Cuts the incident face by the planes through the reference face's edges, and keeps what is no
/// farther than `margin` along the normal. Corners that stick out by less than 0.5 mm (and less
/// than a hundredth of the edge) count as inside, so that flush boxes keep their corners.
/// Source: Sutherland and Hodgman (1974).
void clip_faces(const FacePair& pair, float margin, Clipped& clipped);

/// Whether a point is above or below a face, within its borders.
bool faces_point(const Solid& solid, std::uint32_t face, const Vec<3>& point);

/// Where two solids are nearest to each other, or deepest in each other.
struct Nearest {
  Vec<3> normal;        ///< From a to b, unit.
  float separation;     ///< Along it, m.
  std::uint32_t count;  ///< Of the points: two are the ends of what parallel edges share.
  Vec<3> on_a[2];
  Vec<3> on_b[2];
  std::uint32_t feature[2];
  bool of_face;        ///< The axis is that of a face:
  bool on_b_face;      ///< of b, or of a;
  std::uint32_t face;  ///< this one.
};

/// Prefers no axis. @param slack  how far [m] points may be from where the axis says they are: it
/// is larger for the wrong axes. @returns false where the solids are farther apart than `margin`.
bool nearest_of(const Solid& a, const Solid& b, float slack, float margin, Nearest& nearest);

/// The manifold of a face: what is clipped, and where that is not as deep as the solids are, also
/// where they are deepest. But where that is in quite another direction, or nothing is under the
/// face, the manifold of the nearest features instead.
Manifold<3> touch_faces(const FacePair& pair, const AxisTolerance& tolerance, float margin);

/// One point between the nearest points of the two edges; where these are not on the pair's axis,
/// the manifold of the nearest features.
Manifold<3> touch_edges(const EdgePair& pair, const AxisTolerance& tolerance, float margin);

/// The feature of a point between two edges, unlike any of `clip_feature`.
constexpr std::uint32_t edge_feature(std::uint32_t edge_a, std::uint32_t edge_b) {
  return kOfNoFace | (edge_a >> 1 << 10) | (edge_b >> 1);
}

}  // namespace cycloid::solver
