#pragma once

#include "solver/collision/segments.hpp"
#include "solver/collision/solid.hpp"

namespace cycloid::solver {

/// Whether a rod has no length, so that it meets everything in one point.
inline bool is_ball(const Rod& rod) {
  const Vec<3> along = rod.to - rod.from;
  return !(dot(along, along) > 0.0f);
}

inline Vec<3> point_on(const Rod& rod, float fraction) {
  return rod.from + fraction * (rod.to - rod.from);
}

/// What is within this cosine of lying flat on a face is met along the face's normal.
inline constexpr float kLiesFlat = 0.9998f;

/// The unit normal from a to b at their nearest points: the line between these; where the segments
/// cross the normal of both, so that it does not depend on a small distance; where they touch one
/// across the segment that is met inside, towards the other's middle, and where that has no
/// direction either, upwards (axis 1) as far as the segments allow.
Vec<3> normal_between(const Rod& a, const Rod& b, const SegmentPair& pair);

/// One point of each axis, and how far apart they are along a manifold's normal, m.
struct AxisPoints {
  Vec<3> on_a;
  Vec<3> on_b;
  float height;
};

/// Both ends of the length along which two nearly parallel rods lie side by side, in the order of
/// `a`. False, leaving `ends` undefined, where they are no closer to parallel than the tenth of
/// their common radius or 0.03 of that length, or overlap by less than a hundredth of the shorter.
bool parallel_points(const Rod& a, const Rod& b, const Vec<3>& normal, AxisPoints (&ends)[2]);

/// A part of a rod, as fractions of its length; empty where from > to.
struct Span {
  float from;
  float to;
};

/// The part of the rod's axis over a face: between the side planes of the face, each moved outwards
/// by `slack` [m].
Span clip_to_face(const Solid& solid, std::uint32_t face, const Rod& rod, float slack);

/// Adds the ends of a span as points against a face, whose normal the manifold has; one point where
/// the span has no length. Points farther than `margin` are left out.
/// The features are those of a clip of the rod's ends, whatever side plane cuts them.
void add_span(const Solid& solid, std::uint32_t face, const Rod& rod, const Span& span,
              float margin, Manifold<3>& manifold);

/// Lengths below this are rounding where a solid meets a rod, m: a few units in the last place of
/// what is subtracted.
float rounding_of(const Solid& solid, const Rod& rod);

/// Features of points on an edge (half-edge, even; the next number is the second point of a rod
/// along that edge) and on a corner of a solid or triangle. Faces use clip_feature.
constexpr std::uint32_t edge_feature(std::uint32_t edge) {
  return 0x10000000u | edge;
}
constexpr std::uint32_t corner_feature(std::uint32_t vertex) {
  return 0x20000000u | vertex;
}

/// The nearest points of a half-edge (first) and the rod's axis.
SegmentPair nearest_to_edge(const Solid& solid, std::uint32_t edge, const Rod& rod);

/// The edge as a rod of no radius.
Rod edge_rod(const Solid& solid, std::uint32_t edge);

/// Adds the rod's points against a half-edge (even) or one of its ends: two where it lies along the
/// edge. The manifold's normal is set; `pair` is nearest_to_edge.
void add_edge_points(const Solid& solid, std::uint32_t edge, const Rod& rod,
                     const SegmentPair& pair, float margin, Manifold<3>& manifold);

}  // namespace cycloid::solver
