#pragma once

#include "solver/constraints/contact_cone.hpp"
#include "solver/constraints/contact_normals.hpp"
#include "solver/constraints/contact_plane.hpp"
#include "solver/constraints/contact_rolling.hpp"

namespace cycloid::solver {

/// J_i M^-1 J_j^T of two directions at two places of one contact.
template <int D, int W>
Lanes<W> coupling(const ContactBlock<D, W>& block, const Vec<D, Lanes<W>>& direction_i,
                  const Arms<D, Lanes<W>>& arms_i, const Vec<D, Lanes<W>>& direction_j,
                  const Arms<D, Lanes<W>>& arms_j) {
  const Lanes<W> linear =
      (block.mass_a.inverse_mass + block.mass_b.inverse_mass) * dot(direction_i, direction_j);
  if (!block.turns) return linear;
  return linear +
         dot(moment(arms_i.r_a, direction_i),
             turned_by<D, W>(block.mass_a, moment(arms_j.r_a, direction_j))) +
         dot(moment(arms_i.r_b, direction_i),
             turned_by<D, W>(block.mass_b, moment(arms_j.r_b, direction_j)));
}

/// The two rows of a manifold as one problem: w = K x + d >= 0, x >= 0, x . w = 0.
template <int W>
struct PairProblem {
  Lanes<W> k11, k12, k22;
  Lanes<W> d1, d2;
};

/// Solves it by its four cases: both push, the first alone, the second alone, none. They exclude
/// one another where K is positive definite. `usable` is 0 where K is too close to singular, or no
/// case holds by rounding; the caller then solves the rows one after the other. Source: Catto's
/// block solver (Box2D 2.x), by total enumeration (Murty, "Linear Complementarity", 1988).
template <int W>
void solve_pair(const PairProblem<W>& p, Lanes<W>& x1, Lanes<W>& x2, Lanes<W>& usable) {
  using L = Lanes<W>;
  constexpr float kConditionMax = 1000.0f;
  const L zero(0.0f);
  const L one(1.0f);
  const L determinant = p.k11 * p.k22 - p.k12 * p.k12;
  const L square = max(p.k11 * p.k11, p.k22 * p.k22);
  const L well = select(square < L(kConditionMax) * determinant, one, zero);
  const L inverse = one / select(well > zero, determinant, one);
  const L both1 = (p.k12 * p.d2 - p.k22 * p.d1) * inverse;
  const L both2 = (p.k12 * p.d1 - p.k11 * p.d2) * inverse;
  const L first = -p.d1 / select(p.k11 > zero, p.k11, one);
  const L second = -p.d2 / select(p.k22 > zero, p.k22, one);
  const auto holds = [&](const L& a, const L& b) {
    return select(a < zero, zero, select(b < zero, zero, one));
  };
  const L none_holds = holds(p.d1, p.d2);
  const L second_holds = holds(second, p.k12 * second + p.d1);
  const L first_holds = holds(first, p.k12 * first + p.d2);
  const L both_hold = holds(both1, both2);
  // From the last case to the first, so that of several that hold by rounding the first counts.
  x1 = zero;
  x2 = zero;
  usable = none_holds;
  const auto take = [&](const L& it, const L& value1, const L& value2) {
    x1 = select(it > zero, value1, x1);
    x2 = select(it > zero, value2, x2);
    usable = max(usable, it);
  };
  take(second_holds, zero, second);
  take(first_holds, first, zero);
  take(both_hold, both1, both2);
  usable = usable * well;
}

/// The normals row by row, in the lanes where `wanted` is not 0.
template <int D, int W>
void solve_normals_where(const Lanes<W>& wanted, const StepContext<D>& context, Sweep sweep,
                         ContactBlock<D, W>& block, MotionLanes<D, W>& a, MotionLanes<D, W>& b) {
  using L = Lanes<W>;
  const SoftnessLanes<W> soft = softness_of(context, block);
  for (std::uint32_t i = 0; i < block.point_count; ++i) {
    auto& point = block.points[i];
    const Arms<D, L> arms = arms_of(block, point);
    const L speed = relative_speed(block.normal, arms, a, b);
    const L by_row = wanted_normal_impulse(context, sweep, block, soft, point, speed);
    set_normal_impulse(select(wanted > L(0.0f), by_row, point.normal_impulse), arms, block, point,
                       a, b);
  }
}

/// J M^-1 J^T of the normals of a manifold; rows of points that a lane lacks are those of 1.
template <int D, int W, int N>
void couple_normals(const ContactBlock<D, W>& block, const Arms<D, Lanes<W>> (&arms)[N],
                    NormalProblem<N, Lanes<W>>& problem) {
  using L = Lanes<W>;
  Spin<D, L> moment_a[N];
  Spin<D, L> moment_b[N];
  const L linear = block.mass_a.inverse_mass + block.mass_b.inverse_mass;
  for (std::uint32_t i = 0; i < block.point_count; ++i) {
    moment_a[i] = moment(arms[i].r_a, block.normal);
    moment_b[i] = moment(arms[i].r_b, block.normal);
    const Spin<D, L> turned_a = turned_by<D, W>(block.mass_a, moment_a[i]);
    const Spin<D, L> turned_b = turned_by<D, W>(block.mass_b, moment_b[i]);
    const auto exists = block.points[i].normal_mass > L(0.0f);
    for (std::uint32_t j = 0; j <= i; ++j) {
      const L k = linear + dot(moment_a[j], turned_a) + dot(moment_b[j], turned_b);
      problem.k[i][j] = select(exists, k, L(i == j ? 1.0f : 0.0f));
      problem.k[j][i] = problem.k[i][j];
    }
  }
}

/// The normals of a manifold of up to four points; returns 1 where they are solved, else 0.
template <int D, int W>
Lanes<W> solve_manifold(const StepContext<D>& context, Sweep sweep, ContactBlock<D, W>& block,
                        MotionLanes<D, W>& a, MotionLanes<D, W>& b) {
  using L = Lanes<W>;
  constexpr int kPoints = Dim<D>::kManifoldPoints;
  const int count = static_cast<int>(block.point_count);
  const SoftnessLanes<W> soft = softness_of(context, block);
  Arms<D, L> arms[kPoints];
  L old[kPoints];
  L compliance[kPoints];
  NormalProblem<kPoints, L> problem;
  for (int i = 0; i < count; ++i) {
    const auto& point = block.points[i];
    arms[i] = arms_of(block, point);
    old[i] = point.normal_impulse;
    const L speed = relative_speed(block.normal, arms[i], a, b);
    const NormalRow<W> row = normal_row(context, sweep, block, soft, point, speed);
    const auto scaled = row.mass_scale > L(0.0f);  // Not in unused lanes.
    compliance[i] = L(1.0f) / select(scaled, row.mass_scale, L(1.0f)) - L(1.0f);
    problem.d[i] = speed + row.bias;
  }
  couple_normals(block, arms, problem);
  // What the rows' own impulses have done is taken out of the speeds, so x is the whole impulse.
  for (int i = 0; i < count; ++i) {
    L own = problem.k[i][0] * old[0];
    for (int j = 1; j < count; ++j) own = own + problem.k[i][j] * old[j];
    const auto exists = block.points[i].normal_mass > L(0.0f);
    problem.d[i] = select(exists, problem.d[i] - own, L(0.0f));
  }
  for (int i = 0; i < count; ++i)
    problem.k[i][i] = problem.k[i][i] + compliance[i] * problem.k[i][i];
  L x[kPoints];
  L usable;
  solve_normals(problem, count, x, usable);
  for (int i = 0; i < count; ++i)
    set_normal_impulse(select(usable > L(0.0f), x[i], old[i]), arms[i], block, block.points[i], a,
                       b);
  return usable;
}

/// The same for the two points of the plane.
template <int D, int W>
Lanes<W> solve_two_normals(const StepContext<D>& context, Sweep sweep, ContactBlock<D, W>& block,
                           MotionLanes<D, W>& a, MotionLanes<D, W>& b) {
  using L = Lanes<W>;
  L usable(0.0f);
  if (block.point_count == 2) {
    typename ContactBlock<D, W>::Point* points[2] = {&block.points[0], &block.points[1]};
    const SoftnessLanes<W> soft = softness_of(context, block);
    Arms<D, L> arms[2];
    L d[2];
    L compliance[2];
    L diagonal[2];
    for (int i = 0; i < 2; ++i) {
      arms[i] = arms_of(block, *points[i]);
      const L speed = relative_speed(block.normal, arms[i], a, b);
      const NormalRow<W> row = normal_row(context, sweep, block, soft, *points[i], speed);
      diagonal[i] = coupling(block, block.normal, arms[i], block.normal, arms[i]);
      compliance[i] = diagonal[i] * (L(1.0f) / row.mass_scale - L(1.0f));
      d[i] = speed + row.bias;
    }
    const L cross = coupling(block, block.normal, arms[0], block.normal, arms[1]);
    const L old[2] = {points[0]->normal_impulse, points[1]->normal_impulse};
    // What the rows' own impulses have done is taken out of the speeds, so x is the whole impulse.
    const PairProblem<W> problem = {diagonal[0] + compliance[0], cross, diagonal[1] + compliance[1],
                                    d[0] - (diagonal[0] * old[0] + cross * old[1]),
                                    d[1] - (cross * old[0] + diagonal[1] * old[1])};
    L x1;
    L x2;
    solve_pair(problem, x1, x2, usable);
    usable = select(points[1]->normal_mass > L(0.0f), usable, L(0.0f));
    const auto take = usable > L(0.0f);
    set_normal_impulse(select(take, x1, old[0]), arms[0], block, *points[0], a, b);
    set_normal_impulse(select(take, x2, old[1]), arms[1], block, *points[1], a, b);
  }
  return usable;
}

/// The normals of a manifold solved together: exact in one sweep for a box on a plane, where one
/// row after the other converges at ((1 - 1.5 b^2) / (1 + 1.5 b^2))^2 in the plane. A soft row adds
/// its compliance to the diagonal. In the plane a single point, and everywhere what is
/// ill-conditioned, goes row by row.
template <int D, int W>
void solve_normals_together(const StepContext<D>& context, Sweep sweep, ContactBlock<D, W>& block,
                            MotionLanes<D, W>& a, MotionLanes<D, W>& b) {
  Lanes<W> usable;
  if constexpr (Dim<D>::kTangents == 1)
    usable = solve_two_normals(context, sweep, block, a, b);
  else
    usable = solve_manifold(context, sweep, block, a, b);
  solve_normals_where(Lanes<W>(1.0f) - usable, context, sweep, block, a, b);
}

/// Normal and tangents of each point solved together: apart, sticking, or sliding with the tangent
/// impulse at friction times the normal one, against the way it would stick. One row after the
/// other cycles with period 2 and never converges where friction |K_nt| / K_nn >= 1 (a leaning
/// rod); this does not. Source: the three cases of the planar frictional point, Brach, "Rigid Body
/// Collisions" (1989); in space the direction of sliding is found by turn_against_slip.
template <int D, int W>
void solve_points_coupled(const StepContext<D>& context, Sweep sweep, ContactBlock<D, W>& block,
                          MotionLanes<D, W>& a, MotionLanes<D, W>& b) {
  using L = Lanes<W>;
  constexpr int kTangents = Dim<D>::kTangents;
  constexpr int kRows = 1 + kTangents;
  const SoftnessLanes<W> soft = softness_of(context, block);
  for (std::uint32_t p = 0; p < block.point_count; ++p) {
    auto& point = block.points[p];
    const Arms<D, L> arms = arms_of(block, point);
    const NormalRow<W> row =
        normal_row(context, sweep, block, soft, point, relative_speed(block.normal, arms, a, b));
    Vec<D, L> directions[kRows];
    L old[kRows];
    directions[0] = block.normal;
    old[0] = point.normal_impulse;
    for (int t = 0; t < kTangents; ++t) {
      directions[t + 1] = tangent_of(block, t);
      old[t + 1] = point.tangent_impulse[t];
    }
    L k[kRows][kRows];
    L d[kRows];
    for (int i = 0; i < kRows; ++i) {
      d[i] = relative_speed(directions[i], arms, a, b) + (i == 0 ? row.bias : L(0.0f));
      for (int j = 0; j < kRows; ++j) {
        k[i][j] = coupling(block, directions[i], arms, directions[j], arms);
        d[i] = d[i] - k[i][j] * old[j];
      }
    }
    k[0][0] = k[0][0] / row.mass_scale;
    L x[kRows];
    const L bounced = block.bounces ? block.extra->bounce_impulse[p] : L(0.0f);
    solve_cone(block.friction, bounced, k, d, x);
    for (int i = 0; i < kRows; ++i) x[i] = select(point.normal_mass > L(0.0f), x[i], old[i]);
    set_normal_impulse(x[0], arms, block, point, a, b);
    Vec<D, L> impulse = Vec<D, L>::zero();
    for (int t = 0; t < kTangents; ++t) {
      impulse += (x[t + 1] - old[t + 1]) * tangent_of(block, t);
      point.tangent_impulse[t] = x[t + 1];
    }
    apply_pair(impulse, arms, block, a, b);
  }
}

/// The normals of a manifold one after the other, from either end in turn.
template <int D, int W>
void solve_normals_in_turn(const StepContext<D>& context, Sweep sweep, ContactBlock<D, W>& block,
                           MotionLanes<D, W>& a, MotionLanes<D, W>& b) {
  const SoftnessLanes<W> soft = softness_of(context, block);
  if constexpr (kRowsAlong<D>) {
    solve_normals_along(context, sweep, block, soft, a, b);
  } else {
    for (std::uint32_t i = 0; i < block.point_count; ++i)
      solve_normal(context, sweep, block, soft,
                   block.points[point_in_turn(context, sweep, i, block.point_count)], a, b);
  }
}

/// The friction of its points, one after the other.
template <int D, int W>
void solve_frictions(const StepContext<D>& context, ContactBlock<D, W>& block, MotionLanes<D, W>& a,
                     MotionLanes<D, W>& b) {
  if constexpr (kRowsAlong<D>) {
    solve_frictions_along(context, block, a, b);
  } else {
    for (std::uint32_t i = 0; i < block.point_count; ++i) solve_friction(context, block, i, a, b);
  }
}

/// One sweep over the block: normals first, so that friction is held to the impulse of this sweep.
/// The other way round a relax sweep would hold it to the softened impulse of the biased sweep,
/// which is 3 % too small: a box on a slope then accelerates too fast.
template <int D, int W>
void solve_block(const StepContext<D>& context, Sweep sweep, ContactBlock<D, W>& block,
                 MotionLanes<D, W>& a, MotionLanes<D, W>& b) {
  const ContactBlockRows together = context.tuning.contact_block;
  if (together == ContactBlockRows::kNormals)
    solve_normals_together(context, sweep, block, a, b);
  else if (together == ContactBlockRows::kNormalFriction && sweep != Sweep::kPseudo)
    solve_points_coupled(context, sweep, block, a, b);
  else
    solve_normals_in_turn(context, sweep, block, a, b);
  if (sweep == Sweep::kPseudo) return;
  if (block.rolls) solve_rolling(block, a, b);
  if (block.rubs && together != ContactBlockRows::kNormalFriction)
    solve_frictions(context, block, a, b);
}

}  // namespace cycloid::solver
