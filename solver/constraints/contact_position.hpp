#pragma once

#include "solver/constraints/contact_together.hpp"

namespace cycloid::solver {

/// The arms of a point turned with their bodies, but for points on balls: positions are corrected
/// where they are now.
template <int D, int W>
Arms<D, Lanes<W>> turned_arms(const ContactBlock<D, W>& block,
                              const typename ContactBlock<D, W>::Point& point,
                              const MotionLanes<D, W>& a, const MotionLanes<D, W>& b) {
  const Arms<D, Lanes<W>> turned = turned_away<D, W>(block, point, a, b);
  return {point.r_a + turned.r_a, arm_b_of(block, point) + turned.r_b};
}

/// x += M^-1 J^T lambda on the poses of both bodies. Units of lambda: kg m.
template <int D, int W>
void move_pair(const Vec<D, Lanes<W>>& lambda, const Arms<D, Lanes<W>>& arms,
               const ContactBlock<D, W>& block, MotionLanes<D, W>& a, MotionLanes<D, W>& b) {
  a.delta_position -= block.mass_a.inverse_mass * lambda;
  b.delta_position += block.mass_b.inverse_mass * lambda;
  if (!block.turns) return;
  turn_lanes(-turned_by<D, W>(block.mass_a, moment(arms.r_a, lambda)), a.delta_rotation);
  turn_lanes(turned_by<D, W>(block.mass_b, moment(arms.r_b, lambda)), b.delta_rotation);
}

/// C of the position sweeps: baumgarte (s + slop) within [-correction_max, 0].
template <int D, int W>
Lanes<W> position_error(const StepContext<D>& context, const Lanes<W>& separation) {
  using L = Lanes<W>;
  const L error = L(context.tuning.baumgarte) * (separation + L(context.tuning.slop));
  return min(max(error, L(-context.tuning.correction_max)), L(0.0f));
}

/// The overlaps of the plane's two points at once; 1 in lanes where that was possible.
template <int D, int W>
Lanes<W> correct_two(const StepContext<D>& context, const ContactBlock<D, W>& block,
                     MotionLanes<D, W>& a, MotionLanes<D, W>& b) {
  using L = Lanes<W>;
  if (block.point_count != 2) return L(0.0f);
  const Arms<D, L> first = turned_arms<D, W>(block, block.points[0], a, b);
  const Arms<D, L> second = turned_arms<D, W>(block, block.points[1], a, b);
  const PairProblem<W> problem = {
      coupling(block, block.normal, first, block.normal, first),
      coupling(block, block.normal, first, block.normal, second),
      coupling(block, block.normal, second, block.normal, second),
      position_error<D, W>(context, separation_of(block, block.points[0], a, b)),
      position_error<D, W>(context, separation_of(block, block.points[1], a, b))};
  L x1;
  L x2;
  L usable;
  solve_pair(problem, x1, x2, usable);
  usable = select(block.points[1].normal_mass > L(0.0f), usable, L(0.0f));
  const auto take = usable > L(0.0f);
  move_pair(select(take, x1, L(0.0f)) * block.normal, first, block, a, b);
  move_pair(select(take, x2, L(0.0f)) * block.normal, second, block, a, b);
  return usable;
}

/// The same for up to four points in space.
template <int D, int W>
Lanes<W> correct_manifold(const StepContext<D>& context, const ContactBlock<D, W>& block,
                          MotionLanes<D, W>& a, MotionLanes<D, W>& b) {
  using L = Lanes<W>;
  constexpr int kPoints = Dim<D>::kManifoldPoints;
  const int count = static_cast<int>(block.point_count);
  Arms<D, L> arms[kPoints];
  NormalProblem<kPoints, L> problem;
  for (int i = 0; i < count; ++i) {
    const auto& point = block.points[i];
    arms[i] = turned_arms<D, W>(block, point, a, b);
    const L error = position_error<D, W>(context, separation_of(block, point, a, b));
    problem.d[i] = select(point.normal_mass > L(0.0f), error, L(0.0f));
  }
  couple_normals(block, arms, problem);
  L x[kPoints];
  L usable;
  solve_normals(problem, count, x, usable);
  for (int i = 0; i < count; ++i) {
    const L lambda = select(usable > L(0.0f), x[i], L(0.0f));
    move_pair(lambda * block.normal, arms[i], block, a, b);
  }
  return usable;
}

/// One non-linear Gauss-Seidel sweep over a block: lambda = max(0, -K^-1 C) with separation, arms
/// and K at the present poses. What does not overlap is not touched, to the bit. Source: Catto,
/// "Understanding Constraints" (GDC 2014); for the points at once solve_pair and solve_normals.
template <int D, int W>
void correct_contact(const StepContext<D>& context, ContactBlock<D, W>& block, Motion<D>* motions) {
  using L = Lanes<W>;
  MotionLanes<D, W> a = gather<D, W>(motions, block.body_a);
  MotionLanes<D, W> b = gather<D, W>(motions, block.body_b);
  L usable(0.0f);
  if (context.tuning.contact_block == ContactBlockRows::kNormals) {
    if constexpr (Dim<D>::kTangents == 1)
      usable = correct_two(context, block, a, b);
    else
      usable = correct_manifold(context, block, a, b);
  }
  for (std::uint32_t i = 0; i < block.point_count; ++i) {
    const auto& point = block.points[i];
    const Arms<D, L> arms = turned_arms<D, W>(block, point, a, b);
    const L k = coupling(block, block.normal, arms, block.normal, arms);
    const L error = position_error<D, W>(context, separation_of(block, point, a, b));
    const L has_mass = select(point.normal_mass > L(0.0f), L(1.0f) - usable, L(0.0f));
    const L lambda = has_mass * (-error / select(k > L(0.0f), k, L(1.0f)));
    move_pair(lambda * block.normal, arms, block, a, b);
  }
  scatter_pose(a, block.moves_a, block.body_a, motions);
  scatter_pose(b, block.moves_b, block.body_b, motions);
}

/// XPBD's position pass: overlap is projected out, at most push_speed_max h of it, then the points'
/// tangential displacement since the substep's start where the cone can hold it.
/// Source: Mueller, Macklin, Chentanez, Jeschke and Kim, "Detailed Rigid Body Simulation with
/// Extended Position Based Dynamics" (SCA 2020), sections 3.3 to 3.5.
template <int D, int W>
void project_contact(const StepContext<D>& context, ContactBlock<D, W>& block,
                     const Motion<D>* before, Motion<D>* motions) {
  using L = Lanes<W>;
  MotionLanes<D, W> a = gather<D, W>(motions, block.body_a);
  MotionLanes<D, W> b = gather<D, W>(motions, block.body_b);
  const MotionLanes<D, W> before_a = gather<D, W>(before, block.body_a);
  const MotionLanes<D, W> before_b = gather<D, W>(before, block.body_b);
  const L deepest(-context.tuning.push_speed_max * context.h);
  for (std::uint32_t i = 0; i < block.point_count; ++i) {
    auto& point = block.points[i];
    const Arms<D, L> arms = turned_arms<D, W>(block, point, a, b);
    const L error = max(separation_of(block, point, a, b), deepest);
    const L k = coupling(block, block.normal, arms, block.normal, arms);
    const L change = select(point.normal_mass > L(0.0f), -error / max(k, L(1.0e-30f)), L(0.0f));
    L& impulse = block.extra->position_impulse[i];
    const L total = max(impulse + change, L(0.0f));
    move_pair((total - impulse) * block.normal, arms, block, a, b);
    impulse = total;
    if (!block.rubs) continue;
    // Friction holds the material points, which turn with balls too.
    const Vec<D, L> r_b = arm_b_of(block, point);
    const Vec<D, L> slip = ((b.delta_position + rotate(b.delta_rotation, r_b)) -
                            (before_b.delta_position + rotate(before_b.delta_rotation, r_b))) -
                           ((a.delta_position + rotate(a.delta_rotation, point.r_a)) -
                            (before_a.delta_position + rotate(before_a.delta_rotation, point.r_a)));
    const Arms<D, L> now = turned_arms<D, W>(block, point, a, b);
    Vec<D, L> lambda = Vec<D, L>::zero();
    L square(0.0f);
    for (int t = 0; t < Dim<D>::kTangents; ++t) {
      const Vec<D, L> tangent = tangent_of(block, t);
      const L part = -point.tangent_mass[t] * dot(slip, tangent);
      lambda += part * tangent;
      square += part * part;
    }
    const L bound = block.friction * total;
    const L held = select(square > bound * bound, L(0.0f), L(1.0f));
    // As hold_to_cone: what has no friction may share its block with what has.
    const L sticks = select(bound > L(0.0f), held, L(0.0f));
    move_pair(sticks * lambda, now, block, a, b);
  }
  scatter_pose(a, block.moves_a, block.body_a, motions);
  scatter_pose(b, block.moves_b, block.body_b, motions);
}

/// XPBD's velocity pass, for points that pushed: what the projection left of normal velocity is
/// taken away (what bounces has bounced before), then rolling resistance and dynamic friction,
/// whose impulse is at most friction lambda / h. Source: Mueller et al. 2020, section 3.6.
template <int D, int W>
void rub_projected_contact(const StepContext<D>& context, ContactBlock<D, W>& block,
                           Motion<D>* motions) {
  using L = Lanes<W>;
  MotionLanes<D, W> a = gather<D, W>(motions, block.body_a);
  MotionLanes<D, W> b = gather<D, W>(motions, block.body_b);
  slide(block, a, b);  // The projection has moved both.
  for (std::uint32_t i = 0; i < block.point_count; ++i) {
    auto& point = block.points[i];
    L& impulse = block.extra->position_impulse[i];
    point.normal_impulse = impulse * L(context.inverse_h);
    block.pushed |= lanes_above_zero(point.normal_impulse);
    const Arms<D, L> arms = arms_of(block, point);
    const L speed = relative_speed(block.normal, arms, a, b);
    const L stop = select(impulse > L(0.0f), -point.normal_mass * speed, L(0.0f));
    apply_pair(stop * block.normal, arms, block, a, b);
    for (L& tangent : point.tangent_impulse) tangent = L(0.0f);
    if (block.rubs) solve_friction(context, block, i, a, b);
    impulse = L(0.0f);
  }
  for (L& rolling : block.extra->rolling_impulse.v) rolling = L(0.0f);
  if (block.rolls) solve_rolling(block, a, b);
  scatter(a, block.moves_a, block.body_a, motions);
  scatter(b, block.moves_b, block.body_b, motions);
}

}  // namespace cycloid::solver
