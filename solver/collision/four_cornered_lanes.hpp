#pragma once

#include <cstddef>

#include "solver/collision/four_cornered.hpp"

namespace cycloid::solver {

/// The text of FourCornered, for the files that compile it and no others. Every function is a
/// template on W, so that those compiled for one instruction set have names of their own.

/// A polygon relative to body a's centre. A corner or an edge is a number 0 to 3, as a float.
template <int W>
struct Corners {
  Vec<2, Lanes<W>> vertices[4];
  Vec<2, Lanes<W>> normals[4];  ///< Of the edge from corner i to i + 1.
  Lanes<W> radius;
};

template <int W>
[[gnu::always_inline]] inline Corners<W> corners_of(const Shape<2>* shapes,
                                                    const LaneIndices<W>& shape,
                                                    const Rotation<2, Lanes<W>>& rotation,
                                                    const Vec<2, Lanes<W>>& position) {
  constexpr int kNormalsAt = offsetof(Geometry<2>, normals) / sizeof(Quad);
  Corners<W> corners;
  for (int half = 0; half < 2; ++half) {
    Lanes<W> xy[4];
    gather_columns<W>(shapes, shape, half, xy);
    corners.vertices[2 * half] = position + rotate(rotation, Vec<2, Lanes<W>>{{xy[0], xy[1]}});
    corners.vertices[2 * half + 1] = position + rotate(rotation, Vec<2, Lanes<W>>{{xy[2], xy[3]}});
    gather_columns<W>(shapes, shape, kNormalsAt + half, xy);
    corners.normals[2 * half] = rotate(rotation, Vec<2, Lanes<W>>{{xy[0], xy[1]}});
    corners.normals[2 * half + 1] = rotate(rotation, Vec<2, Lanes<W>>{{xy[2], xy[3]}});
  }
  for (int lane = 0; lane < kLaneCount<W>; ++lane)
    corners.radius.raw[lane] = shapes[shape[lane]].radius;
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
[[gnu::always_inline]] inline Lanes<W> next_corner(Lanes<W> number) {
  using L = Lanes<W>;
  return select(number > L(2.5f), L(0.0f), number + L(1.0f));
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
  return chosen;
}

/// What a clipped point is written to.
template <int W>
struct ClippedPoint {
  Vec<2, Lanes<W>> at;
  Lanes<W> separation;
  Lanes<W> feature;
};

template <int W>
struct ClippedLanes {
  Vec<2, Lanes<W>> normal;  ///< From the reference to the other.
  ClippedPoint<W> points[2];
  Lanes<W> beside;  ///< 1 where the incident edge lies beside the reference edge: then no point.
};

/// The incident edge of `other` cut to the width of the reference edge: clip_edges in lanes.
/// `flipped` is 1 where the reference is shape b.
template <int W>
[[gnu::always_inline]] inline ClippedLanes<W> clip(const Corners<W>& reference, Lanes<W> edge,
                                                   const Corners<W>& other, Lanes<W> flipped) {
  using L = Lanes<W>;
  const L zero = L(0.0f);
  const L one = L(1.0f);
  ClippedLanes<W> clipped;
  clipped.normal = pick(reference.normals, edge);
  const Vec<2, L> from = pick(reference.vertices, edge);
  const Vec<2, L> span = pick(reference.vertices, next_corner(edge)) - from;
  const L width = sqrt(dot(span, span));
  const Vec<2, L> tangent = (one / width) * span;
  // The incident edge runs against the reference edge; take its far end first.
  const L incident = opposed_edge(other, clipped.normal);
  const L corner[2] = {next_corner(incident), incident};
  const Vec<2, L> q[2] = {pick(other.vertices, corner[0]), pick(other.vertices, corner[1])};
  const L x[2] = {dot(q[0] - from, tangent), dot(q[1] - from, tangent)};
  clipped.beside = select(x[1] < zero, one, select(x[0] > width, one, zero));

  const L reach = reference.radius + other.radius;
  const L run = x[1] - x[0];
  const L divisor = select(run > L(1.0e-9f), run, one);
  const L bound[2] = {zero, width};
  const typename L::Mask outside[2] = {x[0]<zero, x[1]> width};
  ClippedPoint<W> end[2];
  for (int i = 0; i < 2; ++i) {
    const L whole = i == 0 ? zero : one;
    const L cut = select(run > L(1.0e-9f), (bound[i] - x[0]) / divisor, whole);
    const L fraction = select(outside[i], cut, whole);
    const Vec<2, L> point = q[0] + fraction * (q[1] - q[0]);
    const L height = dot(clipped.normal, point - from);
    end[i].separation = height - reach;
    // Midway between the two surfaces along the normal.
    end[i].at = point + (L(0.5f) * (reference.radius - other.radius - height)) * clipped.normal;
  }
  const auto is_flipped = flipped > zero;
  const L feature =
      L(16.0f) * select(is_flipped, incident, edge) + L(2.0f) * select(is_flipped, edge, incident);
  for (int side = 0; side < 2; ++side) {
    ClippedPoint<W>& out = clipped.points[side];
    out.separation = select(is_flipped, end[1 - side].separation, end[side].separation);
    for (int k = 0; k < 2; ++k)
      out.at[k] = select(is_flipped, end[1 - side].at[k], end[side].at[k]);
    out.feature = feature + L(static_cast<float>(side));
  }
  return clipped;
}

template <int W>
[[gnu::always_inline]] inline void write_clipped(const ClippedLanes<W>& clipped, Lanes<W> flipped,
                                                 Lanes<W> outcome,
                                                 ClippedEdges (&into)[kLaneCount<W>]) {
  using L = Lanes<W>;
  LaneIndices<W> rows;
  for (int lane = 0; lane < kLaneCount<W>; ++lane) rows[lane] = static_cast<std::uint32_t>(lane);
  const auto is_flipped = flipped > L(0.0f);
  const Vec<2, L> back = -clipped.normal;
  const L head[4] = {select(is_flipped, back[0], clipped.normal[0]),
                     select(is_flipped, back[1], clipped.normal[1]), outcome, L(0.0f)};
  scatter_columns<W>(head, kAllLanes<W>, 0, rows, into);
  for (int i = 0; i < 2; ++i) {
    const ClippedPoint<W>& point = clipped.points[i];
    const L row[4] = {point.at[0], point.at[1], point.separation, point.feature};
    scatter_columns<W>(row, kAllLanes<W>, i + 1, rows, into);
  }
}

template <int W>
void FourCornered<W>::collide(const Shape<2>* shapes, const PlacedPair<2>* pairs,
                              const LaneIndices<W>& pair_in_lane,
                              ClippedEdges (&clipped)[kLaneCount<W>]) {
  using L = Lanes<W>;
  static_assert(offsetof(PlacedPair<2>, pose_b) == sizeof(Quad));
  L pose_a[4];
  L pose_b[4];
  gather_columns<W>(pairs, pair_in_lane, 0, pose_a);
  gather_columns<W>(pairs, pair_in_lane, 1, pose_b);
  LaneIndices<W> shape_a;
  LaneIndices<W> shape_b;
  L margin;
  for (int lane = 0; lane < kLaneCount<W>; ++lane) {
    const PlacedPair<2>& pair = pairs[pair_in_lane[lane]];
    shape_a[lane] = pair.shape_a;
    shape_b[lane] = pair.shape_b;
    margin.raw[lane] = pair.margin;
  }
  const Vec<2, L> a_to_b = {{pose_b[0] - pose_a[0], pose_b[1] - pose_a[1]}};
  const Corners<W> a = corners_of<W>(shapes, shape_a, {{pose_a[2], pose_a[3]}}, Vec<2, L>::zero());
  const Corners<W> b = corners_of<W>(shapes, shape_b, {{pose_b[2], pose_b[3]}}, a_to_b);

  const DeepestEdge<W> of_a = deepest_edge(a, b);
  const DeepestEdge<W> of_b = deepest_edge(b, a);
  // A tie goes to shape a, see hull_against_hull.
  const auto is_flipped = of_b.separation > of_a.separation + L(1.0e-4f);
  const L flipped = select(is_flipped, L(1.0f), L(0.0f));
  const L edge = select(is_flipped, of_b.edge, of_a.edge);
  const ClippedLanes<W> edges =
      clip(select<W>(is_flipped, b, a), edge, select<W>(is_flipped, a, b), flipped);

  const L limit = a.radius + b.radius + margin;
  const auto number = [](FourCorneredOutcome of) { return L(static_cast<float>(of)); };
  const L apart = number(FourCorneredOutcome::kApart);
  const L unless_beside =
      select(edges.beside > L(0.0f), apart, number(FourCorneredOutcome::kClipped));
  const L separation = select(is_flipped, of_b.separation, of_a.separation);
  const L unless_corners = select(separation > L(1.0e-4f),
                                  number(FourCorneredOutcome::kCornersMayBeClosest), unless_beside);
  const L outcome = select(of_a.separation > limit, apart,
                           select(of_b.separation > limit, apart, unless_corners));
  write_clipped(edges, flipped, outcome, clipped);
}

}  // namespace cycloid::solver
