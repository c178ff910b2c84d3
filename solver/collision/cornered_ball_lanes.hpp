#pragma once

#include "solver/collision/few_cornered_lanes.hpp"

namespace cycloid::solver {

/// The text of FewCornered::collide_ball and collide_balls, as few_cornered_lanes.hpp is that of
/// the rest.

template <int W>
struct BallLanes {
  Vec<2, Lanes<W>> centre;  ///< Relative to body a's centre of mass, m.
  Lanes<W> radius;
};

template <int W>
[[gnu::always_inline]] inline BallLanes<W> balls_of(const Shape<2>* shapes,
                                                    const LaneIndices<W>& shape,
                                                    const Rotation<2, Lanes<W>>& rotation,
                                                    const Vec<2, Lanes<W>>& position) {
  using L = Lanes<W>;
  L xy[4];
  L rest[4];  // vertex_count, ghosts, radius, offset.
  gather_columns<W>(shapes, shape, 0, xy);
  gather_floats<W>(shapes, shape, float_at(shapes[0], shapes[0].vertex_count), rest);
  return {position + rotate(rotation, Vec<2, L>{{xy[0], xy[1]}}), rest[2]};
}

/// Manifolds of at most one point.
/// @param apart  1 where there is none, else 0.
template <int W>
[[gnu::always_inline]] inline void write_single_points(const Vec<2, Lanes<W>>& normal,
                                                       const LanePoint<W>& point,
                                                       const Lanes<W>& apart,
                                                       const LaneIndices<W>& pair_in_lane,
                                                       Manifold<2>* manifolds) {
  using L = Lanes<W>;
  const L count = select(apart > L(0.0f), L(0.0f), L(1.0f));
  const L head[4] = {normal[0], normal[1], bits_of_integers(count), point.at[0]};
  const L rest[4] = {point.at[0], point.at[1], point.separation, bits_of_integers(point.feature)};
  scatter_floats<W>(head, kAllLanes<W>, 0, pair_in_lane, manifolds);
  scatter_floats<W>(rest, kAllLanes<W>, 3, pair_in_lane, manifolds);
}

/// A ball and what of an outline is closest to it, an edge or a corner, with the one point that
/// they have.
template <int W>
struct BallTouch {
  Vec<2, Lanes<W>> normal;  ///< From the outline to the ball.
  LanePoint<W> point;
  Lanes<W> apart;  ///< 1 where there is no point, else 0.
};

/// hull_against_ball in lanes.
template <int W>
[[gnu::always_inline]] inline BallTouch<W> touch_ball(const Corners<W>& hull,
                                                      const Vec<2, Lanes<W>>& centre,
                                                      Lanes<W> radius, Lanes<W> margin) {
  using L = Lanes<W>;
  const L zero = L(0.0f);
  const L one = L(1.0f);
  L highest = dot(hull.normals[0], centre - hull.vertices[0]);
  L best = zero;
  for (int edge = 1; edge < 4; ++edge) {
    const L height = dot(hull.normals[edge], centre - hull.vertices[edge]);
    best = select(height > highest, L(static_cast<float>(edge)), best);
    highest = max(height, highest);
  }
  const L next = next_corner(hull, best);
  const Vec<2, L> a = pick(hull.vertices, best);
  const Vec<2, L> b = pick(hull.vertices, next);
  const Vec<2, L> normal = pick(hull.normals, best);
  const Vec<2, L> edge = b - a;
  const L along = dot(centre - a, edge);
  const auto before = along < zero;
  const auto after = along > dot(edge, edge);
  const L beside = select(before, zero, select(after, zero, one));
  const auto on_edge = select(highest < zero, one, beside) > zero;

  const Vec<2, L> foot = centre - highest * normal;
  Vec<2, L> corner;
  for (int i = 0; i < 2; ++i) corner[i] = select(before, a[i], b[i]);
  const Vec<2, L> offset = centre - corner;
  const L distance = sqrt(dot(offset, offset));
  const auto has_direction = distance > L(1.0e-12f);
  const Vec<2, L> outwards = (one / select(has_direction, distance, one)) * offset;

  BallTouch<W> touch;
  const L height = select(on_edge, highest, distance);
  Vec<2, L> surface;
  for (int i = 0; i < 2; ++i) {
    const L direction = select(has_direction, outwards[i], normal[i]);
    touch.normal[i] = select(on_edge, normal[i], direction);
    surface[i] = select(on_edge, foot[i], corner[i]) + hull.radius * touch.normal[i];
  }
  const L reach = hull.radius + radius;
  touch.point.separation = height - reach;
  touch.point.at = surface + (L(0.5f) * touch.point.separation) * touch.normal;
  touch.point.feature = select(on_edge, best, L(16.0f) + select(before, best, next));
  // The edge parts them wherever it is higher, also where a corner is closest.
  const L limit = reach + margin;
  touch.apart = select(highest > limit, one, select(height > limit, one, zero));
  return touch;
}

template <int W>
void FewCornered<W>::collide_ball(const Shape<2>* shapes, const PlacedPair<2>* pairs,
                                  const LaneIndices<W>& pair_in_lane, Manifold<2>* manifolds) {
  using L = Lanes<W>;
  const PlacedLanes<W> placed = place_in_lanes<W>(pairs, pair_in_lane);
  LaneIndices<W> hull;
  LaneIndices<W> ball;
  float ball_first[kLaneCount<W>];
  for (int lane = 0; lane < kLaneCount<W>; ++lane) {
    const std::uint32_t a = placed.shape_a[lane];
    const std::uint32_t b = placed.shape_b[lane];
    const bool is_first = shapes[a].kind == ShapeKind::kBall;
    hull[lane] = is_first ? b : a;
    ball[lane] = is_first ? a : b;
    ball_first[lane] = is_first ? 1.0f : 0.0f;
  }
  const auto is_first = L::load(ball_first) > L(0.0f);
  const auto swap = [&](const Vec<2, L>& of_a, const Vec<2, L>& of_b, Vec<2, L>& of_hull,
                        Vec<2, L>& of_ball) __attribute__((always_inline)) {
    for (int i = 0; i < 2; ++i) {
      of_hull[i] = select(is_first, of_b[i], of_a[i]);
      of_ball[i] = select(is_first, of_a[i], of_b[i]);
    }
  };
  Vec<2, L> hull_rotation;
  Vec<2, L> ball_rotation;
  Vec<2, L> hull_position;
  Vec<2, L> ball_position;
  swap(placed.rotation_a, placed.rotation_b, hull_rotation, ball_rotation);
  swap(Vec<2, L>::zero(), placed.a_to_b, hull_position, ball_position);
  const Corners<W> corners = corners_of<W>(shapes, hull, hull_rotation, hull_position);
  const BallLanes<W> of_ball = balls_of<W>(shapes, ball, ball_rotation, ball_position);
  const BallTouch<W> touch = touch_ball(corners, of_ball.centre, of_ball.radius, placed.margin);
  const Vec<2, L> back = -touch.normal;
  const Vec<2, L> normal = {
      {select(is_first, back[0], touch.normal[0]), select(is_first, back[1], touch.normal[1])}};
  write_single_points<W>(normal, touch.point, touch.apart, pair_in_lane, manifolds);
}

template <int W>
void FewCornered<W>::collide_balls(const Shape<2>* shapes, const PlacedPair<2>* pairs,
                                   const LaneIndices<W>& pair_in_lane, Manifold<2>* manifolds) {
  using L = Lanes<W>;
  const L zero = L(0.0f);
  const L one = L(1.0f);
  const PlacedLanes<W> placed = place_in_lanes<W>(pairs, pair_in_lane);
  const BallLanes<W> a = balls_of<W>(shapes, placed.shape_a, placed.rotation_a, Vec<2, L>::zero());
  const BallLanes<W> b = balls_of<W>(shapes, placed.shape_b, placed.rotation_b, placed.a_to_b);
  const Vec<2, L> between = b.centre - a.centre;
  const L distance = sqrt(dot(between, between));
  const auto has_direction = distance > L(1.0e-12f);
  const Vec<2, L> direction = (one / select(has_direction, distance, one)) * between;
  // Concentric balls part upwards.
  const Vec<2, L> normal = {
      {select(has_direction, direction[0], zero), select(has_direction, direction[1], one)}};
  LanePoint<W> point;
  point.separation = distance - (a.radius + b.radius);
  point.at = a.centre + (a.radius + L(0.5f) * point.separation) * normal;
  point.feature = zero;
  const L apart = select(point.separation > placed.margin, one, zero);
  write_single_points<W>(normal, point, apart, pair_in_lane, manifolds);
}

}  // namespace cycloid::solver
