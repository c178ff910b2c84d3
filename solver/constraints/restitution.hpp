#pragma once

#include "solver/constraints/contact_together.hpp"

namespace cycloid::solver {

/// Speed away from the surface after a bounce at gap s [m], for a pair that closed at speed u < 0
/// before this substep's gravity and is pulled together at g [m/s^2]. Free flight under symplectic
/// Euler with step h keeps
///   v^2 / 2 - g h v / 2 + g y
/// exactly (v^2 / 2 + g y it does not). The rebound has e^2 of what that gives at the surface:
///   (r + g h / 2)^2 / 2 + g s = e^2 ((u - g h / 2)^2 / 2 + g s) + const.,
/// so e = 1 turns u round and neither loses nor gains height; 0 where the energy does not reach s.
template <class L>
L rebound_speed(const L& restitution, const L& u, const L& gap, const L& pull, const L& h) {
  const L half = L(0.5f) * pull * h;
  const L height = pull * max(gap, L(0.0f));
  const L arrival = L(0.5f) * (u - half) * (u - half) + height;
  const L left = restitution * restitution * arrival - height;
  return max(sqrt(max(L(2.0f) * left, L(0.0f))) - half, L(0.0f));
}

/// Newton's law v+ = -e v- for points that would meet in this substep and close faster than the
/// threshold. Each is one collision of two bodies, exact in energy and momentum; the sweeps that
/// come after see velocities that already part. Runs of balls in touch pass a blow on from row to
/// row. Deviation from Catto, Solver2D (2024), which restores the approach speed at the end of the
/// tick: there e = 1 loses the height fallen between and what third bodies did meanwhile, and a gas
/// of twenty elastic discs loses its energy.
/// @returns whether any did. @pre the block is placed where the bodies are.
template <int D, int W>
[[gnu::always_inline]] inline bool bounce_points(const StepContext<D>& context,
                                                 ContactBlock<D, W>& block, MotionLanes<D, W>& a,
                                                 MotionLanes<D, W>& b) {
  using L = Lanes<W>;
  ContactExtra<D, W>& extra = *block.extra;
  bool any = false;
  const L zero(0.0f);
  const L h(context.h);
  for (std::uint32_t i = 0; i < block.point_count; ++i) {
    auto& point = block.points[i];
    const Arms<D, L> arms = arms_of(block, point);
    const L speed = relative_speed(block.normal, arms, a, b);
    const L approach = speed + extra.pull * h;
    const L meets = select(point.gap + h * speed < zero, L(1.0f), zero);
    const L fast = select(approach < L(-context.tuning.restitution_threshold), meets, zero);
    const L restitutes = select(extra.restitution > zero, fast, zero);
    // A lane without this point would pass for one that bounces, substep by substep.
    const L bounces = select(point.normal_mass > zero, restitutes, zero);
    if (!any_above_zero(bounces)) continue;
    any = true;
    const L rebound = rebound_speed(extra.restitution, approach, point.gap, extra.pull, h);
    // With the arms where they are now: an effective mass of the tick's start would add energy.
    const L k = coupling(block, block.normal, arms, block.normal, arms);
    const L impulse = bounces * max(rebound - speed, zero) / select(k > zero, k, L(1.0f));
    extra.bounce_impulse[i] += impulse;
    block.pushed |= lanes_above_zero(impulse);
    apply_pair(impulse * block.normal, arms, block, a, b);
  }
  return any;
}

}  // namespace cycloid::solver
