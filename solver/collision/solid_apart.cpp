#include "solver/collision/solid_apart.hpp"

#include "solver/collision/solid_kernels.hpp"
#include "solver/lane_widths.hpp"

namespace cycloid::solver {

/// A face may have to beat one before it by so much to become the axis (AxisTolerance), m.
static constexpr float kFaceToleranceMax = 5.0e-4f;
/// Numbers of the solids' own frames differ from placed ones by their roundings, some 1e-6 of the
/// lengths that meet in them.
static constexpr float kRounding = 2.0e-5f;

/// A box or hull in its own frame, whose origin is in the middle of it.
struct OwnSolid {
  const Shape<3>& shape;
  PolyhedronView view;   ///< Hull.
  Rotation<3> rotation;  ///< Into the frame of the collision.
};

/// A face as a plane: outside where dot(normal, x) > offset.
struct Plane {
  Vec<3> normal;
  float offset;
};

/// The face of a box that a point is farthest outside of.
static Plane box_face_towards(const Vec<3>& half, const Vec<3>& point) {
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (abs(point[k]) - half[k] > abs(point[axis]) - half[axis]) axis = k;
  Plane plane{Vec<3>::zero(), half[axis]};
  plane.normal[axis] = point[axis] < 0.0f ? -1.0f : 1.0f;
  return plane;
}

/// The face of a hull that a point is farthest outside of: of equals the first.
static Plane hull_face_towards(std::span<const PolyhedronFace> faces, const Vec<3>& point) {
  const auto count = static_cast<std::uint32_t>(faces.size());
  const std::uint32_t face =
      at_widest([&]<int W>() { return SolidKernels<W>::face_towards(faces.data(), count, point); });
  return {faces[face].normal, faces[face].offset};
}

static Plane face_towards(const OwnSolid& solid, const Vec<3>& point) {
  return solid.shape.kind == ShapeKind::kBox ? box_face_towards(solid.shape.half, point)
                                             : hull_face_towards(solid.view.faces, point);
}

/// How far the solid reaches against a direction of its frame, from its origin, m: above 0.
static float reach_against(const OwnSolid& solid, const Vec<3>& direction) {
  if (solid.shape.kind == ShapeKind::kBox) {
    float reach = 0.0f;
    for (int k = 0; k < 3; ++k) reach += abs(direction[k]) * solid.shape.half[k];
    return reach;
  }
  const auto count = static_cast<std::uint32_t>(solid.view.vertices.size());
  const PolyhedronVertex* corners = solid.view.vertices.data();
  return -at_widest(
      [&]<int W>() { return SolidKernels<W>::lowest_along(corners, count, direction); });
}

/// How far outside of a face of a all of b is, m, where its middle is farther than the margin.
/// @param to_b  from the middle of a to that of b, in the frame of the collision, m.
static float gap_beside_a(const OwnSolid& a, const OwnSolid& b, const Vec<3>& to_b, float margin) {
  const Vec<3> centre = rotate_back(a.rotation, to_b);
  const Plane plane = face_towards(a, centre);
  const float height = dot(plane.normal, centre) - plane.offset;
  if (height <= margin) return 0.0f;
  const Vec<3> normal = rotate_back(b.rotation, rotate(a.rotation, plane.normal));
  return height - reach_against(b, normal);
}

static OwnSolid own_solid(const Shape<3>& shape, const Rotation<3>& rotation,
                          const Polyhedra& polyhedra) {
  OwnSolid solid{shape, {}, compose(rotation, shape.rotation)};
  if (shape.kind == ShapeKind::kHull) solid.view = view_of(polyhedra, shape.polyhedron);
  return solid;
}

bool may_be_parted(const Shape<3>& a, const Shape<3>& b) {
  return a.kind == ShapeKind::kHull || b.kind == ShapeKind::kHull;
}

FaceGap gap_beside_a_face(const Shape<3>& a, const Shape<3>& b, const PlacedPair<3>& pair,
                          bool b_first, const Polyhedra& polyhedra, float margin) {
  const OwnSolid own_a = own_solid(a, pair.pose_a.rotation, polyhedra);
  const OwnSolid own_b = own_solid(b, pair.pose_b.rotation, polyhedra);
  const Vec<3> a_to_b = pair.pose_b.position - pair.pose_a.position;
  const Vec<3> from = rotate(pair.pose_a.rotation, a.vertices[0]);
  const Vec<3> to_b = a_to_b + rotate(pair.pose_b.rotation, b.vertices[0]) - from;
  const float lengths =
      length(a_to_b) + length(from) + length(a.half) + length(b.vertices[0]) + length(b.half);
  const float unsure = kFaceToleranceMax + kRounding * lengths;
  const auto ask = [&](bool of_b) {
    return of_b ? gap_beside_a(own_b, own_a, -to_b, margin + unsure)
                : gap_beside_a(own_a, own_b, to_b, margin + unsure);
  };
  if (const float gap = ask(b_first) - unsure; gap > margin) return {gap, b_first};
  return {ask(!b_first) - unsure, !b_first};
}

}  // namespace cycloid::solver
