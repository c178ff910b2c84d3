#pragma once

#include "solver/constraints/joint_bounds.hpp"
#include "solver/constraints/pin_motions.hpp"
#include "solver/constraints/trig_lanes.hpp"

namespace cycloid::solver {

/// C, J and K^-1 of pins: the formulas of joint_row.cpp, rows.hpp and swing_twist.cpp, in lanes.

/// Bodies of a pin as its rows see them (JointFrame).
template <int D, int W>
struct PinFrame {
  PinMotions<D, W> motions;
  Rotation<D, Lanes<W>> rotation_a;
  Rotation<D, Lanes<W>> rotation_b;
};

template <int W>
[[gnu::always_inline]] inline Lanes<W> absolute(const Lanes<W>& a) {
  return select(a < Lanes<W>(0.0f), -a, a);
}

/// The inverse rotation.
template <int W>
[[gnu::always_inline]] inline Rotation<2, Lanes<W>> turned_back(const Rotation<2, Lanes<W>>& q) {
  return {{q[0], -q[1]}};
}
template <int W>
[[gnu::always_inline]] inline Rotation<3, Lanes<W>> turned_back(const Rotation<3, Lanes<W>>& q) {
  return {{-q[0], -q[1], -q[2], q[3]}};
}

template <int D, int W>
[[gnu::always_inline]] inline Rotation<D, Lanes<W>> relative_of(const PinFrame<D, W>& frame,
                                                                const PinTurns<D, W>& turns) {
  return compose(turned_back<W>(turns.reference),
                 compose(turned_back<W>(frame.rotation_a), frame.rotation_b));
}

/// The rows of the point (append_point_rows).
template <int D, int W>
[[gnu::always_inline]] inline void set_point_rows(const PinFrame<D, W>& frame,
                                                  PinBlock<D, W>& block) {
  using L = Lanes<W>;
  const PinMotions<D, W>& motions = frame.motions;
  const Vec<D, L> r_a = rotate(frame.rotation_a, block.anchor_a);
  const Vec<D, L> r_b = rotate(frame.rotation_b, block.anchor_b);
  const Vec<D, L> centre_offset =
      block.centre_offset + (motions.b.delta_position - motions.a.delta_position);
  const Vec<D, L> offset = centre_offset + (r_b - r_a);
  const Vec<D, L> arm_a = r_a + offset;
  rotated_axes(frame.rotation_a, block.direction);
  for (int i = 0; i < D; ++i) {
    block.angular_a[i] = -moment(arm_a, block.direction[i]);
    block.angular_b[i] = moment(r_b, block.direction[i]);
    block.error[i] = dot(block.direction[i], offset);
  }
}

/// K of the equalities, factored.
template <int N, int D, int W>
[[gnu::always_inline]] inline void factor_equalities(PinBlock<D, W>& block) {
  using L = Lanes<W>;
  constexpr int kMost = Dim<D>::kPinEqualities;
  L k[kMost][kMost];
  for (int j = 0; j < N; ++j) {
    const Spin<D, L> angular_a = turned_by<D, W>(block.mass_a, block.angular_a[j]);
    const Spin<D, L> angular_b = turned_by<D, W>(block.mass_b, block.angular_b[j]);
    for (int i = j; i < N; ++i) {
      L of_a = dot(block.angular_a[i], angular_a);
      L of_b = dot(block.angular_b[i], angular_b);
      if (j < D && i < D) {
        of_a = of_a + dot(block.direction[i], block.mass_a.inverse_mass * block.direction[j]);
        of_b = of_b + dot(block.direction[i], block.mass_b.inverse_mass * block.direction[j]);
      }
      k[i][j] = of_a + of_b;
    }
  }
  block.factor.factor(k, N);
}

/// What an impulse along a couple does with the equalities held (hold_block).
template <int N, int D, int W>
[[gnu::always_inline]] inline void hold_couple(const PinBlock<D, W>& block, Couple<D, W>& couple) {
  using L = Lanes<W>;
  const Spin<D, L> turned_a = turned_by<D, W>(block.mass_a, couple.direction);
  const Spin<D, L> turned_b = turned_by<D, W>(block.mass_b, couple.direction);
  const L k = dot(couple.direction, turned_a) + dot(couple.direction, turned_b);
  L across[N];
  for (int i = 0; i < N; ++i) {
    across[i] = dot(block.angular_b[i], turned_b) - dot(block.angular_a[i], turned_a);
    couple.reaction[i] = across[i];
  }
  block.factor.solve(couple.reaction, N);
  L left = k;
  for (int i = 0; i < N; ++i) left -= across[i] * couple.reaction[i];
  const auto gives = left > L(1.0e-6f) * k;
  couple.mass = select(gives, L(1.0f) / select(gives, left, L(1.0f)), L(0.0f));
}

/// angle_near.
template <int W>
[[gnu::always_inline]] inline Lanes<W> angle_near(const Lanes<W>& angle, const Lanes<W>& middle) {
  using L = Lanes<W>;
  const L beyond = angle - middle;
  const L less = select(beyond > L(kPi), angle - L(2.0f * kPi), angle);
  return select(beyond < L(-kPi), angle + L(2.0f * kPi), less);
}

/// angle_between_limits.
template <int D, int W>
[[gnu::always_inline]] inline Lanes<W> angle_between_limits(const Lanes<W>& angle,
                                                            const PinBlock<D, W>& block) {
  const PinTurns<D, W>& turns = *block.turns;
  const Lanes<W> middle = Lanes<W>(0.5f) * (turns.lower + turns.upper);
  return block.form.has_limits ? angle_near(angle, middle) : angle;
}

/// Above 0 where a limit of the axis pushes already or could be reached soon (limit_is_near).
template <int D, int W>
[[gnu::always_inline]] inline Lanes<W> limit_is_near(float reach_s, const PinTurns<D, W>& turns,
                                                     const PinMotions<D, W>& motions) {
  using L = Lanes<W>;
  const L speed = speed_of_couple(turns.axis, motions);
  const L reach = L(kLimitRoom) + L(reach_s) * absolute(speed);
  const L room = min(turns.axis.angle - turns.lower, turns.upper - turns.axis.angle);
  const L pushes = max(turns.lower_impulse, turns.upper_impulse);
  return select(pushes > L(0.0f), L(1.0f), select(room < reach, L(1.0f), L(0.0f)));
}

template <int W>
[[gnu::always_inline]] inline Lanes<W> cone_is_near(float reach_s, const PinTurns<3, W>& turns,
                                                    const PinMotions<3, W>& motions) {
  using L = Lanes<W>;
  const L way = L(reach_s) * absolute(speed_of_couple(turns.swing, motions));
  const L room = turns.cone - turns.swing.angle;
  return select(turns.cone_impulse > L(0.0f), L(1.0f),
                select(room < L(kLimitRoom) + way, L(1.0f), L(0.0f)));
}

/// In the plane the coordinate is the angle of b relative to a.
template <int N, int W>
[[gnu::always_inline]] inline void evaluate_turns(float limit_reach_s, const PinFrame<2, W>& frame,
                                                  PinBlock<2, W>& block) {
  PinTurns<2, W>& turns = *block.turns;
  const Rotation<2, Lanes<W>> relative = relative_of(frame, turns);
  turns.axis.direction[0] = Lanes<W>(1.0f);
  turns.axis.angle = angle_between_limits(atan2(relative[1], relative[0]), block);
  hold_couple<N>(block, turns.axis);
  if (block.form.has_limits) turns.near = limit_is_near(limit_reach_s, turns, frame.motions);
}

/// The axis of a and the same axis as b carries it, in the world (AxisPair).
template <int W>
struct PinAxes {
  Vec<3, Lanes<W>> of_a;
  Vec<3, Lanes<W>> of_b;
};

template <int W>
[[gnu::always_inline]] inline PinAxes<W> axes_of(const PinFrame<3, W>& frame,
                                                 const PinTurns<3, W>& turns) {
  return {rotate(frame.rotation_a, turns.axis_a), rotate(frame.rotation_b, turns.axis_b)};
}

/// The two rows that keep a hinge's axis (append_axis_rows).
template <int W>
[[gnu::always_inline]] inline void set_axis_rows(const PinFrame<3, W>& frame,
                                                 PinBlock<3, W>& block) {
  using L = Lanes<W>;
  const PinAxes<W> axes = axes_of(frame, *block.turns);
  const Vec<3, L> error = cross(axes.of_a, axes.of_b);
  const L inverse = L(1.0f) / max(L(1.0f) + dot(axes.of_a, axes.of_b), L(kLeastTogether));
  for (int i = 0; i < 2; ++i) {
    const Vec<3, L> t = rotate(frame.rotation_a, block.turns->across[i]);
    const L part = inverse * dot(t, error);
    block.angular_b[3 + i] =
        (L(2.0f) * inverse) * (cross(axes.of_b, cross(t, axes.of_a)) + part * error);
    block.angular_a[3 + i] = -block.angular_b[3 + i];
    block.error[3 + i] = L(2.0f) * part;
  }
}

/// twist_row.
template <int W>
[[gnu::always_inline]] inline void set_twist(const PinFrame<3, W>& frame, const PinAxes<W>& axes,
                                             PinBlock<3, W>& block) {
  using L = Lanes<W>;
  PinTurns<3, W>& turns = *block.turns;
  const Rotation<3, L> q = relative_of(frame, turns);
  const L along = dot(Vec<3, L>{{q[0], q[1], q[2]}}, turns.axis_b);
  const auto flip = (q[3] < L(0.0f)) | ((q[3].raw == 0.0f) & (along < L(0.0f)));
  const L angle = L(2.0f) * atan2(select(flip, -along, along), select(flip, -q[3], q[3]));
  const L both = L(1.0f) + dot(axes.of_a, axes.of_b);
  const auto apart = both < L(kLeastTogether);
  const L scale = select(apart, L(0.0f), L(1.0f) / select(apart, L(1.0f), both));
  turns.axis.direction = scale * (axes.of_a + axes.of_b);
  turns.axis.angle = select(apart, L(0.0f), angle_between_limits(angle, block));
}

/// swing_row.
template <int W>
[[gnu::always_inline]] inline void set_swing(const PinAxes<W>& axes, Couple<3, W>& swing) {
  using L = Lanes<W>;
  const Vec<3, L> normal = cross(axes.of_a, axes.of_b);
  const L sine = sqrt(dot(normal, normal));
  Vec<3, L> across[2];
  tangents(axes.of_a, across);
  const auto slanted = sine > L(1.0e-6f);
  const L inverse = L(1.0f) / select(slanted, sine, L(1.0f));
  for (int i = 0; i < 3; ++i)
    swing.direction[i] = select(slanted, inverse * normal[i], across[0][i]);
  swing.angle = atan2(sine, dot(axes.of_a, axes.of_b));
}

/// K of friction about every axis: the inertias.
template <int W>
[[gnu::always_inline]] inline void factor_rubbing(PinBlock<3, W>& block) {
  Lanes<W> k[3][3];
  for (int j = 0; j < 3; ++j)
    for (int i = j; i < 3; ++i)
      k[i][j] = block.mass_a.inverse_inertia[i * 3 + j] + block.mass_b.inverse_inertia[i * 3 + j];
  block.turns->rub_factor.factor(k, 3);
}

template <int N, int W>
[[gnu::always_inline]] inline void evaluate_turns(float limit_reach_s, const PinFrame<3, W>& frame,
                                                  PinBlock<3, W>& block) {
  PinTurns<3, W>& turns = *block.turns;
  const PinForm& form = block.form;
  if (form.rubs) factor_rubbing(block);
  if (!form.has_motor && !form.has_limits) return;
  const PinAxes<W> axes = axes_of(frame, turns);
  set_twist(frame, axes, block);
  if (form.has_limits) turns.near = limit_is_near(limit_reach_s, turns, frame.motions);
  if (form.has_cone) {
    set_swing(axes, turns.swing);
    turns.near = max(turns.near, cone_is_near(limit_reach_s, turns, frame.motions));
  }
  const bool limits_act = form.has_limits && any_above_zero(turns.near);
  if (form.has_motor || limits_act) hold_couple<N>(block, turns.axis);
  if (form.has_cone && limits_act) hold_couple<N>(block, turns.swing);
}

/// What the form has beside the rows of the point, and K. @pre those are set.
template <int W>
[[gnu::always_inline]] inline void set_other_rows(float limit_reach_s, const PinFrame<2, W>& frame,
                                                  PinBlock<2, W>& block) {
  factor_equalities<2>(block);
  if (block.turns != nullptr) evaluate_turns<2>(limit_reach_s, frame, block);
}
template <int W>
[[gnu::always_inline]] inline void set_other_rows(float limit_reach_s, const PinFrame<3, W>& frame,
                                                  PinBlock<3, W>& block) {
  if (block.form.is_hinge) {
    set_axis_rows(frame, block);
    factor_equalities<5>(block);
    return evaluate_turns<5>(limit_reach_s, frame, block);
  }
  factor_equalities<3>(block);
  if (block.turns != nullptr) evaluate_turns<3>(limit_reach_s, frame, block);
}

template <int D, int W>
[[gnu::always_inline]] inline void evaluate_pin(float limit_reach_s, const PinRange<D, W>& range,
                                                PinBlock<D, W>& block) {
  const PinMotions<D, W> motions{gather<D, W>(range.motions, block.body_a),
                                 gather<D, W>(range.motions, block.body_b)};
  const PinFrame<D, W> frame{motions, compose(motions.a.delta_rotation, block.rotation_a),
                             compose(motions.b.delta_rotation, block.rotation_b)};
  set_point_rows(frame, block);
  set_other_rows(limit_reach_s, frame, block);
}

}  // namespace cycloid::solver
