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

/// The box of a shape's vertices, its radius and `margin`. @pre not a half-space.
template <int D>
Bounds<D> bounds_of(const Shape<D>& shape, const Pose<D>& pose, float margin) {
  Vec<D> first = pose.position + rotate(pose.rotation, shape.vertices[0]);
  Bounds<D> bounds{first, first};
  for (std::uint32_t v = 1; v < shape.vertex_count; ++v) {
    const Vec<D> vertex = pose.position + rotate(pose.rotation, shape.vertices[v]);
    bounds = merged(bounds, {vertex, vertex});
  }
  for (int i = 0; i < D; ++i) {
    bounds.lower[i] -= shape.radius + margin;
    bounds.upper[i] += shape.radius + margin;
  }
  return bounds;
}

}  // namespace cycloid::solver
