#include "solver/collision/pose_cells.hpp"

#include <cstddef>

#include "solver/collision/collide.hpp"
#include "solver/collision/solid.hpp"
#include "solver/transpose.hpp"

namespace cycloid::solver {

using PerPoint = Lanes<4>;

/// Steps of the grid in what the smaller body reaches; and the coarsest step, m, for bodies whose
/// corners and contacts are to be told apart by it however large they are.
static constexpr float kStepsOfReach = 256.0f;
static constexpr float kStepMax_m = 1.0f / 512.0f;
static constexpr float kStepMin_m = 1.0f / 1048576.0f;

CellGrid grid_of(float extent_a, float extent_b) {
  const bool b_carries = extent_b > extent_a;
  const float reach = b_carries ? extent_a : extent_b;
  float step = kStepMax_m;
  while (step > kStepMin_m && kStepsOfReach * step > reach) step *= 0.5f;
  return {b_carries, reach, b_carries ? extent_b : extent_a, step, 0.5f * step / max(reach, step)};
}

Pose<3> relative_pose(const CellGrid& grid, const PlacedPair<3>& pair) {
  const Pose<3>& frame = grid.b_carries ? pair.pose_b : pair.pose_a;
  const Pose<3>& other = grid.b_carries ? pair.pose_a : pair.pose_b;
  return {rotate_back(frame.rotation, other.position - frame.position),
          compose(conjugate(frame.rotation), other.rotation)};
}

/// The nearest multiple of a step; of values beyond 2^22 steps one that is near.
static float nearest_multiple(float value, float step) {
  constexpr float kWhole = 12582912.0f;  // 1.5 * 2^23: beside it a float has no fraction.
  return (value / step + kWhole - kWhole) * step;
}

Pose<3> rounded(const CellGrid& grid, const Pose<3>& relative) {
  Pose<3> cell;
  for (int i = 0; i < 3; ++i) cell.position[i] = nearest_multiple(relative.position[i], grid.step);
  for (int i = 0; i < 4; ++i) cell.rotation[i] = nearest_multiple(relative.rotation[i], grid.turn);
  return cell;
}

float moved_by_rounding(const CellGrid& grid, float distance) {
  // Half a step in each of three coordinates and of four parts; |R - R0| <= 2 |q - q0|.
  return 0.87f * grid.step + 2.0f * grid.turn * distance;
}

float rounded_margin(float margin, float speculative) {
  constexpr float kRatio = 1.5f;
  // With half of it flown at most, the rest tells of it in time.
  if (margin <= kRatio * speculative) return speculative;
  if (!(speculative > 0.0f)) return margin;
  float bound = kRatio * speculative;
  while (bound < margin) bound *= kRatio;
  return bound;
}

static Rotation<3> rotation_of(const Pose<3>& cell) {
  return normalized_or(cell.rotation, identity_rotation<3>());
}

Manifold<3> collide_in_cell(const Shape<3>& a, const Shape<3>& b, const Polyhedra& polyhedra,
                            const CellGrid& grid, const Pose<3>& cell, float margin) {
  const Pose<3> frame{Vec<3>::zero(), identity_rotation<3>()};
  const Pose<3> other{cell.position, rotation_of(cell)};
  return grid.b_carries ? collide(a, other, b, frame, margin, polyhedra)
                        : collide(a, frame, b, other, margin, polyhedra);
}

/// Whether the normal of a manifold is that of a face of b; of two edges it is of neither.
static bool is_of_face_of_b(const Manifold<3>& manifold) {
  return (manifold.points[0].feature & kReferenceOnB) != 0;
}
static bool is_of_face(const Manifold<3>& manifold) {
  return (manifold.points[0].feature & kOfNoFace) == 0;
}

/// The points of a manifold, one in each lane; those that it lacks are its first again.
struct PointLanes {
  Vec<3, PerPoint> anchor_a;
  PerPoint separation;
};
static PointLanes points_of(const Manifold<3>& manifold) {
  static_assert(offsetof(ManifoldPoint<3>, separation) == 3 * sizeof(float));
  Quad quads[Dim<3>::kManifoldPoints];
  for (std::uint32_t i = 0; i < Dim<3>::kManifoldPoints; ++i)
    quads[i] = load_quad(manifold.points[i < manifold.point_count ? i : 0], 0);
  transpose(quads);
  return {{{PerPoint(quads[0]), PerPoint(quads[1]), PerPoint(quads[2])}}, PerPoint(quads[3])};
}
static void set_points(const PointLanes& points, const Manifold<3>& from, Manifold<3>& to) {
  Quad quads[Dim<3>::kManifoldPoints] = {points.anchor_a[0].raw, points.anchor_a[1].raw,
                                         points.anchor_a[2].raw, points.separation.raw};
  transpose(quads);
  to.point_count = from.point_count;
  for (std::uint32_t i = 0; i < to.point_count; ++i) {
    store_quad(quads[i], 0, to.points[i]);
    to.points[i].feature = from.points[i].feature;
  }
}

template <int N>
static Vec<N, PerPoint> in_all(const Vec<N>& v) {
  Vec<N, PerPoint> lanes;
  for (int i = 0; i < N; ++i) lanes[i] = PerPoint(v.v[i]);
  return lanes;
}

void move_from_cell(const Manifold<3>& manifold, const CellGrid& grid, const Pose<3>& cell,
                    const Pose<3>& relative, const PlacedPair<3>& pair, Manifold<3>& moved) {
  moved.point_count = 0;
  if (manifold.point_count == 0) return;
  const Rotation<3>& to_world = grid.b_carries ? pair.pose_b.rotation : pair.pose_a.rotation;
  const Rotation<3> turn = compose(relative.rotation, conjugate(rotation_of(cell)));
  const bool turns = is_of_face(manifold) && is_of_face_of_b(manifold) != grid.b_carries;
  const Vec<3> normal = turns ? rotate(turn, manifold.normal) : manifold.normal;
  PointLanes points = points_of(manifold);
  const Vec<3, PerPoint> half = (PerPoint(0.5f) * points.separation) * in_all(manifold.normal);
  // What lies on the rounded body, and on the other, from the centre of the former: in the cell,
  // ...
  const Vec<3> a_then = grid.b_carries ? Vec<3>::zero() : -cell.position;
  const Vec<3, PerPoint> middle = points.anchor_a + in_all(a_then);
  const Vec<3, PerPoint> on_rounded = grid.b_carries ? middle - half : middle + half;
  const Vec<3, PerPoint> on_other = grid.b_carries ? middle + half : middle - half;
  // ... and now.
  const Vec<3> a_now = grid.b_carries ? Vec<3>::zero() : -relative.position;
  const Vec<3, PerPoint> rounded_now = rotate(in_all(turn), on_rounded);
  const Vec<3, PerPoint> other_now = on_other + in_all(cell.position - relative.position);
  const Vec<3, PerPoint> apart = grid.b_carries ? other_now - rounded_now : rounded_now - other_now;
  points.separation = dot(in_all(normal), apart);
  points.anchor_a =
      rotate(in_all(to_world), PerPoint(0.5f) * (rounded_now + other_now) - in_all(a_now));
  set_points(points, manifold, moved);
  moved.normal = rotate(to_world, normal);
}

}  // namespace cycloid::solver
