#pragma once

#include "solver/collision/manifold.hpp"
#include "solver/state.hpp"

namespace cycloid::solver {

/// An axis-aligned box, m.
template <int D>
struct Bounds {
  Vec<D> lower;
  Vec<D> upper;

  friend bool overlaps(const Bounds& a, const Bounds& b) {
    for (int i = 0; i < D; ++i)
      if (a.lower[i] > b.upper[i] || b.lower[i] > a.upper[i]) return false;
    return true;
  }
  friend Bounds merged(Bounds a, const Bounds& b) {
    for (int i = 0; i < D; ++i) {
      a.lower[i] = min(a.lower[i], b.lower[i]);
      a.upper[i] = max(a.upper[i], b.upper[i]);
    }
    return a;
  }
};

/// How far a shape reaches beyond its vertices and radius along the axes of the world, m.
inline Vec<2> reach_of(const Shape<2>&, const Rotation<2>&) {
  return Vec<2>::zero();
}
inline Vec<3> reach_of(const Shape<3>& shape, const Rotation<3>& rotation) {
  Vec<3> reach = Vec<3>::zero();
  const bool boxed = shape.kind == ShapeKind::kBox || shape.kind == ShapeKind::kHull;
  if (!boxed) return reach;
  const Rotation<3> turned = compose(rotation, shape.rotation);
  for (int k = 0; k < 3; ++k) {
    Vec<3> axis = Vec<3>::zero();
    axis[k] = shape.half[k];
    axis = rotate(turned, axis);
    for (int i = 0; i < 3; ++i) reach[i] += abs(axis[i]);
  }
  return reach;
}

/// The box of a shape's vertices, its radius and `margin`; of a hull, that of its bounding box.
/// @pre not a half-space.
template <int D>
Bounds<D> bounds_of(const Shape<D>& shape, const Pose<D>& pose, float margin) {
  Vec<D> first = pose.position + rotate(pose.rotation, shape.vertices[0]);
  Bounds<D> bounds{first, first};
  for (std::uint32_t v = 1; v < shape.vertex_count; ++v) {
    const Vec<D> vertex = pose.position + rotate(pose.rotation, shape.vertices[v]);
    bounds = merged(bounds, {vertex, vertex});
  }
  const Vec<D> reach = reach_of(shape, pose.rotation);
  for (int i = 0; i < D; ++i) {
    bounds.lower[i] -= reach[i] + shape.radius + margin;
    bounds.upper[i] += reach[i] + shape.radius + margin;
  }
  return bounds;
}

}  // namespace cycloid::solver
