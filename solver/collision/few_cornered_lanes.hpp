#pragma once

#include <cstddef>

#include "solver/collision/closest_fractions.hpp"
#include "solver/collision/few_cornered.hpp"

namespace cycloid::solver {

/// The text of FewCornered, for the files that compile it and no others. Every function is a
/// template on W, so that those compiled for one instruction set have names of their own.

/// An outline relative to body a's centre. A corner or an edge is a number 0 to 3, as a float.
/// Behind the last corner of one that has less than four comes the first again, which changes no
/// minimum: of equals the first is taken.
template <int W>
struct Corners {
  Vec<2, Lanes<W>> vertices[4];
  Vec<2, Lanes<W>> normals[4];  ///< Of the edge from corner i to i + 1.
  Lanes<W> radius;
  Lanes<W> last;  ///< Number of the last corner: 1, 2 or 3.
};

template <int W>
[[gnu::always_inline]] inline void repeat_first(typename Lanes<W>::Mask mask, int corner,
                                                Corners<W>& corners) {
  for (int i = 0; i < 2; ++i) {
    corners.vertices[corner][i] = select(mask, corners.vertices[0][i], corners.vertices[corner][i]);
    corners.normals[corner][i] = select(mask, corners.normals[0][i], corners.normals[corner][i]);
  }
}

/// Integers as a record has them, in place of floats, from numbers and back.
template <int W>
[[gnu::always_inline]] inline Lanes<W> bits_of_integers(const Lanes<W>& numbers) {
  const auto integers = __builtin_convertvector(numbers.raw, typename Lanes<W>::Mask);
  Lanes<W> bits;
  static_assert(sizeof bits.raw == sizeof integers);
  std::memcpy(&bits.raw, &integers, sizeof integers);
  return bits;
}
template <int W>
[[gnu::always_inline]] inline Lanes<W> numbers_of_bits(const Lanes<W>& bits) {
  typename Lanes<W>::Mask integers;
  std::memcpy(&integers, &bits.raw, sizeof integers);
  return Lanes<W>(__builtin_convertvector(integers, typename Lanes<W>::Raw));
}

template <int W>
[[gnu::always_inline]] inline Corners<W> corners_of(const Shape<2>* shapes,
                                                    const LaneIndices<W>& shape,
                                                    const Rotation<2, Lanes<W>>& rotation,
                                                    const Vec<2, Lanes<W>>& position) {
  using L = Lanes<W>;
  constexpr int kNormalsAt = offsetof(Geometry<2>, normals) / sizeof(Quad);
  Corners<W> corners;
  for (int half = 0; half < 2; ++half) {
    L xy[4];
    gather_columns<W>(shapes, shape, half, xy);
    corners.vertices[2 * half] = position + rotate(rotation, Vec<2, L>{{xy[0], xy[1]}});
    corners.vertices[2 * half + 1] = position + rotate(rotation, Vec<2, L>{{xy[2], xy[3]}});
    gather_columns<W>(shapes, shape, kNormalsAt + half, xy);
    corners.normals[2 * half] = rotate(rotation, Vec<2, L>{{xy[0], xy[1]}});
    corners.normals[2 * half + 1] = rotate(rotation, Vec<2, L>{{xy[2], xy[3]}});
  }
  L rest[4];  // vertex_count, ghosts, radius, offset.
  gather_floats<W>(shapes, shape, float_at(shapes[0], shapes[0].vertex_count), rest);
  corners.radius = rest[2];
  corners.last = numbers_of_bits<W>(rest[0]) - L(1.0f);
  repeat_first<W>(corners.last < L(1.5f), 2, corners);
  repeat_first<W>(corners.last < L(2.5f), 3, corners);
  return corners;
}

template <int W>
struct DeepestEdge {
  Lanes<W> edge;
  Lanes<W> separation;  ///< Of the cores, along the edge's normal, m.
};

/// The edge of `a` that `b` is farthest outside of: of equals the first.
template <int W>
[[gnu::always_inline]] inline DeepestEdge<W> deepest_edge(const Corners<W>& a,
                                                          const Corners<W>& b) {
  using L = Lanes<W>;
  DeepestEdge<W> best;
  for (int edge = 0; edge < 4; ++edge) {
    L lowest = dot(a.normals[edge], b.vertices[0] - a.vertices[edge]);
    for (int corner = 1; corner < 4; ++corner)
      lowest = min(dot(a.normals[edge], b.vertices[corner] - a.vertices[edge]), lowest);
    const L number = L(static_cast<float>(edge));
    best.edge = edge == 0 ? number : select(lowest > best.separation, number, best.edge);
    best.separation = edge == 0 ? lowest : max(lowest, best.separation);
  }
  return best;
}

/// The edge of `hull` whose normal is most opposed to `normal`: of equals the first.
template <int W>
[[gnu::always_inline]] inline Lanes<W> opposed_edge(const Corners<W>& hull,
                                                    const Vec<2, Lanes<W>>& normal) {
  using L = Lanes<W>;
  L lowest = dot(hull.normals[0], normal);
  L best = L(0.0f);
  for (int edge = 1; edge < 4; ++edge) {
    const L along = dot(hull.normals[edge], normal);
    best = select(along < lowest, L(static_cast<float>(edge)), best);
    lowest = min(along, lowest);
  }
  return best;
}

template <int W>
[[gnu::always_inline]] inline Vec<2, Lanes<W>> pick(const Vec<2, Lanes<W>> (&of)[4],
                                                    Lanes<W> number) {
  using L = Lanes<W>;
  Vec<2, L> picked;
  for (int i = 0; i < 2; ++i) {
    const L low = select(number < L(0.5f), of[0][i], of[1][i]);
    const L high = select(number < L(2.5f), of[2][i], of[3][i]);
    picked[i] = select(number < L(1.5f), low, high);
  }
  return picked;
}

template <int W>
[[gnu::always_inline]] inline Lanes<W> next_corner(const Corners<W>& of, Lanes<W> number) {
  using L = Lanes<W>;
  return select(number < of.last, number + L(1.0f), L(0.0f));
}

template <int W>
[[gnu::always_inline]] inline Corners<W> select(typename Lanes<W>::Mask mask, const Corners<W>& yes,
                                                const Corners<W>& no) {
  Corners<W> chosen;
  for (int corner = 0; corner < 4; ++corner) {
    for (int i = 0; i < 2; ++i) {
      chosen.vertices[corner][i] = select(mask, yes.vertices[corner][i], no.vertices[corner][i]);
      chosen.normals[corner][i] = select(mask, yes.normals[corner][i], no.normals[corner][i]);
    }
  }
  chosen.radius = select(mask, yes.radius, no.radius);
  chosen.last = select(mask, yes.last, no.last);
  return chosen;
}

/// The edge of one outline that the manifold lies along, and the edge of the other that faces it.
template <int W>
struct FacingEdges {
  using L = Lanes<W>;
  Vec<2, L> normal;  ///< Of the reference edge, towards the other.
  L edge;            ///< Of the reference.
  L edge_end;        ///< The corner at its end.
  L incident;        ///< Of the other.
  L incident_end;
  Vec<2, L> from;      ///< Where the reference edge begins.
  Vec<2, L> span;      ///< From there to its end.
  Vec<2, L> other[2];  ///< Ends of the incident edge, which runs against it: its far end first.
  L radius;            ///< Of the reference.
  L other_radius;
  typename L::Mask flipped;  ///< The reference is shape b.

  /// feature_id of hull_against_hull.
  L feature(L own, L of_other) const {
    return L(16.0f) * select(flipped, of_other, own) + L(2.0f) * select(flipped, own, of_other);
  }
};

template <int W>
[[gnu::always_inline]] inline FacingEdges<W> facing_edges(const Corners<W>& reference,
                                                          Lanes<W> edge, const Corners<W>& other,
                                                          typename Lanes<W>::Mask flipped) {
  FacingEdges<W> facing;
  facing.normal = pick(reference.normals, edge);
  facing.edge = edge;
  facing.edge_end = next_corner(reference, edge);
  facing.incident = opposed_edge(other, facing.normal);
  facing.incident_end = next_corner(other, facing.incident);
  facing.from = pick(reference.vertices, edge);
  facing.span = pick(reference.vertices, facing.edge_end) - facing.from;
  facing.other[0] = pick(other.vertices, facing.incident_end);
  facing.other[1] = pick(other.vertices, facing.incident);
  facing.radius = reference.radius;
  facing.other_radius = other.radius;
  facing.flipped = flipped;
  return facing;
}

/// A point as it is written.
template <int W>
struct LanePoint {
  Vec<2, Lanes<W>> at;
  Lanes<W> separation;
  Lanes<W> feature;
};

template <int W>
struct LanePoints {
  Vec<2, Lanes<W>> normal;  ///< From the reference to the other.
  LanePoint<W> points[2];
  Lanes<W> apart;  ///< 1 where there are no points, else 0.
};

/// The incident edge cut to the width of the reference edge: clip_edges in lanes.
template <int W>
[[gnu::always_inline]] inline LanePoints<W> clip(const FacingEdges<W>& facing) {
  using L = Lanes<W>;
  const L zero = L(0.0f);
  const L one = L(1.0f);
  const Vec<2, L>(&q)[2] = facing.other;
  const L width = sqrt(dot(facing.span, facing.span));
  const Vec<2, L> tangent = (one / width) * facing.span;
  const L x[2] = {dot(q[0] - facing.from, tangent), dot(q[1] - facing.from, tangent)};
  LanePoints<W> clipped;
  clipped.normal = facing.normal;
  clipped.apart = select(x[1] < zero, one, select(x[0] > width, one, zero));

  const L reach = facing.radius + facing.other_radius;
  const L run = x[1] - x[0];
  const L divisor = select(run > L(1.0e-9f), run, one);
  const L bound[2] = {zero, width};
  const typename L::Mask outside[2] = {x[0]<zero, x[1]> width};
  LanePoint<W> end[2];
  for (int i = 0; i < 2; ++i) {
    const L whole = i == 0 ? zero : one;
    const L cut = select(run > L(1.0e-9f), (bound[i] - x[0]) / divisor, whole);
    const L fraction = select(outside[i], cut, whole);
    const Vec<2, L> point = q[0] + fraction * (q[1] - q[0]);
    const L height = dot(facing.normal, point - facing.from);
    end[i].separation = height - reach;
    // Midway between the two surfaces along the normal.
    end[i].at = point + (L(0.5f) * (facing.radius - facing.other_radius - height)) * facing.normal;
  }
  const L feature = facing.feature(facing.edge, facing.incident);
  for (int side = 0; side < 2; ++side) {
    LanePoint<W>& out = clipped.points[side];
    out.separation = select(facing.flipped, end[1 - side].separation, end[side].separation);
    for (int k = 0; k < 2; ++k)
      out.at[k] = select(facing.flipped, end[1 - side].at[k], end[side].at[k]);
    out.feature = feature + L(static_cast<float>(side));
  }
  return clipped;
}

/// Replaces the points where two corners are what is closest: vertex_against_vertex in lanes.
/// @param asks  1 where that may be.
template <int W>
[[gnu::always_inline]] inline void join_closest_corners(const FacingEdges<W>& facing, Lanes<W> asks,
                                                        Lanes<W> margin, LanePoints<W>& points) {
  using L = Lanes<W>;
  const L zero = L(0.0f);
  const L one = L(1.0f);
  const Vec<2, L> other_span = facing.other[0] - facing.other[1];
  const auto [s, t] = closest_fractions(facing.from, facing.span, facing.other[1], other_span);
  const L s_ends = select(s == zero, asks, select(s == one, asks, zero));
  const L both_end = select(t == zero, s_ends, select(t == one, s_ends, zero));
  const Vec<2, L> on_reference = facing.from + s * facing.span;
  const Vec<2, L> on_other = facing.other[1] + t * other_span;
  const Vec<2, L> between = on_other - on_reference;
  const L distance = sqrt(dot(between, between));
  const auto corners = select(distance < L(1.0e-6f), zero, both_end) > zero;
  if (!any_above_zero(select(corners, one, zero))) return;

  const L reach = facing.radius + facing.other_radius;
  const Vec<2, L> direction = (one / select(corners, distance, one)) * between;
  const L separation = distance - reach;
  const Vec<2, L> surface = on_reference + facing.radius * direction;
  const Vec<2, L> at = surface + (L(0.5f) * separation) * direction;
  const L feature = L(static_cast<float>(0x400)) +
                    facing.feature(select(s == zero, facing.edge, facing.edge_end),
                                   select(t == zero, facing.incident, facing.incident_end));
  const L apart = select(separation > margin, one, zero);
  for (int i = 0; i < 2; ++i) {
    points.normal[i] = select(corners, direction[i], points.normal[i]);
    points.points[0].at[i] = select(corners, at[i], points.points[0].at[i]);
  }
  points.points[0].separation = select(corners, separation, points.points[0].separation);
  points.points[0].feature = select(corners, feature, points.points[0].feature);
  points.points[1].separation = select(corners, L(3.0e38f), points.points[1].separation);
  points.apart = select(corners, apart, points.apart);
}

/// Points that are farther apart than the margin are none; where the first is, the second takes its
/// place.
template <int W>
[[gnu::always_inline]] inline void write_manifolds(const LanePoints<W>& found,
                                                   typename Lanes<W>::Mask flipped,
                                                   const Lanes<W>& margin,
                                                   const LaneIndices<W>& pair_in_lane,
                                                   Manifold<2>* manifolds) {
  using L = Lanes<W>;
  static_assert(offsetof(Manifold<2>, point_count) == 2 * sizeof(float));
  static_assert(offsetof(Manifold<2>, points) == 3 * sizeof(float));
  static_assert(sizeof(ManifoldPoint<2>) == sizeof(Quad));
  const L zero = L(0.0f);
  const L one = L(1.0f);
  L rows[2][4];
  L is_point[2];
  for (int i = 0; i < 2; ++i) {
    const LanePoint<W>& point = found.points[i];
    rows[i][0] = point.at[0];
    rows[i][1] = point.at[1];
    rows[i][2] = point.separation;
    rows[i][3] = bits_of_integers(point.feature);
    is_point[i] = select(point.separation > margin, zero, one);
  }
  for (int k = 0; k < 4; ++k) rows[0][k] = select(is_point[0] > zero, rows[0][k], rows[1][k]);
  const L count = select(found.apart > zero, zero, is_point[0] + is_point[1]);
  const Vec<2, L> back = -found.normal;
  const L head[4] = {select(flipped, back[0], found.normal[0]),
                     select(flipped, back[1], found.normal[1]), bits_of_integers(count),
                     rows[0][0]};
  scatter_floats<W>(head, kAllLanes<W>, 0, pair_in_lane, manifolds);
  for (int i = 0; i < 2; ++i)
    scatter_floats<W>(rows[i], kAllLanes<W>, 3 + 4 * i, pair_in_lane, manifolds);
}

/// Pairs as they are placed, a pair in each lane.
template <int W>
struct PlacedLanes {
  Rotation<2, Lanes<W>> rotation_a;
  Rotation<2, Lanes<W>> rotation_b;
  Vec<2, Lanes<W>> a_to_b;
  Lanes<W> margin;
  LaneIndices<W> shape_a;
  LaneIndices<W> shape_b;
};

template <int W>
[[gnu::always_inline]] inline PlacedLanes<W> place_in_lanes(const PlacedPair<2>* pairs,
                                                            const LaneIndices<W>& pair_in_lane) {
  using L = Lanes<W>;
  static_assert(offsetof(PlacedPair<2>, pose_b) == sizeof(Quad));
  static_assert(sizeof(PlacedPair<2>) == offsetof(PlacedPair<2>, margin) + sizeof(float));
  L pose_a[4];
  L pose_b[4];
  L rest[4];
  gather_columns<W>(pairs, pair_in_lane, 0, pose_a);
  gather_columns<W>(pairs, pair_in_lane, 1, pose_b);
  gather_floats<W>(pairs, pair_in_lane, sizeof(PlacedPair<2>) / sizeof(float) - 4, rest);
  PlacedLanes<W> placed;
  placed.rotation_a = {{pose_a[2], pose_a[3]}};
  placed.rotation_b = {{pose_b[2], pose_b[3]}};
  placed.a_to_b = {{pose_b[0] - pose_a[0], pose_b[1] - pose_a[1]}};
  placed.margin = rest[3];
  for (int lane = 0; lane < kLaneCount<W>; ++lane) {
    placed.shape_a[lane] = pairs[pair_in_lane[lane]].shape_a;
    placed.shape_b[lane] = pairs[pair_in_lane[lane]].shape_b;
  }
  return placed;
}

template <int W>
void FewCornered<W>::collide(const Shape<2>* shapes, const PlacedPair<2>* pairs,
                             const LaneIndices<W>& pair_in_lane, Manifold<2>* manifolds) {
  using L = Lanes<W>;
  const PlacedLanes<W> placed = place_in_lanes<W>(pairs, pair_in_lane);
  const L margin = placed.margin;
  const Corners<W> a = corners_of<W>(shapes, placed.shape_a, placed.rotation_a, Vec<2, L>::zero());
  const Corners<W> b = corners_of<W>(shapes, placed.shape_b, placed.rotation_b, placed.a_to_b);

  const DeepestEdge<W> of_a = deepest_edge(a, b);
  const DeepestEdge<W> of_b = deepest_edge(b, a);
  // A tie goes to shape a, see hull_against_hull.
  const auto is_flipped = of_b.separation > of_a.separation + L(1.0e-4f);
  const L edge = select(is_flipped, of_b.edge, of_a.edge);
  const L separation = select(is_flipped, of_b.separation, of_a.separation);
  const FacingEdges<W> facing =
      facing_edges(select<W>(is_flipped, b, a), edge, select<W>(is_flipped, a, b), is_flipped);
  LanePoints<W> found = clip(facing);

  const L zero = L(0.0f);
  const L one = L(1.0f);
  const L limit = a.radius + b.radius + margin;
  const L farthest = max(of_a.separation, of_b.separation);
  // Two capsules in one line have no separating axis among their sides.
  const L capsules = select(a.last + b.last < L(2.5f), one, zero);
  const L ends_may_be_closest = select(separation > L(1.0e-4f), one, capsules);
  const L asks = select(farthest > limit, zero, ends_may_be_closest);
  if (any_above_zero(asks)) join_closest_corners(facing, asks, margin, found);
  found.apart = select(farthest > limit, one, found.apart);
  write_manifolds(found, is_flipped, margin, pair_in_lane, manifolds);
}

}  // namespace cycloid::solver
