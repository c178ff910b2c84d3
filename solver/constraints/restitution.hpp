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

/// The speed of a point after its bounce; the one it has where it closes no faster than the
/// threshold.
template <int D, int W>
[[gnu::always_inline]] inline Lanes<W> speed_after(const StepContext<D>& context,
                                                   const ContactExtra<D, W>& extra,
                                                   const Lanes<W>& gap, const Lanes<W>& speed) {
  using L = Lanes<W>;
  const L h(context.h);
  const L approach = speed + extra.pull * h;
  const L rebound = rebound_speed(extra.restitution, approach, gap, extra.pull, h);
  const auto fast = approach < L(-context.tuning.restitution_threshold);
  return select(fast, max(rebound, speed), speed);
}

/// The points of a contact as this substep's bounces see them.
template <int D, int W>
struct Bounces {
  using L = Lanes<W>;
  static constexpr int kPoints = Dim<D>::kManifoldPoints;

  Arms<D, L> arms[kPoints];
  L bounces[kPoints];  ///< 1 where the point bounces, else 0.
  L speed[kPoints];    ///< Along the normal, m/s.
  L after[kPoints];    ///< What it is to be after the bounce.
};

/// Who of a contact bounces: what would meet in this substep and closes faster than the threshold.
/// With a point that meets those do that come within a tenth of the slop: what lands flat does not
/// tumble because rounding has one corner meet a substep before the other.
template <int D, int W>
[[gnu::always_inline]] inline bool find_bounces(const StepContext<D>& context,
                                                const ContactBlock<D, W>& block,
                                                const MotionLanes<D, W>& a,
                                                const MotionLanes<D, W>& b, Bounces<D, W>& out) {
  using L = Lanes<W>;
  const ContactExtra<D, W>& extra = *block.extra;
  const L zero(0.0f);
  const L h(context.h);
  L next[Bounces<D, W>::kPoints];
  L meets = zero;
  for (std::uint32_t i = 0; i < block.point_count; ++i) {
    const auto& point = block.points[i];
    out.arms[i] = arms_of(block, point);
    out.speed[i] = relative_speed(block.normal, out.arms[i], a, b);
    next[i] = point.gap + h * out.speed[i];
    // A lane without this point would pass for one that bounces, substep by substep.
    const L exists = select(point.normal_mass > zero, L(1.0f), zero);
    meets = max(meets, select(next[i] < zero, exists, zero));
  }
  const L reach = select(meets > zero, L(0.1f * context.tuning.slop), zero);
  bool any = false;
  for (std::uint32_t i = 0; i < block.point_count; ++i) {
    const auto& point = block.points[i];
    out.after[i] = speed_after<D, W>(context, extra, point.gap, out.speed[i]);
    const L arrives = select(next[i] < reach, point.normal_mass, zero);
    const L restitutes = select(extra.restitution > zero, arrives, zero);
    const L changes = select(out.after[i] > out.speed[i], restitutes, zero);
    out.bounces[i] = select(changes > zero, L(1.0f), zero);
    any = any || any_above_zero(out.bounces[i]);
  }
  return any;
}

/// Impulses by which all points that bounce have bounced at once: K x + speed - after >= 0,
/// x >= 0, x . (...) = 0. With Newton's law at every point no energy is made (with e = 1 it is
/// kept), as in Moreau's multiple impact law; one point after the other would set a box that lands
/// flat spinning, by the order of its points.
/// @returns 1 where that is solved, 0 where it is not, or where there is one point.
template <int D, int W>
Lanes<W> bounce_together(const ContactBlock<D, W>& block, const Bounces<D, W>& found,
                         Lanes<W> (&x)[Dim<D>::kManifoldPoints]) {
  using L = Lanes<W>;
  constexpr int kPoints = Dim<D>::kManifoldPoints;
  const L zero(0.0f);
  const int count = static_cast<int>(block.point_count);
  if (count < 2) return zero;
  NormalProblem<kPoints, L> problem;
  couple_normals(block, found.arms, problem);
  for (int i = 0; i < count; ++i) {
    const auto takes_part = found.bounces[i] > zero;
    for (int j = 0; j < count; ++j) {
      if (i == j) continue;
      problem.k[i][j] = select(takes_part, problem.k[i][j], zero);
      problem.k[j][i] = select(takes_part, problem.k[j][i], zero);
    }
    problem.d[i] = select(takes_part, found.speed[i] - found.after[i], zero);
  }
  L usable;
  solve_normals(problem, count, x, usable);
  return select(block.points[1].normal_mass > zero, usable, zero);
}

/// Newton's law v+ = -e v- for points that would meet in this substep and close faster than the
/// threshold. Each contact is one collision of two bodies, exact in energy and momentum; the sweeps
/// that come after see velocities that already part. Runs of balls in touch pass a blow on from row
/// to row. Deviation from Catto, Solver2D (2024), which restores the approach speed at the end of
/// the tick: there e = 1 loses the height fallen between and what third bodies did meanwhile, and a
/// gas of twenty elastic discs loses its energy.
/// @returns whether any did. @pre the block is placed where the bodies are.
template <int D, int W>
[[gnu::always_inline]] inline bool bounce_points(const StepContext<D>& context,
                                                 ContactBlock<D, W>& block, MotionLanes<D, W>& a,
                                                 MotionLanes<D, W>& b) {
  using L = Lanes<W>;
  const L zero(0.0f);
  Bounces<D, W> found;
  if (!find_bounces(context, block, a, b, found)) return false;
  L together[Bounces<D, W>::kPoints];
  const L solved = bounce_together(block, found, together);
  for (std::uint32_t i = 0; i < block.point_count; ++i) {
    const Arms<D, L>& arms = found.arms[i];
    // With the arms where they are now: an effective mass of the tick's start would add energy.
    const L k = coupling(block, block.normal, arms, block.normal, arms);
    const L speed = relative_speed(block.normal, arms, a, b);
    const L after = speed_after<D, W>(context, *block.extra, block.points[i].gap, speed);
    const L alone = (after - speed) / select(k > zero, k, L(1.0f));
    L impulse = alone;
    if (block.point_count > 1) impulse = select(solved > zero, together[i], alone);
    impulse = found.bounces[i] * impulse;
    block.extra->bounce_impulse[i] += impulse;
    block.pushed |= lanes_above_zero(impulse);
    apply_pair(impulse * block.normal, arms, block, a, b);
  }
  return true;
}

}  // namespace cycloid::solver
