#pragma once

#include "solver/constraints/motion_lanes.hpp"
#include "solver/step_context.hpp"

namespace cycloid::solver {

/// Where a contact point is during the tick, from either centre.
template <int D, class L>
struct Arms {
  Vec<D, L> r_a;
  Vec<D, L> r_b;
};

/// W contacts whose bodies are all different, one in each lane; unused lanes have no mass.
///
/// Rows of a point with arms r from the centres, normal n (a to b) and tangents t:
///   C = separation >= 0,  Cdot = n . (v_b + w_b x r_b - v_a - w_a x r_a),  J = (-n, -r_a x n, n,
///   r_b x n),  0 <= normal impulse;  friction: Cdot_t = t . (...), |impulse| <= friction * normal.
/// Effective mass K^-1 with K = J M^-1 J^T per row. Units N s and m/s.
/// Source: Catto, "Iterative Dynamics with Temporal Coherence" (2005) and "Solver2D" (2024).
template <int D, int W>
struct ContactBlock {
  using L = Lanes<W>;
  static constexpr int kTangents = Dim<D>::kTangents;

  struct Point {
    Vec<D, L> r_a;
    Vec<D, L> r_b;
    L separation;     ///< At the start of the tick, m.
    L normal_mass;    ///< 0 in lanes that have no such point.
    Arms<D, L> arms;  ///< At the poses of ContactBlock::placed.
    L gap;            ///< Separation at those poses, m.
    L tangent_mass[kTangents];
    L normal_impulse;
    L position_impulse;  ///< Of XPBD's position pass in this substep, kg m.
    L saved_impulse;     ///< The normal impulse while pseudo-velocities are solved.
    L bounce_impulse;    ///< Of this substep's bounces, N s: friction may use it too.
    L tangent_impulse[kTangents];
  };

  LaneIndices<W> body_a;
  LaneIndices<W> body_b;
  LaneIndices<W> contact;
  LaneBits moves_a;  ///< Lanes whose body a has mass.
  LaneBits moves_b;
  LaneBits has_point[Dim<D>::kManifoldPoints];  ///< By point, the lanes that have it.
  LaneBits loaded;   ///< Of islands: lanes whose load a soft contact would give way to (find_load).
  LaneBits misses;   ///< Of islands (contact_rest.hpp): lanes that the warm start left in motion,
  LaneBits stirs;    ///< or not quite at rest.
  LaneBits taken;    ///< Of islands: lanes in one that is solved, for the whole tick,
  LaneBits left;     ///< and lanes in none.
  LaneBits settled;  ///< Of islands: lanes that biased sweeps pass by.
  std::uint32_t placed;       ///< Which poses the arms are of (StepScratch::poses); 0: of none.
  std::uint32_t point_count;  ///< The most points of any lane.
  bool turns;                 ///< Some body of some lane can turn; else no row has an angular part.
  bool rubs;                  ///< Some lane has friction; else there are no tangent rows.
  bool rolls;                 ///< Some lane resists rolling or twist.
  bool bounces;               ///< Some lane restitutes.
  bool bounced;               ///< Some did in the last sweep of bounces.
  bool follows;               ///< Some lane is round.
  bool touches;               ///< Some lane has a `touch` above 0.
  LaneMass<D, W> mass_a;
  LaneMass<D, W> mass_b;
  Vec<D, L> normal;
  Vec<D, L> tangent[kTangents];
  L share_b;  ///< m_b^-1 / (m_a^-1 + m_b^-1): how far a contact point follows body b.
  L friction;
  L restitution;
  L pull;     ///< Acceleration of b towards a along the normal by gravity and forces, m/s^2.
  L rolling;  ///< Rolling resistance times radius: moment over normal impulse, m.
  L twist;    ///< The same about the normal, m; 0 in the plane.
  Spin<D, L> rolling_impulse;
  L bias_rate;
  L mass_scale;
  L impulse_scale;
  L touch;    ///< A gap below it counts as none, m: above 0 in islands alone.
  L turns_a;  ///< 1, or 0 where the point lies on a ball: it does not turn with the body.
  L turns_b;
  L is_round;               ///< 1 where both are balls about their centres of mass: follow_round.
  Vec<D, L> centre_offset;  ///< Of b from a at the start of the tick, m.
  L radius_a;
  L radius_b;
  Point points[Dim<D>::kManifoldPoints];
};

/// The point moves with the two centres, weighted so that it follows the lighter body. Both
/// impulses of a pair then act at one place, so angular momentum is kept to rounding; arms that are
/// fixed to each centre (Catto, Solver2D) let the two places part while the bodies slide.
template <int D, int W>
[[gnu::always_inline]] inline Arms<D, Lanes<W>> arms_of(
    const ContactBlock<D, W>& block, const typename ContactBlock<D, W>::Point& point,
    const MotionLanes<D, W>& a, const MotionLanes<D, W>& b) {
  const Vec<D, Lanes<W>> slide = b.delta_position - a.delta_position;
  const Vec<D, Lanes<W>> r_a = point.r_a + block.share_b * slide;
  return {r_a, point.r_b + (block.share_b * slide - slide)};
}

/// direction . (v_b + w_b x r_b - v_a - w_a x r_a).
template <int D, int W>
[[gnu::always_inline]] inline Lanes<W> relative_speed(const Vec<D, Lanes<W>>& direction,
                                                      const Arms<D, Lanes<W>>& arms,
                                                      const MotionLanes<D, W>& a,
                                                      const MotionLanes<D, W>& b) {
  return dot(direction, (b.velocity + spin_cross(b.spin, arms.r_b)) -
                            (a.velocity + spin_cross(a.spin, arms.r_a)));
}

template <int D, int W>
[[gnu::always_inline]] inline void apply_pair(const Vec<D, Lanes<W>>& impulse,
                                              const Arms<D, Lanes<W>>& arms,
                                              const ContactBlock<D, W>& block, MotionLanes<D, W>& a,
                                              MotionLanes<D, W>& b) {
  if (!block.turns) {
    a.velocity -= block.mass_a.inverse_mass * impulse;
    b.velocity += block.mass_b.inverse_mass * impulse;
    return;
  }
  apply_impulse(-impulse, arms.r_a, block.mass_a, a);
  apply_impulse(impulse, arms.r_b, block.mass_b, b);
}

/// How one sweep treats the normal row of a point.
template <int W>
struct NormalRow {
  Lanes<W> bias;  ///< m/s
  Lanes<W> mass_scale;
  Lanes<W> impulse_scale;
};

/// Separation along the normal of the tick's start at the present poses.
template <int D, int W>
[[gnu::always_inline]] inline Lanes<W> separation_of(
    const ContactBlock<D, W>& block, const typename ContactBlock<D, W>::Point& point,
    const MotionLanes<D, W>& a, const MotionLanes<D, W>& b) {
  const Vec<D, Lanes<W>> turned_b = rotate(b.delta_rotation, point.r_b) - point.r_b;
  const Vec<D, Lanes<W>> turned_a = rotate(a.delta_rotation, point.r_a) - point.r_a;
  const Vec<D, Lanes<W>> moved =
      (b.delta_position - a.delta_position) + (block.turns_b * turned_b - block.turns_a * turned_a);
  return point.separation + dot(moved, block.normal);
}

/// Arms and gaps where the bodies are now: they hold until positions move again.
template <int D, int W>
[[gnu::always_inline]] inline void place(ContactBlock<D, W>& block, const MotionLanes<D, W>& a,
                                         const MotionLanes<D, W>& b) {
  for (std::uint32_t i = 0; i < block.point_count; ++i) {
    auto& point = block.points[i];
    const Lanes<W> gap = separation_of(block, point, a, b);
    point.arms = arms_of(block, point, a, b);
    point.gap = gap;
    if (!block.touches) continue;
    point.gap = select(gap < block.touch, min(gap, Lanes<W>(0.0f)), gap);
  }
}

/// A gap s > 0 may be closed but not crossed in this substep: bias = s / h. Overlap beyond the slop
/// is pushed out by the block's softness, at most at `push_speed_max`. Pseudo-velocities answer to
/// overlap alone: what is apart may not come closer by them. A relax sweep looks one substep ahead;
/// what is about to bounce there keeps its `speed`, or it would arrive without it.
template <int D, int W>
[[gnu::always_inline]] inline NormalRow<W> normal_row(
    const StepContext<D>& context, Sweep sweep, const ContactBlock<D, W>& block,
    const typename ContactBlock<D, W>::Point& point, const Lanes<W>& speed) {
  using L = Lanes<W>;
  NormalRow<W> row;
  const auto apart = point.gap > L(0.0f);
  const L closes = sweep == Sweep::kPseudo ? L(0.0f) : L(context.inverse_h);
  row.bias = select(apart, point.gap * closes, L(0.0f));
  row.mass_scale = L(1.0f);
  row.impulse_scale = L(0.0f);
  if (sweep == Sweep::kRelax) {
    if (!block.bounces) return row;
    const L about_to = select(block.restitution > L(0.0f), L(1.0f), L(0.0f));
    const L fast = select(speed < L(-context.tuning.restitution_threshold), about_to, L(0.0f));
    row.bias = select(apart, select(fast > L(0.0f), -speed, row.bias), row.bias);
    return row;
  }
  const L rate = sweep == Sweep::kPseudo ? L(context.pseudo.bias_rate) : block.bias_rate;
  const L overlap = min(point.gap + L(context.slop), L(0.0f));
  row.bias = select(apart, row.bias, max(rate * overlap, L(-context.tuning.push_speed_max)));
  if (sweep == Sweep::kPseudo) return row;
  row.mass_scale = select(apart, row.mass_scale, block.mass_scale);
  row.impulse_scale = select(apart, row.impulse_scale, block.impulse_scale);
  return row;
}

template <int D, int W>
[[gnu::always_inline]] inline void turn_pair(const Spin<D, Lanes<W>>& impulse,
                                             const ContactBlock<D, W>& block, MotionLanes<D, W>& a,
                                             MotionLanes<D, W>& b) {
  a.spin -= turned_by<D, W>(block.mass_a, impulse);
  b.spin += turned_by<D, W>(block.mass_b, impulse);
}

template <int D, int W>
[[gnu::always_inline]] inline void warm_start_points(const ContactBlock<D, W>& block,
                                                     MotionLanes<D, W>& a, MotionLanes<D, W>& b) {
  for (std::uint32_t i = 0; i < block.point_count; ++i) {
    const auto& point = block.points[i];
    Vec<D, Lanes<W>> impulse = point.normal_impulse * block.normal;
    for (int t = 0; t < Dim<D>::kTangents; ++t)
      impulse += point.tangent_impulse[t] * block.tangent[t];
    apply_pair(impulse, point.arms, block, a, b);
  }
  if (block.rolls) turn_pair(block.rolling_impulse, block, a, b);
}

/// Holds an impulse of N components to a length of at most `bound`; in the plane an interval.
template <int N, class L>
[[gnu::always_inline]] inline void hold_to_cone(const L& bound, L (&impulse)[N]) {
  if constexpr (N == 1) {
    impulse[0] = max(-bound, min(impulse[0], bound));
  } else {
    L square = impulse[0] * impulse[0];
    for (int i = 1; i < N; ++i) square += impulse[i] * impulse[i];
    const L size = sqrt(square);
    const L scale = select(size > bound, bound / max(size, L(1.0e-30f)), L(1.0f));
    for (int i = 0; i < N; ++i) impulse[i] = scale * impulse[i];
  }
}

/// In the plane there is one direction to slide.
template <class L>
void slide_against(const L&, const L (&)[1], const L (&)[1], const L (&)[1], L (&)[1]) {}

/// In space the masses of the two directions differ, and a step of either by its own would make the
/// friction lean away from the slip, to the side of the larger: a flat box would slide in a curve.
/// What leaves the disc takes the smaller mass both ways, so that what does not change any more
/// points against the slip.
template <class L>
void slide_against(const L& bound, const L (&impulse)[2], const L (&mass)[2], const L (&speed)[2],
                   L (&wanted)[2]) {
  const auto slides = wanted[0] * wanted[0] + wanted[1] * wanted[1] > bound * bound;
  const L least = min(mass[0], mass[1]);
  for (int t = 0; t < 2; ++t) wanted[t] = select(slides, impulse[t] - least * speed[t], wanted[t]);
}

/// Coulomb friction of one point against its normal impulse: in the plane the impulse is held to an
/// interval, in space to a disc.
template <int D, int W>
[[gnu::always_inline]] inline void solve_friction(const StepContext<D>& context,
                                                  ContactBlock<D, W>& block,
                                                  typename ContactBlock<D, W>::Point& point,
                                                  const Arms<D, Lanes<W>>& arms,
                                                  MotionLanes<D, W>& a, MotionLanes<D, W>& b) {
  using L = Lanes<W>;
  constexpr int kTangents = Dim<D>::kTangents;
  const L bound = block.friction * (point.normal_impulse + point.bounce_impulse);
  L speed[kTangents];
  L wanted[kTangents];
  for (int t = 0; t < kTangents; ++t) {
    speed[t] = relative_speed(block.tangent[t], arms, a, b);
    wanted[t] = point.tangent_impulse[t] -
                L(context.tuning.over_relaxation) * point.tangent_mass[t] * speed[t];
  }
  slide_against(bound, point.tangent_impulse, point.tangent_mass, speed, wanted);
  hold_to_cone<kTangents>(bound, wanted);
  Vec<D, L> impulse = Vec<D, L>::zero();
  for (int t = 0; t < kTangents; ++t) {
    impulse += (wanted[t] - point.tangent_impulse[t]) * block.tangent[t];
    point.tangent_impulse[t] = wanted[t];
  }
  apply_pair(impulse, arms, block, a, b);
}

/// Clamps the accumulated impulse, not its change: a sweep may take back what an earlier one gave.
template <int D, int W>
[[gnu::always_inline]] inline void set_normal_impulse(const Lanes<W>& wanted,
                                                      const Arms<D, Lanes<W>>& arms,
                                                      const ContactBlock<D, W>& block,
                                                      typename ContactBlock<D, W>::Point& point,
                                                      MotionLanes<D, W>& a, MotionLanes<D, W>& b) {
  const Lanes<W> accumulated = max(wanted, Lanes<W>(0.0f));
  const Lanes<W> applied = accumulated - point.normal_impulse;
  point.normal_impulse = accumulated;
  apply_pair(applied * block.normal, arms, block, a, b);
}

/// How much a sweep wants to change the normal impulse. Only a soft row has a mass scale other than
/// 1 and an impulse scale other than 0.
template <int D, int W>
[[gnu::always_inline]] inline Lanes<W> normal_change(
    const StepContext<D>& context, Sweep sweep, const ContactBlock<D, W>& block,
    const typename ContactBlock<D, W>::Point& point, const MotionLanes<D, W>& a,
    const MotionLanes<D, W>& b) {
  const Lanes<W> speed = relative_speed(block.normal, point.arms, a, b);
  const NormalRow<W> row = normal_row(context, sweep, block, point, speed);
  if (sweep != Sweep::kBiased) return -point.normal_mass * (speed + row.bias);
  return -point.normal_mass * row.mass_scale * (speed + row.bias) -
         row.impulse_scale * point.normal_impulse;
}

/// The normal row: 0 <= normal impulse.
template <int D, int W>
[[gnu::always_inline]] inline void solve_normal(const StepContext<D>& context, Sweep sweep,
                                                ContactBlock<D, W>& block,
                                                typename ContactBlock<D, W>::Point& point,
                                                MotionLanes<D, W>& a, MotionLanes<D, W>& b) {
  const Lanes<W> change = normal_change(context, sweep, block, point, a, b);
  set_normal_impulse(point.normal_impulse + Lanes<W>(context.tuning.over_relaxation) * change,
                     point.arms, block, point, a, b);
}

}  // namespace cycloid::solver
