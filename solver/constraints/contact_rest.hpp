#pragma once

#include "solver/constraints/contact_kernels.hpp"
#include "solver/constraints/contact_together.hpp"

namespace cycloid::solver {

/// Lanes whose soft contact would give way by more than the bound.
/// @param load  The impulses of all its points in the tick before, N s.
template <int W>
[[gnu::always_inline]] inline LaneBits loaded_lanes(const LoadBounds& bounds,
                                                    const Lanes<W>& inverse_mass_a,
                                                    const Lanes<W>& inverse_mass_b,
                                                    const Lanes<W>& load) {
  using L = Lanes<W>;
  const L one(bounds.yield_static);
  const L yield =
      select(inverse_mass_a > L(0.0f), select(inverse_mass_b > L(0.0f), L(bounds.yield), one), one);
  const L way = load * (inverse_mass_a + inverse_mass_b) * yield;
  return lanes_above_zero(way - L(bounds.most));
}

/// Sets ContactBlock::loaded.
template <int D, int W>
[[gnu::always_inline]] inline void find_load(const LoadBounds& bounds, ContactBlock<D, W>& block) {
  Lanes<W> load(0.0f);
  for (std::uint32_t p = 0; p < block.point_count; ++p) load += block.points[p].normal_impulse;
  block.loaded = loaded_lanes(bounds, block.mass_a.inverse_mass, block.mass_b.inverse_mass, load);
}

/// The same of contacts that are in no block yet, from `begin` on, as many as there are lanes:
/// whether any of them is loaded. Points that a contact does not have carry nothing.
template <int D, int W>
[[gnu::always_inline]] inline bool any_loaded_from(const LoadBounds& bounds,
                                                   const ContactInputs<D>& in, int begin, int end) {
  constexpr int kImpulses = sizeof(ContactPoint<D>) / sizeof(float);
  LaneIndices<W> body_a;
  LaneIndices<W> body_b;
  LaneIndices<W> contact;
  for (int lane = 0; lane < kLaneCount<W>; ++lane) {
    const LiveContact<D>& live = in.live[begin + lane < end ? begin + lane : end - 1];
    body_a[lane] = live.body_a;
    body_b[lane] = live.body_b;
    contact[lane] = live.contact;
  }
  Lanes<W> load(0.0f);
  for (int p = 0; p < Dim<D>::kManifoldPoints; ++p) {
    Lanes<W> impulses[4];
    gather_floats<W>(in.contacts, contact,
                     float_at(in.contacts[0], in.contacts[0].points) + p * kImpulses, impulses);
    load += Lanes<W>(in.warm_starting) * impulses[1];
  }
  Lanes<W> mass_a[4];
  Lanes<W> mass_b[4];
  gather_columns<W>(in.masses, body_a, 0, mass_a);
  gather_columns<W>(in.masses, body_b, 0, mass_b);
  return loaded_lanes(bounds, mass_a[0], mass_b[0], load) != 0;
}

/// What a point misses of what it holds, by the natural map, m/s: 0 where a lane has no such point.
/// The normal misses what it approaches too fast by, or parts by while its impulse could hold it;
/// the tangents what they slide by where they could stick.
template <int D, int W>
[[gnu::always_inline]] inline Lanes<W> missing_of(const StepContext<D>& context,
                                                  const ContactBlock<D, W>& block,
                                                  const typename ContactBlock<D, W>::Point& point,
                                                  const MotionLanes<D, W>& a,
                                                  const MotionLanes<D, W>& b) {
  using L = Lanes<W>;
  const auto exists = point.normal_mass > L(0.0f);
  const Arms<D, L> arms = arms_of(block, point);
  const L until = select(point.gap > L(0.0f), point.gap * L(context.inverse_h), L(0.0f));
  const L speed = relative_speed(block.normal, arms, a, b) + until;
  const L held = point.normal_impulse / select(exists, point.normal_mass, L(1.0f));
  L missing = select(speed > L(0.0f), min(speed, held), -speed);
  if (block.rubs) {
    const L bound = block.friction * point.normal_impulse;
    L square(0.0f);
    L fastest(0.0f);
    for (int t = 0; t < Dim<D>::kTangents; ++t) {
      const L along = relative_speed(tangent_of(block, t), arms, a, b);
      const L natural = point.tangent_impulse[t] - point.tangent_mass[t] * along;
      square += natural * natural;
      fastest = max(fastest, max(along, -along));
    }
    missing = max(missing, select(square < bound * bound, fastest, L(0.0f)));
  }
  return select(exists, missing, L(0.0f));
}

/// Sets ContactBlock::misses and stirs by what the warm start has led to.
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
  L deepest(0.0f);
  for (std::uint32_t p = 0; p < block.point_count; ++p) {
    const auto& point = block.points[p];
    missing = max(missing, missing_of(context, block, point, a, b));
    const L overlap = -(point.gap + L(context.tuning.slop));
    deepest = max(deepest, select(point.normal_mass > L(0.0f), overlap, L(0.0f)));
  }
  const L overlap = rate * deepest - L(bounds.overlap);
  block.misses = lanes_above_zero(max(missing - L(bounds.misses), overlap));
  block.stirs = lanes_above_zero(max(missing - L(bounds.stirs), overlap));
}

/// One biased sweep over the lanes that are not settled. A lane that is keeps every bit, so that
/// nothing depends on which others share its block.
template <int D, int W>
[[gnu::always_inline]] inline void sweep_unsettled(const StepContext<D>& context,
                                                   ContactBlock<D, W>& block, MotionLanes<D, W>& a,
                                                   MotionLanes<D, W>& b) {
  using L = Lanes<W>;
  const auto keep = mask_of<W>(block.settled);
  const Spin<D, L> rolling = block.rolls ? block.extra->rolling_impulse : Spin<D, L>::zero();
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
  for (int i = 0; i < Dim<D>::kSpin && block.rolls; ++i) {
    L& impulse = block.extra->rolling_impulse[i];
    impulse = select(keep, rolling[i], impulse);
  }
}

}  // namespace cycloid::solver
