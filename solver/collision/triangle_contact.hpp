#pragma once

#include "solver/collision/solid.hpp"

namespace cycloid::solver {

/// Which features of a triangle and a solid meet: the triangle's face, a face of the solid, or an
/// edge of each; and what is known of the axes that could not be taken.
struct Contacting {
  enum Kind { kOwnFace, kSolidFace, kEdges } kind = kOwnFace;
  Vec<3> normal;  ///< From the triangle to the solid.
  float separation = 0.0f;
  std::uint32_t face = 0;
  std::uint32_t triangle_edge = 0;
  std::uint32_t solid_edge = 0;
  std::uint32_t lowest = 0;  ///< The solid's corner that is lowest over the triangle.
  float refused = -3.0e38f;  ///< Along the best axis that is a neighbour's, m.
  float flat = -3.0e38f;     ///< Along the best axis over an edge that is not convex, m.
  float upright = -3.0e38f;  ///< Along the best axis that the triangle's normal stands for, m.

  /// Along the best axis that cannot be taken, m.
  float elsewhere() const { return max(refused, flat); }
};

/// How differences of separations are judged, m.
struct Judgement {
  bool strict;      ///< The axis has been taken for the least difference, however upright it is.
  float preferred;  ///< Differences below this do not count.
};

/// A manifold, and whether it is as deep, or as near, as the axis says, or has to be so.
struct TriangleContact {
  Manifold<3> manifold;
  bool complete;
};

/// The manifold of the features: what is clipped, and of solids that overlap also the corner that
/// is deepest, where the clipped face does not have it; two edges meet in one point. Of solids
/// apart whose nearest features are others it is one point between those, where the surface allows
/// the line between them as a normal.
TriangleContact triangle_contact(const Solid& triangle, const Solid& solid, const Contacting& best,
                                 const Judgement& judgement, float margin);

}  // namespace cycloid::solver
