#pragma once

#include "solver/constraints/contact_block.hpp"

namespace cycloid::solver {

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

/// Softness of overlapping points, in each lane: of pairs that both move, or of one that does. What
/// an island has taken is rigid, and moved out of overlap by the island; what lands is rigid, and
/// moved out of overlap as springs are.
template <int W>
struct SoftnessLanes {
  Lanes<W> bias_rate;
  Lanes<W> mass_scale;
  Lanes<W> impulse_scale;
};
template <int D, int W>
[[gnu::always_inline]] inline SoftnessLanes<W> softness_of(const StepContext<D>& context,
                                                           const ContactBlock<D, W>& block) {
  using L = Lanes<W>;
  const Softness& both = context.contact;
  SoftnessLanes<W> soft{both.bias_rate, both.mass_scale, both.impulse_scale};
  const LaneBits both_move = block.moves_a & block.moves_b;
  if (both_move != kAllLanes<W>) {
    const Softness& one = context.contact_static;
    const auto of_both = mask_of<W>(both_move);
    soft = {select(of_both, soft.bias_rate, L(one.bias_rate)),
            select(of_both, soft.mass_scale, L(one.mass_scale)),
            select(of_both, soft.impulse_scale, L(one.impulse_scale))};
  }
  if (const LaneBits rigid_lanes = block.taken | block.landing; rigid_lanes != 0) {
    const auto rigid = mask_of<W>(rigid_lanes);
    soft = {select(mask_of<W>(block.taken), L(0.0f), soft.bias_rate),
            select(rigid, L(1.0f), soft.mass_scale), select(rigid, L(0.0f), soft.impulse_scale)};
  }
  return soft;
}

/// How deep, in slops, a point that bounces may have come by the rounding of a gap that it was to
/// close to nothing, and still counts as not arrived.
inline constexpr float kArrival = 0.01f;

/// A gap s > 0 may be closed but not crossed in this substep: bias = s / h. Overlap beyond the slop
/// is pushed out by the block's softness, its first `stiff_overlap` twice as fast, which makes a
/// spring there twice as stiff, and all at most at `push_speed_max`. Pseudo-velocities answer to
/// overlap alone: what is apart may not come closer by them. A relax sweep looks one substep ahead;
/// what is about to bounce there keeps its `speed`, or it would arrive without it.
/// @param soft  softness_of the block; not read by other sweeps than biased ones.
template <int D, int W>
[[gnu::always_inline]] inline NormalRow<W> normal_row(
    const StepContext<D>& context, Sweep sweep, const ContactBlock<D, W>& block,
    const SoftnessLanes<W>& soft, const typename ContactBlock<D, W>::Point& point,
    const Lanes<W>& speed) {
  using L = Lanes<W>;
  NormalRow<W> row;
  const auto apart = point.gap > L(0.0f);
  const L closes = sweep == Sweep::kPseudo ? L(0.0f) : L(context.inverse_h);
  row.bias = select(apart, point.gap * closes, L(0.0f));
  row.mass_scale = L(1.0f);
  row.impulse_scale = L(0.0f);
  if (sweep == Sweep::kRelax) {
    if (!block.bounces) return row;
    const L about_to = select(block.extra->restitution > L(0.0f), L(1.0f), L(0.0f));
    const L fast = select(speed < L(-context.tuning.restitution_threshold), about_to, L(0.0f));
    const L goes_on = select(point.gap > L(-kArrival * context.tuning.slop), fast, L(0.0f));
    row.bias = select(goes_on > L(0.0f), -speed, row.bias);
    return row;
  }
  const L rate = sweep == Sweep::kPseudo ? L(context.pseudo.bias_rate) : soft.bias_rate;
  const L beyond = min(point.gap + L(context.slop), L(0.0f));
  const L overlap = max(L(2.0f) * beyond, beyond - L(context.stiff_overlap));
  row.bias = select(apart, row.bias, max(rate * overlap, L(-context.tuning.push_speed_max)));
  if (sweep == Sweep::kPseudo) return row;
  row.mass_scale = select(apart, row.mass_scale, soft.mass_scale);
  row.impulse_scale = select(apart, row.impulse_scale, soft.impulse_scale);
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
      impulse += point.tangent_impulse[t] * tangent_of(block, t);
    apply_pair(impulse, arms_of(block, point), block, a, b);
  }
}

/// Holds an impulse of N components to a length of at most `bound`; in the plane an interval. A
/// bound of 0 leaves nothing, also of an impulse whose square is too small for a float: what has no
/// friction may share its block with what has.
template <int N, class L>
[[gnu::always_inline]] inline void hold_to_cone(const L& bound, L (&impulse)[N]) {
  if constexpr (N == 1) {
    impulse[0] = max(-bound, min(impulse[0], bound));
  } else {
    L square = impulse[0] * impulse[0];
    for (int i = 1; i < N; ++i) square += impulse[i] * impulse[i];
    const L size = sqrt(square);
    const L held = select(size > bound, bound / max(size, L(1.0e-30f)), L(1.0f));
    const L scale = select(bound > L(0.0f), held, L(0.0f));
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

/// The friction along a tangent that a sweep wants, before it is held to what the normal allows.
template <int W>
[[gnu::always_inline]] inline Lanes<W> wanted_friction(float over_relaxation, const Lanes<W>& mass,
                                                       const Lanes<W>& impulse,
                                                       const Lanes<W>& speed) {
  return impulse - Lanes<W>(over_relaxation) * mass * speed;
}

/// Coulomb friction of point `index` against its normal impulse: in the plane the impulse is held
/// to an interval, in space to a disc.
template <int D, int W>
[[gnu::always_inline]] inline void solve_friction(const StepContext<D>& context,
                                                  ContactBlock<D, W>& block, std::uint32_t index,
                                                  MotionLanes<D, W>& a, MotionLanes<D, W>& b) {
  using L = Lanes<W>;
  constexpr int kTangents = Dim<D>::kTangents;
  auto& point = block.points[index];
  const Arms<D, L> arms = arms_of(block, point);
  L pushes = point.normal_impulse;
  if (block.bounces) pushes += block.extra->bounce_impulse[index];
  const L bound = block.friction * pushes;
  L speed[kTangents];
  L wanted[kTangents];
  for (int t = 0; t < kTangents; ++t) {
    speed[t] = relative_speed(tangent_of(block, t), arms, a, b);
    wanted[t] = wanted_friction(context.tuning.over_relaxation, point.tangent_mass[t],
                                point.tangent_impulse[t], speed[t]);
  }
  slide_against(bound, point.tangent_impulse, point.tangent_mass, speed, wanted);
  hold_to_cone<kTangents>(bound, wanted);
  Vec<D, L> impulse = Vec<D, L>::zero();
  for (int t = 0; t < kTangents; ++t) {
    impulse += (wanted[t] - point.tangent_impulse[t]) * tangent_of(block, t);
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

/// The normal impulse that a sweep wants, before it is clamped. Only a soft row has a mass scale
/// other than 1 and an impulse scale other than 0. The factor of the speed is worked out apart from
/// it: rows wait for the speed, and each operation behind it is one more to wait for.
template <int D, int W>
[[gnu::always_inline]] inline Lanes<W> wanted_normal_impulse(
    const StepContext<D>& context, Sweep sweep, const ContactBlock<D, W>& block,
    const SoftnessLanes<W>& soft, const typename ContactBlock<D, W>::Point& point,
    const Lanes<W>& speed) {
  using L = Lanes<W>;
  const NormalRow<W> row = normal_row(context, sweep, block, soft, point, speed);
  const L relaxation(context.tuning.over_relaxation);
  L kept = point.normal_impulse;
  L mass = relaxation * point.normal_mass;
  if (sweep == Sweep::kBiased) {
    kept -= relaxation * row.impulse_scale * point.normal_impulse;
    mass = mass * row.mass_scale;
  }
  return kept - mass * (speed + row.bias);
}

/// The normal row: 0 <= normal impulse.
template <int D, int W>
[[gnu::always_inline]] inline void solve_normal(const StepContext<D>& context, Sweep sweep,
                                                ContactBlock<D, W>& block,
                                                const SoftnessLanes<W>& soft,
                                                typename ContactBlock<D, W>::Point& point,
                                                MotionLanes<D, W>& a, MotionLanes<D, W>& b) {
  const Arms<D, Lanes<W>> arms = arms_of(block, point);
  const Lanes<W> speed = relative_speed(block.normal, arms, a, b);
  set_normal_impulse(wanted_normal_impulse(context, sweep, block, soft, point, speed), arms, block,
                     point, a, b);
}

}  // namespace cycloid::solver
