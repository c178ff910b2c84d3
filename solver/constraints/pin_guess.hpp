#pragma once

#include "solver/constraints/pin_motions.hpp"

namespace cycloid::solver {

/// The warm start of pins; for the files that compile their kernels and no others (see
/// contact_sweeps.hpp). The formulas are those of joint_solve.hpp.

template <int W>
[[gnu::always_inline]] inline void add_rubbing(const PinBlock<2, W>&, PinImpulse<2, W>&) {}
template <int W>
[[gnu::always_inline]] inline void add_rubbing(const PinBlock<3, W>& block, PinImpulse<3, W>& sum) {
  if (!block.form.rubs) return;
  for (int i = 0; i < 3; ++i) {
    sum.angular_a[i] -= block.turns->rub_impulse[i];
    sum.angular_b[i] += block.turns->rub_impulse[i];
  }
}

template <int W>
[[gnu::always_inline]] inline void add_cone(const PinBlock<2, W>&, PinImpulse<2, W>&) {}
template <int W>
[[gnu::always_inline]] inline void add_cone(const PinBlock<3, W>& block, PinImpulse<3, W>& sum) {
  if (block.form.has_cone) add_couple(block.turns->swing, -block.turns->cone_impulse, sum);
}

template <int D, int W>
[[gnu::always_inline]] inline void add_turns(const PinBlock<D, W>& block, PinImpulse<D, W>& sum) {
  add_rubbing(block, sum);
  if (!block.form.has_motor && !block.form.has_limits) return;
  const PinTurns<D, W>& turns = *block.turns;
  add_couple(turns.axis, turns.lower_impulse - turns.upper_impulse, sum);
  add_couple(turns.axis, turns.motor_impulse, sum);
  add_cone(block, sum);
}

/// turn_square_of_guess.
template <int D, int W>
[[gnu::always_inline]] inline Lanes<W> turn_square_of_pin(
    const LaneMass<D, W>& mass, const Spin<D, Lanes<W>> (&angular)[Dim<D>::kPinEqualities],
    const Lanes<W>& force_square, const Spin<D, Lanes<W>>& torque) {
  using L = Lanes<W>;
  L answers(0.0f);
  L arms(1.0e-12f);
  for (int i = 0; i < D; ++i) {
    answers += dot(angular[i], turned_by<D, W>(mass, angular[i]));
    arms += dot(angular[i], angular[i]);
  }
  const Spin<D, L> turn = turned_by<D, W>(mass, torque);
  const L by_force = force_square * answers * answers / (L(static_cast<float>(D - 1)) * arms);
  return max(by_force, dot(turn, turn));
}

template <int W>
[[gnu::always_inline]] inline void scale_space_impulses(const Lanes<W>&, PinTurns<2, W>&) {}
template <int W>
[[gnu::always_inline]] inline void scale_space_impulses(const Lanes<W>& share,
                                                        PinTurns<3, W>& turns) {
  turns.cone_impulse = share * turns.cone_impulse;
  for (Lanes<W>& impulse : turns.rub_impulse) impulse = share * impulse;
}

template <int D, int W>
[[gnu::always_inline]] inline void scale_pin_impulses(const Lanes<W>& share,
                                                      PinBlock<D, W>& block) {
  for (int i = 0; i < equalities_of<D>(block.form); ++i)
    block.impulse[i] = share * block.impulse[i];
  if (block.turns == nullptr) return;
  PinTurns<D, W>& turns = *block.turns;
  turns.lower_impulse = share * turns.lower_impulse;
  turns.upper_impulse = share * turns.upper_impulse;
  turns.motor_impulse = share * turns.motor_impulse;
  scale_space_impulses(share, turns);
}

/// Leaves of the impulses what turns no body faster than `spin_max`, rad/s; all in lanes that an
/// island has solved.
/// @returns whether any has changed.
template <int D, int W>
[[gnu::always_inline]] inline bool keep_stable_share(float spin_max, const PinImpulse<D, W>& guess,
                                                     PinBlock<D, W>& block) {
  using L = Lanes<W>;
  L square(0.0f);
  for (int i = 0; i < D; ++i) square += block.impulse[i] * block.impulse[i];
  const L turn =
      max(turn_square_of_pin<D, W>(block.mass_a, block.angular_a, square, guess.angular_a),
          turn_square_of_pin<D, W>(block.mass_b, block.angular_b, square, guess.angular_b));
  const L beyond = select(mask_of<W>(block.settled), L(0.0f), turn - L(spin_max * spin_max));
  if (!any_above_zero(beyond)) return false;
  const auto is_beyond = beyond > L(0.0f);
  const L share = select(is_beyond, L(spin_max) / sqrt(select(is_beyond, turn, L(1.0f))), L(1.0f));
  scale_pin_impulses(share, block);
  return true;
}

template <int D, int W>
[[gnu::always_inline]] inline PinImpulse<D, W> impulse_of_pin(const PinBlock<D, W>& block,
                                                              bool all_rows) {
  PinImpulse<D, W> sum;
  for (int i = 0; i < equalities_of<D>(block.form); ++i)
    add_equality(block, i, block.impulse[i], sum);
  if (all_rows && block.turns != nullptr) add_turns(block, sum);
  return sum;
}

template <int D, int W>
void PinKernels<D, W>::warm_start(float spin_max, const PinRange<D, W>& range) {
  for (PinBlock<D, W>* block = range.begin; block != range.end; ++block) {
    PinMotions<D, W> motions = gather_velocities(range, *block);
    PinImpulse<D, W> sum = impulse_of_pin(*block, true);
    if (keep_stable_share(spin_max, sum, *block)) sum = impulse_of_pin(*block, true);
    apply(*block, sum, motions);
    scatter_velocities(range, *block, motions);
  }
}

template <int D, int W>
void PinKernels<D, W>::warm_start_equalities(const PinRange<D, W>& range) {
  for (PinBlock<D, W>* block = range.begin; block != range.end; ++block) {
    PinMotions<D, W> motions = gather_velocities(range, *block);
    apply(*block, impulse_of_pin(*block, false), motions);
    scatter_velocities(range, *block, motions);
  }
}

}  // namespace cycloid::solver
