#pragma once

#include <vector>

#include "tests/oracle/vector.hpp"

namespace cycloid::oracle {

/// One edge of a convex polyhedron, and where its two faces go from it. A direction `d` at a right
/// angle to the edge has the edge as its farthest part exactly when it points away from both wings.
struct Edge {
  Vector origin;
  Vector direction;  ///< Unit.
  Vector wings[2];   ///< Unit, in the faces, across the edge; 0 for the edge of a bare segment.
};

/// A convex body: all that is within `radius` of the hull of its corners.
struct Convex {
  std::vector<Vector> corners;
  double radius = 0.0;
  std::vector<Vector>
      normals;  ///< Of the faces of the hull, unit, outwards; a plane piece has two.
  std::vector<Edge> edges;

  /// Of the farthest corner from the origin, with the radius.
  double extent() const;
};

/// The hull of any points, rounded. Inner points do no harm. One point is a ball, two a capsule,
/// three a triangle. Faces are found by trying the plane of every three points: O(n^4).
Convex hull_of(const std::vector<Vector>& points, double radius = 0.0);
Convex box_of(const Vector& half);
Convex ball_of(double radius);
/// From (0, -half_length, 0) to (0, half_length, 0).
Convex capsule_of(double half_length, double radius);

/// The same body somewhere else.
Convex placed(const Convex& body, const Placement& placement);

}  // namespace cycloid::oracle
