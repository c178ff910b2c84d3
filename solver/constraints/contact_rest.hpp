#pragma once

#include "solver/constraints/contact_kernels.hpp"
#include "solver/constraints/contact_together.hpp"

namespace cycloid::solver {

/// Lanes in which a number is above 0.
template <int W>
[[gnu::always_inline]] inline LaneBits lanes_above_zero(const Lanes<W>& a) {
  LaneBits bits = 0;
  for (int lane = 0; lane < kLaneCount<W>; ++lane)
    bits |= static_cast<LaneBits>(a.raw[lane] > 0.0f) << lane;
  return bits;
}

/// What a point misses of what it holds, by the natural map: 0 where a lane has no such point.
template <int W>
struct PointRest {
  Lanes<W> missing;  ///< m/s, by what pushes or sticks.
  Lanes<W> sliding;  ///< m/s, by what slides under load.
};

/// The normal misses what it approaches too fast by, or parts by while its impulse could hold it.
template <int D, int W>
[[gnu::always_inline]] inline PointRest<W> rest_of(const StepContext<D>& context,
                                                   const ContactBlock<D, W>& block,
                                                   const typename ContactBlock<D, W>::Point& point,
                                                   const MotionLanes<D, W>& a,
                                                   const MotionLanes<D, W>& b) {
  using L = Lanes<W>;
  const auto exists = point.normal_mass > L(0.0f);
  const L until = select(point.gap > L(0.0f), point.gap * L(context.inverse_h), L(0.0f));
  const L speed = relative_speed(block.normal, point.arms, a, b) + until;
  const L held = point.normal_impulse / select(exists, point.normal_mass, L(1.0f));
  PointRest<W> rest{select(speed > L(0.0f), min(speed, held), -speed), L(0.0f)};
  if (block.rubs) {
    const L bound = block.friction * point.normal_impulse;
    L square(0.0f);
    L fastest(0.0f);
    for (int t = 0; t < Dim<D>::kTangents; ++t) {
      const L along = relative_speed(block.tangent[t], point.arms, a, b);
      const L natural = point.tangent_impulse[t] - point.tangent_mass[t] * along;
      square += natural * natural;
      fastest = max(fastest, max(along, -along));
    }
    const auto sticks = square < bound * bound;
    rest.missing = max(rest.missing, select(sticks, fastest, L(0.0f)));
    rest.sliding = select(sticks, L(0.0f), select(bound > L(0.0f), fastest, L(0.0f)));
  }
  rest.missing = select(exists, rest.missing, L(0.0f));
  rest.sliding = select(exists, rest.sliding, L(0.0f));
  return rest;
}

/// Sets ContactBlock::misses, stirs and slides by what the warm start has led to.
template <int D, int W>
[[gnu::always_inline]] inline void find_rest(const StepContext<D>& context,
                                             const RestBounds& bounds, const MotionLanes<D, W>& a,
                                             const MotionLanes<D, W>& b,
                                             ContactBlock<D, W>& block) {
  using L = Lanes<W>;
  const L one(context.contact_static.bias_rate);
  const L rate =
      select(block.mass_a.inverse_mass > L(0.0f),
             select(block.mass_b.inverse_mass > L(0.0f), L(context.contact.bias_rate), one), one);
  L missing(0.0f);
  L sliding(0.0f);
  L deepest(0.0f);
  for (std::uint32_t p = 0; p < block.point_count; ++p) {
    const auto& point = block.points[p];
    const PointRest<W> rest = rest_of(context, block, point, a, b);
    missing = max(missing, rest.missing);
    sliding = max(sliding, rest.sliding);
    deepest = max(deepest, -(point.gap + L(context.tuning.slop)));
  }
  const L overlap = rate * deepest - L(bounds.overlap);
  block.misses = lanes_above_zero(max(missing - L(bounds.misses), overlap));
  block.stirs = lanes_above_zero(max(missing - L(bounds.stirs), overlap));
  block.slides = lanes_above_zero(sliding - L(bounds.misses));
}

/// One biased sweep over the lanes that are not settled. A lane that is keeps every bit, so that
/// nothing depends on which others share its block.
template <int D, int W>
[[gnu::always_inline]] inline void sweep_unsettled(const StepContext<D>& context,
                                                   ContactBlock<D, W>& block, MotionLanes<D, W>& a,
                                                   MotionLanes<D, W>& b) {
  using L = Lanes<W>;
  L is_settled(0.0f);
  for (int lane = 0; lane < kLaneCount<W>; ++lane)
    is_settled.raw[lane] = (block.settled >> lane & 1) != 0 ? 1.0f : 0.0f;
  const auto keep = is_settled > L(0.0f);
  const Spin<D, L> rolling = block.rolling_impulse;
  L normal[Dim<D>::kManifoldPoints];
  L tangent[Dim<D>::kManifoldPoints][Dim<D>::kTangents];
  for (std::uint32_t p = 0; p < block.point_count; ++p) {
    normal[p] = block.points[p].normal_impulse;
    for (int t = 0; t < Dim<D>::kTangents; ++t) tangent[p][t] = block.points[p].tangent_impulse[t];
  }
  solve_block(context, Sweep::kBiased, block, a, b);
  for (std::uint32_t p = 0; p < block.point_count; ++p) {
    auto& point = block.points[p];
    point.normal_impulse = select(keep, normal[p], point.normal_impulse);
    for (int t = 0; t < Dim<D>::kTangents; ++t)
      point.tangent_impulse[t] = select(keep, tangent[p][t], point.tangent_impulse[t]);
  }
  for (int i = 0; i < Dim<D>::kSpin; ++i)
    block.rolling_impulse[i] = select(keep, rolling[i], block.rolling_impulse[i]);
}

}  // namespace cycloid::solver
