#pragma once

#include "solver/constraints/pin_evaluation.hpp"
#include "solver/constraints/pin_guess.hpp"

namespace cycloid::solver {

/// The text of the kernels of pins, for the files that compile them and no others (see
/// contact_sweeps.hpp). The formulas are those of joint_solve.hpp.

/// kRigid or the joints' softness, as a value: a constant that is referred to would be defined by
/// this file too.
template <int W, int D>
[[gnu::always_inline]] inline Softness softness_of(const StepContext<D>& context, Sweep kind) {
  return kind == Sweep::kRelax ? Softness{0.0f, 1.0f, 0.0f} : context.joint;
}

/// An impulse along a couple that leaves the equalities as satisfied as they were (apply_held).
template <int N, int D, int W>
[[gnu::always_inline]] inline void turn_held(const Couple<D, W>& couple, const Lanes<W>& impulse,
                                             PinBlock<D, W>& block, PinMotions<D, W>& motions) {
  PinImpulse<D, W> sum;
  add_couple(couple, impulse, sum);
  for (int i = 0; i < N; ++i) {
    const Lanes<W> change = -couple.reaction[i] * impulse;
    add_equality(block, i, change, sum);
    block.impulse[i] += change;
  }
  apply(block, sum, motions);
}

/// |lambda| <= bound, at the speed that is wanted.
template <int N, int D, int W>
[[gnu::always_inline]] inline void solve_motor(PinBlock<D, W>& block, PinMotions<D, W>& motions) {
  using L = Lanes<W>;
  PinTurns<D, W>& turns = *block.turns;
  const L speed = speed_of_couple(turns.axis, motions);
  const L wanted = turns.motor_impulse - turns.axis.mass * (speed - turns.motor_speed);
  const L bound = turns.motor_impulse_max;
  const L accumulated = max(-bound, min(wanted, bound));
  turn_held<N>(turns.axis, accumulated - turns.motor_impulse, block, motions);
  turns.motor_impulse = accumulated;
}

/// As that of rows. @pre the couple is the motor's axis.
template <int D, int W>
[[gnu::always_inline]] inline Lanes<W> pressed_by_motor(const PinBlock<D, W>& block, float sign,
                                                        const Lanes<W>& impulse) {
  if (!block.form.has_motor) return Lanes<W>(0.0f);
  return max(min(Lanes<W>(-sign) * block.turns->motor_impulse, impulse), Lanes<W>(0.0f));
}

/// One limit along a couple, as solve_limit of rows.
/// @param sign  1 of a lower one, -1 of an upper.
template <int N, int D, int W>
[[gnu::always_inline]] inline void solve_limit(const StepContext<D>& context, Sweep kind,
                                               const Couple<D, W>& couple, const Lanes<W>& room,
                                               float sign, const Lanes<W>& pressed,
                                               Lanes<W>& impulse, PinBlock<D, W>& block,
                                               PinMotions<D, W>& motions) {
  using L = Lanes<W>;
  const Softness soft = softness_of<W>(context, kind);
  const auto open = room > L(0.0f);
  const L bias = select(open, room * L(context.inverse_h), L(soft.bias_rate) * room);
  const L mass_scale = select(open, L(1.0f), L(soft.mass_scale));
  const L impulse_scale = select(open, L(0.0f), L(soft.impulse_scale));
  const L speed = L(sign) * speed_of_couple(couple, motions);
  const L change = -couple.mass * mass_scale * (speed + bias) - impulse_scale * (impulse - pressed);
  const L accumulated = max(impulse + change, L(0.0f));
  turn_held<N>(couple, L(sign) * (accumulated - impulse), block, motions);
  impulse = accumulated;
}

template <int N, int W>
[[gnu::always_inline]] inline void solve_cone(const StepContext<2>&, Sweep, PinBlock<2, W>&,
                                              PinMotions<2, W>&) {}
template <int N, int W>
[[gnu::always_inline]] inline void solve_cone(const StepContext<3>& context, Sweep kind,
                                              PinBlock<3, W>& block, PinMotions<3, W>& motions) {
  using L = Lanes<W>;
  if (!block.form.has_cone) return;
  PinTurns<3, W>& turns = *block.turns;
  L impulse = turns.cone_impulse;
  solve_limit<N>(context, kind, turns.swing, turns.cone - turns.swing.angle, -1.0f, L(0.0f),
                 impulse, block, motions);
  turns.cone_impulse = select(turns.near > L(0.0f), impulse, turns.cone_impulse);
}

template <int M, int W>
[[gnu::always_inline]] inline void put_back(const typename Lanes<W>::Mask& keeps,
                                            const Vec<M, Lanes<W>>& before,
                                            Vec<M, Lanes<W>>& value) {
  for (int i = 0; i < M; ++i) value[i] = select(keeps, value[i], before[i]);
}

/// Puts the velocities of all other lanes back.
template <int D, int W>
[[gnu::always_inline]] inline void keep_where(const typename Lanes<W>::Mask& keeps,
                                              const PinMotions<D, W>& before,
                                              PinMotions<D, W>& motions) {
  put_back<D, W>(keeps, before.a.velocity, motions.a.velocity);
  put_back<Dim<D>::kSpin, W>(keeps, before.a.spin, motions.a.spin);
  put_back<D, W>(keeps, before.b.velocity, motions.b.velocity);
  put_back<Dim<D>::kSpin, W>(keeps, before.b.spin, motions.b.spin);
}

/// The limits, where they are near. Another lane's limit must not show, not even in the sign of a
/// zero, so lanes where none is near are put back.
template <int N, int D, int W>
[[gnu::always_inline]] inline void solve_limits(const StepContext<D>& context, Sweep kind,
                                                PinBlock<D, W>& block, PinMotions<D, W>& motions) {
  using L = Lanes<W>;
  PinTurns<D, W>& turns = *block.turns;
  if (!any_above_zero(turns.near)) return;
  L before[N];
  for (int i = 0; i < N; ++i) before[i] = block.impulse[i];
  const PinMotions<D, W> still = motions;
  const L angle = turns.axis.angle;
  L lower = turns.lower_impulse;
  L upper = turns.upper_impulse;
  solve_limit<N>(context, kind, turns.axis, angle - turns.lower, 1.0f,
                 pressed_by_motor(block, 1.0f, lower), lower, block, motions);
  solve_limit<N>(context, kind, turns.axis, turns.upper - angle, -1.0f,
                 pressed_by_motor(block, -1.0f, upper), upper, block, motions);
  solve_cone<N>(context, kind, block, motions);
  const auto near = turns.near > L(0.0f);
  turns.lower_impulse = select(near, lower, turns.lower_impulse);
  turns.upper_impulse = select(near, upper, turns.upper_impulse);
  for (int i = 0; i < N; ++i) block.impulse[i] = select(near, block.impulse[i], before[i]);
  keep_where(near, still, motions);
}

/// Friction about every axis: three rows at once, |lambda| <= bound.
template <int W>
[[gnu::always_inline]] inline void solve_rubbing(const StepContext<2>&, PinBlock<2, W>&,
                                                 PinMotions<2, W>&) {}
template <int W>
[[gnu::always_inline]] inline void solve_rubbing(const StepContext<3>& context,
                                                 PinBlock<3, W>& block, PinMotions<3, W>& motions) {
  using L = Lanes<W>;
  PinTurns<3, W>& turns = *block.turns;
  L change[3];
  for (int i = 0; i < 3; ++i) change[i] = motions.b.spin[i] - motions.a.spin[i];
  turns.rub_factor.solve(change, 3);
  L size(0.0f);
  for (int i = 0; i < 3; ++i) {
    change[i] = turns.rub_impulse[i] - L(context.tuning.over_relaxation) * change[i];
    size += change[i] * change[i];
  }
  const L bound = turns.rub_impulse_max;
  const auto slips = size > bound * bound;
  const L scale = select(slips, bound / sqrt(select(slips, size, L(1.0f))), L(1.0f));
  Vec<3, L> impulse;
  for (int i = 0; i < 3; ++i) {
    const L accumulated = scale * change[i];
    impulse[i] = accumulated - turns.rub_impulse[i];
    turns.rub_impulse[i] = accumulated;
  }
  motions.a.spin += turned_by<3, W>(block.mass_a, -impulse);
  motions.b.spin += turned_by<3, W>(block.mass_b, impulse);
}

template <int W>
[[gnu::always_inline]] inline Lanes<W> less_asked_by_cone(const PinBlock<2, W>&, int,
                                                          const Lanes<W>& load) {
  return load;
}
template <int W>
[[gnu::always_inline]] inline Lanes<W> less_asked_by_cone(const PinBlock<3, W>& block, int i,
                                                          const Lanes<W>& load) {
  if (!block.form.has_cone) return load;
  const PinTurns<3, W>& turns = *block.turns;
  const auto near = turns.near > Lanes<W>(0.0f);
  return select(near, load - turns.swing.reaction[i] * turns.cone_impulse, load);
}

/// An equality's impulse without what motor and limits have asked of it (as that of rows).
/// Another lane's limit must not show, not even in the sign of a zero. @pre limits or a motor act.
template <int D, int W>
[[gnu::always_inline]] inline Lanes<W> load_of_equality(const PinBlock<D, W>& block, int i) {
  using L = Lanes<W>;
  const PinTurns<D, W>& turns = *block.turns;
  const L& reaction = turns.axis.reaction[i];
  const L asked =
      reaction * (turns.lower_impulse - turns.upper_impulse) + reaction * turns.motor_impulse;
  const L load = block.impulse[i] + asked;
  const auto near = turns.near > L(0.0f);
  const L taken = block.form.has_motor ? load : select(near, load, block.impulse[i]);
  return block.form.has_limits ? less_asked_by_cone(block, i, taken) : taken;
}

/// Whether motor or limits push in any lane, so that what they ask of the equalities is known.
template <int D, int W>
[[gnu::always_inline]] inline bool turns_act(const PinBlock<D, W>& block) {
  return block.form.has_motor || (block.form.has_limits && any_above_zero(block.turns->near));
}

/// lambda' = lambda - mass_scale K^-1 (Jv + bias_rate C) - impulse_scale load, as solve_block.
template <int N, int D, int W>
[[gnu::always_inline]] inline void solve_equalities(const StepContext<D>& context, Sweep kind,
                                                    PinBlock<D, W>& block,
                                                    PinMotions<D, W>& motions) {
  using L = Lanes<W>;
  const Softness soft = softness_of<W>(context, kind);
  const bool is_asked = kind == Sweep::kBiased && turns_act(block);
  L change[Dim<D>::kPinEqualities];
  for (int i = 0; i < N; ++i)
    change[i] = speed_of_equality(block, i, motions) + L(soft.bias_rate) * block.error[i];
  block.factor.solve(change, N);
  PinImpulse<D, W> sum;
  for (int i = 0; i < N; ++i) {
    const L old = block.impulse[i];
    const L load = is_asked ? load_of_equality(block, i) : old;
    const L wanted = old - L(context.tuning.over_relaxation) *
                               (L(soft.mass_scale) * change[i] + L(soft.impulse_scale) * load);
    add_equality(block, i, wanted - old, sum);
    block.impulse[i] = wanted;
  }
  apply(block, sum, motions);
}

/// The same in the lanes of `acting`: others, which an island has solved, keep every bit, whoever
/// shares their block.
template <int N, int D, int W>
[[gnu::always_inline]] inline void solve_acting(const StepContext<D>& context, Sweep kind,
                                                LaneBits acting, PinBlock<D, W>& block,
                                                PinMotions<D, W>& motions) {
  if (acting == block.used) return solve_equalities<N>(context, kind, block, motions);
  if (acting == 0) return;
  Lanes<W> before[N];
  for (int i = 0; i < N; ++i) before[i] = block.impulse[i];
  const PinMotions<D, W> still = motions;
  solve_equalities<N>(context, kind, block, motions);
  const auto acts = mask_of<W>(acting);
  for (int i = 0; i < N; ++i) block.impulse[i] = select(acts, block.impulse[i], before[i]);
  keep_where(acts, still, motions);
}

/// One sweep over a pin, in the order of joint_solve.hpp.
template <int N, int D, int W>
[[gnu::always_inline]] inline void sweep_pin(const StepContext<D>& context, Sweep kind,
                                             const PinRange<D, W>& range, PinBlock<D, W>& block) {
  const PinForm& form = block.form;
  const LaneBits passed = kind == Sweep::kRelax ? block.settled & ~block.relaxes : block.settled;
  const LaneBits acting = block.used & ~passed;
  if (acting == 0 && !form.has_motor && !form.has_limits) return;
  PinMotions<D, W> motions = gather_velocities(range, block);
  if (form.rubs && form.has_cone) solve_rubbing(context, block, motions);
  if (form.has_motor) solve_motor<N>(block, motions);
  if (form.has_limits) solve_limits<N>(context, kind, block, motions);
  solve_acting<N>(context, kind, acting, block, motions);
  if (form.rubs && !form.has_cone) solve_rubbing(context, block, motions);
  scatter_velocities(range, block, motions);
}

template <int D, int W>
void PinKernels<D, W>::evaluate(float limit_reach_s, const PinRange<D, W>& range) {
  for (PinBlock<D, W>* block = range.begin; block != range.end; ++block)
    evaluate_pin(limit_reach_s, range, *block);
}

template <int D, int W>
void PinKernels<D, W>::look_for_rest(const StepContext<D>& context, const JointBounds& bounds,
                                     const PinRange<D, W>& range) {
  using L = Lanes<W>;
  for (PinBlock<D, W>* block = range.begin; block != range.end; ++block) {
    const PinMotions<D, W> motions = gather_velocities(range, *block);
    const int count = equalities_of<D>(block->form);
    L most(0.0f);
    for (int i = 0; i < count; ++i) {
      const L missing =
          speed_of_equality(*block, i, motions) + L(context.joint.bias_rate) * block->error[i];
      most = max(most, absolute(missing));
    }
    block->rest.misses = lanes_above_zero(most - L(bounds.misses));
    block->rest.stirs = lanes_above_zero(most - L(bounds.stirs));
    block->rest.is_wild = lanes_above_zero(most - L(bounds.is_wild));
  }
}

template <int D, int W>
void PinKernels<D, W>::sweep(const StepContext<D>& context, Sweep kind,
                             const PinRange<D, W>& range) {
  for (PinBlock<D, W>* block = range.begin; block != range.end; ++block) {
    if (block->form.is_hinge)
      sweep_pin<Dim<D>::kPinEqualities>(context, kind, range, *block);
    else
      sweep_pin<D>(context, kind, range, *block);
  }
}

}  // namespace cycloid::solver
