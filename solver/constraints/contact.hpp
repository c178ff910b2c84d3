#pragma once

#include <span>

#include "solver/constraints/motion_lanes.hpp"
#include "solver/step_context.hpp"

namespace cycloid::solver {

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
    L adjusted_separation;  ///< separation - n . (r_b - r_a): the part that no motion changes.
    L normal_mass;
    L tangent_mass[kTangents];
    L relative_velocity;  ///< Along n at the start of the tick: what restitution answers to.
    L normal_impulse;
    L max_normal_impulse;  ///< Over the tick's sweeps: whether the point pushed at all.
    L tangent_impulse[kTangents];
  };

  LaneIndices<W> body_a;
  LaneIndices<W> body_b;
  LaneIndices<W> contact;
  LaneMass<D, W> mass_a;
  LaneMass<D, W> mass_b;
  Vec<D, L> normal;
  Vec<D, L> tangent[kTangents];
  L share_b;  ///< m_b^-1 / (m_a^-1 + m_b^-1): how far a contact point follows body b.
  L friction;
  L restitution;
  L bias_rate;
  L mass_scale;
  L impulse_scale;
  std::uint32_t point_count;  ///< The most points of any lane.
  Point points[Dim<D>::kManifoldPoints];
};

/// Where a contact point is during the tick, from either centre.
template <int D, class L>
struct Arms {
  Vec<D, L> r_a;
  Vec<D, L> r_b;
};

/// The point moves with the two centres, weighted so that it follows the lighter body. Both
/// impulses of a pair then act at one place, so angular momentum is kept to rounding; arms that are
/// fixed to each centre (Catto, Solver2D) let the two places part while the bodies slide.
template <int D, int W>
Arms<D, Lanes<W>> arms_of(const ContactBlock<D, W>& block,
                          const typename ContactBlock<D, W>::Point& point,
                          const MotionLanes<D, W>& a, const MotionLanes<D, W>& b) {
  const Vec<D, Lanes<W>> slide = b.delta_position - a.delta_position;
  const Vec<D, Lanes<W>> r_a = point.r_a + block.share_b * slide;
  return {r_a, point.r_b + (block.share_b * slide - slide)};
}

/// direction . (v_b + w_b x r_b - v_a - w_a x r_a).
template <int D, int W>
Lanes<W> relative_speed(const Vec<D, Lanes<W>>& direction, const Arms<D, Lanes<W>>& arms,
                        const MotionLanes<D, W>& a, const MotionLanes<D, W>& b) {
  return dot(direction, (b.velocity + spin_cross(b.spin, arms.r_b)) -
                            (a.velocity + spin_cross(a.spin, arms.r_a)));
}

template <int D, int W>
void apply_pair(const Vec<D, Lanes<W>>& impulse, const Arms<D, Lanes<W>>& arms,
                const ContactBlock<D, W>& block, MotionLanes<D, W>& a, MotionLanes<D, W>& b) {
  apply_impulse(-impulse, arms.r_a, block.mass_a, a);
  apply_impulse(impulse, arms.r_b, block.mass_b, b);
}

template <int D, int W>
void warm_start(const ContactBlock<D, W>& block, std::span<Motion<D>> motions) {
  MotionLanes<D, W> a = gather<D, W>(motions, block.body_a);
  MotionLanes<D, W> b = gather<D, W>(motions, block.body_b);
  for (std::uint32_t i = 0; i < block.point_count; ++i) {
    const auto& point = block.points[i];
    Vec<D, Lanes<W>> impulse = point.normal_impulse * block.normal;
    for (int t = 0; t < Dim<D>::kTangents; ++t)
      impulse += point.tangent_impulse[t] * block.tangent[t];
    apply_pair(impulse, arms_of(block, point, a, b), block, a, b);
  }
  scatter(a, block.mass_a, block.body_a, motions);
  scatter(b, block.mass_b, block.body_b, motions);
}

/// Coulomb friction of one point against its normal impulse: in the plane the
/// impulse is held to an interval, in space to a disc.
template <int D, int W>
void solve_friction(ContactBlock<D, W>& block, typename ContactBlock<D, W>::Point& point,
                    MotionLanes<D, W>& a, MotionLanes<D, W>& b) {
  using L = Lanes<W>;
  constexpr int kTangents = Dim<D>::kTangents;
  const Arms<D, L> arms = arms_of(block, point, a, b);
  const L bound = block.friction * point.normal_impulse;
  L wanted[kTangents];
  for (int t = 0; t < kTangents; ++t) {
    const L speed = relative_speed(block.tangent[t], arms, a, b);
    wanted[t] = point.tangent_impulse[t] - point.tangent_mass[t] * speed;
  }
  if constexpr (kTangents == 1) {
    wanted[0] = max(-bound, min(wanted[0], bound));
  } else {
    const L size = sqrt(wanted[0] * wanted[0] + wanted[1] * wanted[1]);
    const L scale = select(size > bound, bound / max(size, L(1.0e-30f)), L(1.0f));
    for (int t = 0; t < kTangents; ++t) wanted[t] = scale * wanted[t];
  }
  Vec<D, L> impulse = Vec<D, L>::zero();
  for (int t = 0; t < kTangents; ++t) {
    impulse += (wanted[t] - point.tangent_impulse[t]) * block.tangent[t];
    point.tangent_impulse[t] = wanted[t];
  }
  apply_pair(impulse, arms, block, a, b);
}

/// The normal row. A gap s > 0 may be closed but not crossed in this substep: bias = s / h. Overlap
/// beyond the slop is pushed out by the block's softness, at most at `push_speed_max`.
template <int D, int W>
void solve_normal(const StepContext<D>& context, Sweep sweep, ContactBlock<D, W>& block,
                  typename ContactBlock<D, W>::Point& point, MotionLanes<D, W>& a,
                  MotionLanes<D, W>& b) {
  using L = Lanes<W>;
  const Vec<D, L> moved = (b.delta_position - a.delta_position) +
                          rotate(b.delta_rotation, point.r_b) - rotate(a.delta_rotation, point.r_a);
  const L separation = point.adjusted_separation + dot(moved, block.normal);
  const auto apart = separation > L(0.0f);
  L bias = select(apart, separation * L(context.inverse_h), L(0.0f));
  L mass_scale = L(1.0f);
  L impulse_scale = L(0.0f);
  if (sweep == Sweep::kBiased) {
    const L overlap = min(separation + L(context.tuning.slop), L(0.0f));
    const L push = max(block.bias_rate * overlap, L(-context.tuning.push_speed_max));
    bias = select(apart, bias, push);
    mass_scale = select(apart, mass_scale, block.mass_scale);
    impulse_scale = select(apart, impulse_scale, block.impulse_scale);
  }
  const Arms<D, L> arms = arms_of(block, point, a, b);
  const L speed = relative_speed(block.normal, arms, a, b);
  const L change =
      -point.normal_mass * mass_scale * (speed + bias) - impulse_scale * point.normal_impulse;
  const L accumulated = max(point.normal_impulse + change, L(0.0f));
  const L applied = accumulated - point.normal_impulse;
  point.normal_impulse = accumulated;
  point.max_normal_impulse = max(point.max_normal_impulse, accumulated);
  apply_pair(applied * block.normal, arms, block, a, b);
}

/// One sweep over the block: normals first, so that friction is held to the impulse of this sweep.
/// The other way round a relax sweep would hold it to the softened impulse of the biased sweep,
/// which is 3 % too small: a box on a slope then accelerates too fast.
template <int D, int W>
void solve(const StepContext<D>& context, Sweep sweep, ContactBlock<D, W>& block,
           std::span<Motion<D>> motions) {
  MotionLanes<D, W> a = gather<D, W>(motions, block.body_a);
  MotionLanes<D, W> b = gather<D, W>(motions, block.body_b);
  for (std::uint32_t i = 0; i < block.point_count; ++i)
    solve_normal(context, sweep, block, block.points[i], a, b);
  for (std::uint32_t i = 0; i < block.point_count; ++i)
    solve_friction(block, block.points[i], a, b);
  scatter(a, block.mass_a, block.body_a, motions);
  scatter(b, block.mass_b, block.body_b, motions);
}

/// v+ = -e v-, for points that approached faster than the threshold and pushed in this tick.
template <int D, int W>
void restitute(const StepContext<D>& context, ContactBlock<D, W>& block,
               std::span<Motion<D>> motions) {
  using L = Lanes<W>;
  MotionLanes<D, W> a = gather<D, W>(motions, block.body_a);
  MotionLanes<D, W> b = gather<D, W>(motions, block.body_b);
  for (std::uint32_t i = 0; i < block.point_count; ++i) {
    auto& point = block.points[i];
    const Arms<D, L> arms = arms_of(block, point, a, b);
    const L speed = relative_speed(block.normal, arms, a, b);
    const L wanted =
        max(point.normal_impulse -
                point.normal_mass * (speed + block.restitution * point.relative_velocity),
            L(0.0f));
    const auto fast = point.relative_velocity < L(-context.tuning.restitution_threshold);
    const auto pushed = point.max_normal_impulse > L(0.0f);
    const auto bounces = block.restitution > L(0.0f);
    const L accumulated = select(
        fast, select(pushed, select(bounces, wanted, point.normal_impulse), point.normal_impulse),
        point.normal_impulse);
    const L applied = accumulated - point.normal_impulse;
    point.normal_impulse = accumulated;
    apply_pair(applied * block.normal, arms, block, a, b);
  }
  scatter(a, block.mass_a, block.body_a, motions);
  scatter(b, block.mass_b, block.body_b, motions);
}

}  // namespace cycloid::solver
