#pragma once

#include "solver/collision/manifold.hpp"
#include "solver/state.hpp"

namespace cycloid::solver {

/// Whether boxes of the plane overlap, each by its lower corner and, behind it, its upper one: all
/// four sides at once, as what is asked of every pair of shapes that are near.
[[gnu::always_inline]] inline bool overlap_in_lanes(const float* a, const float* b) {
  using Four = Lanes<4>;
  const Four::Raw one = Four::load(a).raw;
  const Four::Raw other = Four::load(b).raw;
  const Four lower(__builtin_shufflevector(one, other, 0, 1, 4, 5));
  const Four upper(__builtin_shufflevector(other, one, 2, 3, 6, 7));
  return bits_of<4>(lower > upper) == 0;
}

/// An axis-aligned box, m.
template <int D>
struct Bounds {
  Vec<D> lower;
  Vec<D> upper;

  /// Without a branch for each side: of pairs that are near it is anybody's guess.
  friend bool overlaps(const Bounds& a, const Bounds& b) {
    if constexpr (Dim<D>::kSpin == 1) return overlap_in_lanes(a.lower.v, b.lower.v);
    int apart = 0;
    for (int i = 0; i < D; ++i)
      apart |=
          static_cast<int>(a.lower[i] > b.upper[i]) | static_cast<int>(b.lower[i] > a.upper[i]);
    return apart == 0;
  }
  friend Bounds merged(Bounds a, const Bounds& b) {
    for (int i = 0; i < D; ++i) {
      a.lower[i] = min(a.lower[i], b.lower[i]);
      a.upper[i] = max(a.upper[i], b.upper[i]);
    }
    return a;
  }
};

template <int D>
bool lies_in(const Bounds<D>& inner, const Bounds<D>& outer) {
  for (int i = 0; i < D; ++i)
    if (!(outer.lower[i] <= inner.lower[i] && inner.upper[i] <= outer.upper[i])) return false;
  return true;
}

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

/// The smallest of four, in each lane.
inline Lanes<4> least_of_four(Lanes<4> a) {
  using Raw = Lanes<4>::Raw;
  a = min(Lanes<4>(Raw{a.raw[2], a.raw[3], a.raw[0], a.raw[1]}), a);
  return min(Lanes<4>(Raw{a.raw[1], a.raw[0], a.raw[3], a.raw[2]}), a);
}

/// What boxes mostly are in the plane: the four vertices side by side, of a triangle the last one
/// twice. The same numbers as one after the other.
inline Bounds<2> bounds_of_four(const std::array<Vec<2>, 8>& vertices, bool is_triangle,
                                const Pose<2>& pose) {
  using Four = Lanes<4>;
  using Raw = Four::Raw;
  const Raw low = Four::load(vertices[0].v).raw;
  Raw high = Four::load(vertices[2].v).raw;
  if (is_triangle) high = Raw{high[0], high[1], high[0], high[1]};
  const Vec<2, Four> r{
      {Four(Raw{low[0], low[2], high[0], high[2]}), Four(Raw{low[1], low[3], high[1], high[3]})}};
  const Vec<2, Four> turn{{Four(pose.rotation[0]), Four(pose.rotation[1])}};
  const Vec<2, Four> at{{Four(pose.position[0]), Four(pose.position[1])}};
  const Vec<2, Four> placed = at + rotate(turn, r);
  Bounds<2> bounds;
  for (int i = 0; i < 2; ++i) {
    bounds.lower[i] = least_of_four(placed[i]).raw[0];
    bounds.upper[i] = -least_of_four(-placed[i]).raw[0];
  }
  return bounds;
}
template <int D>
Bounds<D> bounds_of_vertices(const Shape<D>& shape, const Pose<D>& pose) {
  if constexpr (Dim<D>::kSpin == 1)
    if (shape.vertex_count == 3 || shape.vertex_count == 4)
      return bounds_of_four(shape.vertices, shape.vertex_count == 3, pose);
  Vec<D> first = pose.position + rotate(pose.rotation, shape.vertices[0]);
  Bounds<D> bounds{first, first};
  for (std::uint32_t v = 1; v < shape.vertex_count; ++v) {
    const Vec<D> vertex = pose.position + rotate(pose.rotation, shape.vertices[v]);
    bounds = merged(bounds, {vertex, vertex});
  }
  return bounds;
}

/// The box of a shape's vertices, its radius and `margin`; of a hull, that of its bounding box.
/// @pre not a half-space.
template <int D>
Bounds<D> bounds_of(const Shape<D>& shape, const Pose<D>& pose, float margin) {
  Bounds<D> bounds = bounds_of_vertices(shape, pose);
  const Vec<D> reach = reach_of(shape, pose.rotation);
  for (int i = 0; i < D; ++i) {
    bounds.lower[i] -= reach[i] + shape.radius + margin;
    bounds.upper[i] += reach[i] + shape.radius + margin;
  }
  return bounds;
}

}  // namespace cycloid::solver
