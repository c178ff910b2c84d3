#pragma once

#include "solver/constraints/lane_bits.hpp"
#include "solver/constraints/motion_lanes.hpp"
#include "solver/step_context.hpp"

namespace cycloid::solver {

/// Where a contact point is during the tick, from either centre.
template <int D, class L>
struct Arms {
  Vec<D, L> r_a;
  Vec<D, L> r_b;
};

/// What few contacts need, of the lanes of one block: kept apart, so that the sweeps over all
/// others read half the memory. Where a flag of the block is not set, what it stands for is 0, and
/// the lanes of `turns_a` and `turns_b` are 1.
template <int D, int W>
struct ContactExtra {
  using L = Lanes<W>;
  static constexpr int kPoints = Dim<D>::kManifoldPoints;

  L restitution;  ///< Of ContactBlock::bounces.
  L pull;         ///< Acceleration of b towards a along the normal by gravity and forces,
                  ///< m/s^2.
  L bounce_impulse[kPoints];  ///< Of this substep's bounces, N s: friction may use it too.
  L rolling;  ///< Of ContactBlock::rolls: rolling resistance times radius, moment over impulse, m.
  L twist;    ///< The same about the normal, m; 0 in the plane.
  Spin<D, L> rolling_impulse;
  L turns_a;   ///< Of ContactBlock::has_round: 1, or 0 where the point lies on a ball about the
  L turns_b;   ///< centre of mass: it does not turn with the body.
  L radius_a;  ///< Of ContactBlock::has_round: by which the shapes are rounded, m.
  L radius_b;
  L is_round;  ///< Of ContactBlock::follows: 1 where both are balls about their centres of mass.
  L touch;     ///< Of ContactBlock::touches: a gap below it counts as none, m.
  L position_impulse[kPoints];  ///< Of XPBD's position pass in this substep, kg m.
  L saved_impulse[kPoints];     ///< The normal impulses while pseudo-velocities are solved.
};

/// The directions of friction: in space two, which the plane has no need to keep.
template <int D, class L>
struct FrictionDirections {};
template <class L>
struct FrictionDirections<3, L> {
  Vec<3, L> tangent[2];
};

/// W contacts whose bodies are all different, one in each lane; unused lanes have no mass.
///
/// Rows of a point with arms r from the centres, normal n (a to b) and tangents t:
///   C = separation >= 0,  Cdot = n . (v_b + w_b x r_b - v_a - w_a x r_a),  J = (-n, -r_a x n, n,
///   r_b x n),  0 <= normal impulse;  friction: Cdot_t = t . (...), |impulse| <= friction * normal.
/// Effective mass K^-1 with K = J M^-1 J^T per row. Units N s and m/s.
/// Source: Catto, "Iterative Dynamics with Temporal Coherence" (2005) and "Solver2D" (2024).
template <int D, int W>
struct ContactBlock : FrictionDirections<D, Lanes<W>> {
  using L = Lanes<W>;
  static constexpr int kTangents = Dim<D>::kTangents;

  struct Point {
    Vec<D, L> r_a;  ///< From the centre of a at the start of the tick, m; r_b is r_a - between.
    L separation;   ///< At the start of the tick, m.
    L gap;          ///< Separation at the poses of ContactBlock::placed, m.
    L normal_mass;  ///< 0 in lanes that have no such point.
    L tangent_mass[kTangents];
    L normal_impulse;
    L tangent_impulse[kTangents];
  };

  LaneIndices<W> body_a;
  LaneIndices<W> body_b;
  LaneIndices<W> contact;
  ContactExtra<D, W>* extra;  ///< Null where no flag asks for it.
  LaneBits moves_a;           ///< Lanes whose body a has mass.
  LaneBits moves_b;
  LaneBits has_point[Dim<D>::kManifoldPoints];  ///< By point, the lanes that have it.
  LaneBits loaded;   ///< Of islands: lanes whose load a soft contact would give way to (find_load).
  LaneBits misses;   ///< Of islands (contact_rest.hpp): lanes that the warm start left in motion,
  LaneBits stirs;    ///< or not quite at rest.
  LaneBits taken;    ///< Of islands: lanes in one that is solved, for the whole tick,
  LaneBits left;     ///< and lanes in none.
  LaneBits landing;  ///< Of islands: lanes in one that lands (find_landing), and is not taken.
  LaneBits settled;  ///< Of islands: lanes that biased sweeps pass by.
  LaneBits pushed;   ///< Lanes whose bodies have pushed each other apart in this tick.
  std::uint32_t placed;       ///< Which poses gaps and slides are of (Lot::poses); 0: none.
  std::uint32_t point_count;  ///< The most points of any lane.
  bool turns;                 ///< Some body of some lane can turn; else no row has an angular part.
  bool rubs;                  ///< Some lane has friction; else there are no tangent rows.
  bool rolls;                 ///< Some lane resists rolling or twist.
  bool bounces;               ///< Some lane restitutes.
  bool bounced;               ///< Some did in the last sweep of bounces.
  bool has_round;             ///< Some point lies on a shape with a radius.
  bool follows;               ///< Some lane is round.
  bool touches;               ///< Some lane has a `touch` above 0.
  LaneMass<D, W> mass_a;
  LaneMass<D, W> mass_b;
  Vec<D, L> normal;
  Vec<D, L> between;  ///< Centre of b from that of a at the start of the tick, m.
  Vec<D, L> slide_a;  ///< How far the points have moved from either centre since, m: place().
  Vec<D, L> slide_b;
  L share_b;  ///< m_b^-1 / (m_a^-1 + m_b^-1): how far a contact point follows body b.
  L friction;
  Point points[Dim<D>::kManifoldPoints];
};

template <int W>
[[gnu::always_inline]] inline Vec<2, Lanes<W>> tangent_of(const ContactBlock<2, W>& block, int) {
  return {{block.normal[1], -block.normal[0]}};
}
template <int W>
[[gnu::always_inline]] inline const Vec<3, Lanes<W>>& tangent_of(const ContactBlock<3, W>& block,
                                                                 int t) {
  return block.tangent[t];
}
template <int W>
[[gnu::always_inline]] inline void set_tangents(ContactBlock<2, W>&) {}
template <int W>
[[gnu::always_inline]] inline void set_tangents(ContactBlock<3, W>& block) {
  tangents(block.normal, block.tangent);
}

/// Of a point from the centre of b at the start of the tick, m.
template <int D, int W>
[[gnu::always_inline]] inline Vec<D, Lanes<W>> arm_b_of(
    const ContactBlock<D, W>& block, const typename ContactBlock<D, W>::Point& point) {
  return point.r_a - block.between;
}

/// The arms of a point at the poses of ContactBlock::placed.
///
/// The point moves with the two centres, weighted so that it follows the lighter body. Both
/// impulses of a pair then act at one place, so angular momentum is kept to rounding; arms that are
/// fixed to each centre (Catto, Solver2D) let the two places part while the bodies slide.
template <int D, int W>
[[gnu::always_inline]] inline Arms<D, Lanes<W>> arms_of(
    const ContactBlock<D, W>& block, const typename ContactBlock<D, W>::Point& point) {
  return {point.r_a + block.slide_a, arm_b_of(block, point) + block.slide_b};
}

/// How far from the centre of a body what turns with it lies below a point on its surface: the
/// point itself, or where the shape is rounded by a radius the point of its core, the middle of a
/// ball or the axis of a capsule. Around that the surface is round, whichever way it has turned.
/// @param outward  Towards the other body, of unit length.
template <int D, int W>
[[gnu::always_inline]] inline Vec<D, Lanes<W>> core_arm(const Vec<D, Lanes<W>>& arm,
                                                        const Lanes<W>& radius,
                                                        const Lanes<W>& separation,
                                                        const Vec<D, Lanes<W>>& outward) {
  using L = Lanes<W>;
  const L depth = select(radius > L(0.0f), radius + L(0.5f) * separation, L(0.0f));
  return arm - depth * outward;
}

template <int D, int W>
[[gnu::always_inline]] inline Vec<D, Lanes<W>> turned_by_pose(const MotionLanes<D, W>& motion,
                                                              const Vec<D, Lanes<W>>& arm) {
  return rotate(motion.delta_rotation, arm) - arm;
}

/// How far a point has turned away from where it was about each centre, m.
template <int D, int W>
[[gnu::always_inline]] inline Arms<D, Lanes<W>> turned_away(
    const ContactBlock<D, W>& block, const typename ContactBlock<D, W>::Point& point,
    const MotionLanes<D, W>& a, const MotionLanes<D, W>& b) {
  const Vec<D, Lanes<W>> r_b = arm_b_of(block, point);
  if (!block.has_round) return {turned_by_pose(a, point.r_a), turned_by_pose(b, r_b)};
  const ContactExtra<D, W>& extra = *block.extra;
  const Vec<D, Lanes<W>> core_a =
      core_arm<D, W>(point.r_a, extra.radius_a, point.separation, block.normal);
  const Vec<D, Lanes<W>> core_b =
      core_arm<D, W>(r_b, extra.radius_b, point.separation, -block.normal);
  return {extra.turns_a * turned_by_pose(a, core_a), extra.turns_b * turned_by_pose(b, core_b)};
}

/// Separation along the normal of the tick's start at the present poses.
template <int D, int W>
[[gnu::always_inline]] inline Lanes<W> separation_of(
    const ContactBlock<D, W>& block, const typename ContactBlock<D, W>::Point& point,
    const MotionLanes<D, W>& a, const MotionLanes<D, W>& b) {
  const Arms<D, Lanes<W>> turned = turned_away<D, W>(block, point, a, b);
  const Vec<D, Lanes<W>> moved = (b.delta_position - a.delta_position) + (turned.r_b - turned.r_a);
  return point.separation + dot(moved, block.normal);
}

/// How far the points have moved from either centre, where the bodies are now.
template <int D, int W>
[[gnu::always_inline]] inline void slide(ContactBlock<D, W>& block, const MotionLanes<D, W>& a,
                                         const MotionLanes<D, W>& b) {
  const Vec<D, Lanes<W>> moved = b.delta_position - a.delta_position;
  block.slide_a = block.share_b * moved;
  block.slide_b = block.slide_a - moved;
}

/// Slides and gaps where the bodies are now: they hold until positions move again.
template <int D, int W>
[[gnu::always_inline]] inline void place(ContactBlock<D, W>& block, const MotionLanes<D, W>& a,
                                         const MotionLanes<D, W>& b) {
  slide(block, a, b);
  for (std::uint32_t i = 0; i < block.point_count; ++i) {
    auto& point = block.points[i];
    const Lanes<W> gap = separation_of(block, point, a, b);
    point.gap = gap;
    if (!block.touches) continue;
    point.gap = select(gap < block.extra->touch, min(gap, Lanes<W>(0.0f)), gap);
  }
}

}  // namespace cycloid::solver
