#pragma once

#include "solver/constraints/contact.hpp"

namespace cycloid::solver {

/// Energy per kg of an approach, at the moment of touch: a body at gap s [m] that closes at speed
/// u < 0 under the pull g towards the other arrives with
///   k = u^2 / 2 - g h u / 2 + g s.
/// v^2 / 2 - g h v / 2 + g y is what symplectic Euler with step h keeps exactly in free flight
/// (v^2 / 2 + g y alone it does not), so a bounce that keeps it neither loses nor gains height.
template <class L>
L impact_energy(const L& u, const L& gap, const L& pull, const L& h) {
  return L(0.5f) * u * u - L(0.5f) * pull * h * u + pull * max(gap, L(0.0f));
}

/// The speed away from the surface, at gap s, that has e^2 of that energy: the positive root of
/// v^2 / 2 - g h v / 2 + g s = e^2 k; 0 where it has not enough to be there.
template <class L>
L rebound_speed(const L& restitution, const L& energy, const L& gap, const L& pull, const L& h) {
  const L half = L(0.5f) * pull * h;
  const L rest = restitution * restitution * energy - pull * max(gap, L(0.0f));
  return half + sqrt(max(half * half + L(2.0f) * rest, L(0.0f)));
}

/// Newton's law v+ = -e v- for points that approached faster than the threshold and pushed in this
/// tick, with v- the speed at the touch and not at the tick's start.
/// Deviation from Catto, Solver2D (2024), which takes the speed at the start: there e = 1 loses the
/// height fallen between, and comes to rest.
template <int D, int W>
void restitute(const StepContext<D>& context, ContactBlock<D, W>& block,
               std::span<Motion<D>> motions) {
  using L = Lanes<W>;
  if (!block.bounces) return;
  const L zero(0.0f);
  MotionLanes<D, W> a = gather<D, W>(motions, block.body_a);
  MotionLanes<D, W> b = gather<D, W>(motions, block.body_b);
  for (std::uint32_t i = 0; i < block.point_count; ++i) {
    auto& point = block.points[i];
    const Arms<D, L> arms = arms_of(block, point, a, b);
    const L gap = separation_of(block, point, a, b);
    const L speed = relative_speed(block.normal, arms, a, b);
    const L rebound =
        rebound_speed(block.restitution, point.impact_energy, gap, block.pull, L(context.h));
    const L wanted = max(point.normal_impulse - point.normal_mass * (speed - rebound), zero);
    const auto fast = point.approach_speed < L(-context.tuning.restitution_threshold);
    const L bounces = select(fast, select(block.restitution > zero, L(1.0f), zero), zero);
    const L pushed = select(point.max_normal_impulse > zero, bounces, zero);
    set_normal_impulse(select(pushed > zero, wanted, point.normal_impulse), arms, block, point, a,
                       b);
  }
  scatter(a, block.mass_a, block.body_a, motions);
  scatter(b, block.mass_b, block.body_b, motions);
}

}  // namespace cycloid::solver
