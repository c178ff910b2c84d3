#pragma once

#include "solver/constraints/lane_bits.hpp"
#include "solver/constraints/pin_kernels.hpp"

namespace cycloid::solver {

/// What the kernels of pins do with both bodies; for the files that compile them and no others (see
/// contact_sweeps.hpp). The formulas are those of joint_row.hpp.

template <int D, int W>
struct PinMotions {
  MotionLanes<D, W> a;
  MotionLanes<D, W> b;
};

/// What several rows push both bodies with: N s on b, as much against it on a, and N m s.
template <int D, int W>
struct PinImpulse {
  Vec<D, Lanes<W>> linear = Vec<D, Lanes<W>>::zero();
  Spin<D, Lanes<W>> angular_a = Spin<D, Lanes<W>>::zero();
  Spin<D, Lanes<W>> angular_b = Spin<D, Lanes<W>>::zero();
};

template <int D, int W>
[[gnu::always_inline]] inline PinMotions<D, W> gather_velocities(const PinRange<D, W>& range,
                                                                 const PinBlock<D, W>& block) {
  PinMotions<D, W> motions;
  gather_quads<kVelocityQuads<D>>(range.motions, block.body_a, motions.a);
  gather_quads<kVelocityQuads<D>>(range.motions, block.body_b, motions.b);
  return motions;
}

template <int D, int W>
[[gnu::always_inline]] inline void scatter_velocities(const PinRange<D, W>& range,
                                                      const PinBlock<D, W>& block,
                                                      PinMotions<D, W>& motions) {
  scatter(motions.a, block.moves_a, block.body_a, range.motions);
  scatter(motions.b, block.moves_b, block.body_b, range.motions);
}

template <int D, int W>
[[gnu::always_inline]] inline void add_equality(const PinBlock<D, W>& block, int i,
                                                const Lanes<W>& impulse, PinImpulse<D, W>& sum) {
  if (i < D) sum.linear += impulse * block.direction[i];
  sum.angular_a += impulse * block.angular_a[i];
  sum.angular_b += impulse * block.angular_b[i];
}

template <int D, int W>
[[gnu::always_inline]] inline void add_couple(const Couple<D, W>& couple, const Lanes<W>& impulse,
                                              PinImpulse<D, W>& sum) {
  sum.angular_a -= impulse * couple.direction;
  sum.angular_b += impulse * couple.direction;
}

template <int D, int W>
[[gnu::always_inline]] inline void apply(const PinBlock<D, W>& block, const PinImpulse<D, W>& sum,
                                         PinMotions<D, W>& motions) {
  motions.a.velocity -= block.mass_a.inverse_mass * sum.linear;
  motions.a.spin += turned_by<D, W>(block.mass_a, sum.angular_a);
  motions.b.velocity += block.mass_b.inverse_mass * sum.linear;
  motions.b.spin += turned_by<D, W>(block.mass_b, sum.angular_b);
}

template <int D, int W>
[[gnu::always_inline]] inline Lanes<W> speed_of_equality(const PinBlock<D, W>& block, int i,
                                                         const PinMotions<D, W>& motions) {
  const Lanes<W> turning_a = dot(block.angular_a[i], motions.a.spin);
  const Lanes<W> turning_b = dot(block.angular_b[i], motions.b.spin);
  if (i >= D) return turning_a + turning_b;
  return (turning_a - dot(block.direction[i], motions.a.velocity)) +
         (dot(block.direction[i], motions.b.velocity) + turning_b);
}

template <int D, int W>
[[gnu::always_inline]] inline Lanes<W> speed_of_couple(const Couple<D, W>& couple,
                                                       const PinMotions<D, W>& motions) {
  return dot(couple.direction, motions.b.spin) - dot(couple.direction, motions.a.spin);
}

}  // namespace cycloid::solver
