#pragma once

#include "solver/constraints/contact.hpp"

namespace cycloid::solver {

/// Rows of the plane, where a manifold has two points at most: both rows along one direction are
/// solved by their speeds, and the bodies take both impulses at once. In space four points with two
/// tangents each would have more to couple than they save.

/// Whether contacts of a dimension are solved so; else row by row over the bodies (solve_normal).
template <int D>
inline constexpr bool kRowsAlong = Dim<D>::kManifoldPoints == 2;

/// Of a point along a direction d.
template <int W>
struct RowAlong {
  Lanes<W> moment_a;  ///< r_a x d
  Lanes<W> moment_b;
  Lanes<W> speed;  ///< m/s
};

/// Centre of b from that of a at the poses of ContactBlock::placed.
template <int W>
[[gnu::always_inline]] inline Vec<2, Lanes<W>> between_now(const ContactBlock<2, W>& block) {
  return block.between + (block.slide_a - block.slide_b);
}

/// Gives both bodies an impulse of both points, by what it turns them: N s and N m s.
template <int W>
[[gnu::always_inline]] inline void apply_along(const Vec<2, Lanes<W>>& impulse,
                                               const Lanes<W>& turn_a, const Lanes<W>& turn_b,
                                               const ContactBlock<2, W>& block,
                                               MotionLanes<2, W>& a, MotionLanes<2, W>& b) {
  a.velocity -= block.mass_a.inverse_mass * impulse;
  b.velocity += block.mass_b.inverse_mass * impulse;
  if (!block.turns) return;
  a.spin[0] -= block.mass_a.inverse_inertia[0] * turn_a;
  b.spin[0] += block.mass_b.inverse_inertia[0] * turn_b;
}

/// One sequential impulse for each point along direction d:
///   speed_i = d . (v_b - v_a) + m_bi w_b - m_ai w_a,  m = r x d;  where one changes by P_1,
///   speed_2 += K_12 P_1,  K_12 = m_a^-1 + m_b^-1 + m_a1 I_a^-1 m_a2 + m_b1 I_b^-1 m_b2.
/// In exact numbers the same as row by row over the bodies, with a third fewer operations and half
/// as many that wait for one another. Both arms end at one place, so that of b turns by that of a.
/// @param first  Which point is solved first, where there are two.
/// @param solve  Sets the impulse of a point by the speed of its row; returns by how much it
/// changed.
template <int W, class Solve>
[[gnu::always_inline]] inline void solve_along(const Vec<2, Lanes<W>>& direction,
                                               std::uint32_t first, ContactBlock<2, W>& block,
                                               MotionLanes<2, W>& a, MotionLanes<2, W>& b,
                                               const Solve& solve) {
  using L = Lanes<W>;
  const L approach = dot(direction, b.velocity - a.velocity);
  const L moment_between = moment(between_now(block), direction)[0];
  const auto row_of = [&](const auto& point) __attribute__((always_inline)) {
    RowAlong<W> row;
    row.moment_a = moment(point.r_a + block.slide_a, direction)[0];
    row.moment_b = row.moment_a - moment_between;
    row.speed = approach + (row.moment_b * b.spin[0] - row.moment_a * a.spin[0]);
    return row;
  };
  if (block.point_count == 1) {
    const RowAlong<W> row = row_of(block.points[0]);
    const L change = solve(0, row.speed);
    apply_along(change * direction, row.moment_a * change, row.moment_b * change, block, a, b);
    return;
  }
  const RowAlong<W> one = row_of(block.points[first]);
  const RowAlong<W> other = row_of(block.points[1 - first]);
  const L turned_a = block.mass_a.inverse_inertia[0] * one.moment_a * other.moment_a;
  const L turned_b = block.mass_b.inverse_inertia[0] * one.moment_b * other.moment_b;
  const L coupling =
      (block.mass_a.inverse_mass + block.mass_b.inverse_mass) + (turned_a + turned_b);
  const L change_one = solve(first, one.speed);
  const L change_other = solve(1 - first, other.speed + coupling * change_one);
  apply_along((change_one + change_other) * direction,
              one.moment_a * change_one + other.moment_a * change_other,
              one.moment_b * change_one + other.moment_b * change_other, block, a, b);
}

/// The normal rows of a manifold one after the other, from either end in turn.
template <int W>
[[gnu::always_inline]] inline void solve_normals_along(const StepContext<2>& context, Sweep sweep,
                                                       ContactBlock<2, W>& block,
                                                       const SoftnessLanes<W>& soft,
                                                       MotionLanes<2, W>& a, MotionLanes<2, W>& b) {
  using L = Lanes<W>;
  solve_along(
      block.normal, point_in_turn(context, sweep, 0, 2), block, a,
      b, [&](std::uint32_t i, const L& speed) __attribute__((always_inline)) {
        auto& point = block.points[i];
        const L old = point.normal_impulse;
        const L wanted = wanted_normal_impulse(context, sweep, block, soft, point, speed);
        const L accumulated = max(wanted, L(0.0f));
        point.normal_impulse = accumulated;
        return accumulated - old;
      });
}

/// Coulomb friction of each point against its normal impulse.
template <int W>
[[gnu::always_inline]] inline void solve_frictions_along(const StepContext<2>& context,
                                                         ContactBlock<2, W>& block,
                                                         MotionLanes<2, W>& a,
                                                         MotionLanes<2, W>& b) {
  using L = Lanes<W>;
  solve_along(
      tangent_of(block, 0), 0, block, a,
      b, [&](std::uint32_t i, const L& speed) __attribute__((always_inline)) {
        auto& point = block.points[i];
        L pushes = point.normal_impulse;
        if (block.bounces) pushes += block.extra->bounce_impulse[i];
        const L bound = block.friction * pushes;
        const L old = point.tangent_impulse[0];
        L wanted[1] = {
            wanted_friction(context.tuning.over_relaxation, point.tangent_mass[0], old, speed)};
        hold_to_cone<1>(bound, wanted);
        point.tangent_impulse[0] = wanted[0];
        return wanted[0] - old;
      });
}

/// warm_start_points, with all impulses of the manifold in one.
template <int W>
[[gnu::always_inline]] inline void warm_start_along(const ContactBlock<2, W>& block,
                                                    MotionLanes<2, W>& a, MotionLanes<2, W>& b) {
  using L = Lanes<W>;
  const Vec<2, L> tangent = tangent_of(block, 0);
  const auto impulse_of = [&](const auto& point) __attribute__((always_inline)) {
    return point.normal_impulse * block.normal + point.tangent_impulse[0] * tangent;
  };
  const auto turn_of = [&](const auto& point, const Vec<2, L>& impulse)
      __attribute__((always_inline)) {
    return moment(point.r_a + block.slide_a, impulse)[0];
  };
  Vec<2, L> impulse = impulse_of(block.points[0]);
  L turn_a = turn_of(block.points[0], impulse);
  if (block.point_count == 2) {
    const Vec<2, L> other = impulse_of(block.points[1]);
    turn_a += turn_of(block.points[1], other);
    impulse += other;
  }
  apply_along(impulse, turn_a, turn_a - moment(between_now(block), impulse)[0], block, a, b);
}

}  // namespace cycloid::solver
