#pragma once

#include <cstddef>

#include "solver/bodies/body_kernels.hpp"
#include "solver/bodies/turn_freely.hpp"
#include "solver/constraints/motion_lanes.hpp"

namespace cycloid::solver {

/// The text of BodyKernels::move_in_space: turn_freely with selects for its branches. Every
/// function is a template on W.

/// What of W bodies decides how they turn, one in each lane.
template <int W>
struct TurningBodies {
  Rotation<3, Lanes<W>> rotation;
  Lanes<W> inertia[9];
  Lanes<W> inverse_inertia[9];
  typename Lanes<W>::Mask tumbles;  ///< Where the body does not keep its spin.
};

template <int W>
[[gnu::always_inline]] inline TurningBodies<W> gather_bodies(const Body<3>* bodies,
                                                             const LaneIndices<W>& slots) {
  using L = Lanes<W>;
  constexpr int kRotationAt = (kMotionAt<3> + offsetof(BodyMotion<3>, rotation)) / sizeof(float);
  constexpr int kInertiaAt = offsetof(BodyProperties<3>, inertia) / sizeof(float);
  constexpr int kBoth = 18;  // Inertia and inverse inertia lie side by side.
  static_assert(offsetof(BodyProperties<3>, inverse_inertia) ==
                offsetof(BodyProperties<3>, inertia) + kBoth / 2 * sizeof(float));
  TurningBodies<W> in_lanes;
  L columns[4];
  gather_floats<W>(bodies, slots, kRotationAt, columns);
  for (int i = 0; i < 4; ++i) in_lanes.rotation[i] = columns[i];
  // The last four overlap those before them.
  for (const int first : {0, 4, 8, 12, kBoth - 4}) {
    gather_floats<W>(bodies, slots, kInertiaAt + first, columns);
    for (int i = 0; i < 4; ++i) {
      const int at = first + i;
      (at < 9 ? in_lanes.inertia[at] : in_lanes.inverse_inertia[at - 9]) = columns[i];
    }
  }
  L tumbles;
  for (int lane = 0; lane < kLaneCount<W>; ++lane)
    tumbles.raw[lane] = keeps_its_spin(bodies[slots[lane]]) ? 0.0f : 1.0f;
  in_lanes.tumbles = tumbles > L(0.0f);
  return in_lanes;
}

template <int N, int W>
[[gnu::always_inline]] inline void choose(typename Lanes<W>::Mask mask, const Vec<N, Lanes<W>>& yes,
                                          Vec<N, Lanes<W>>& or_as_it_is) {
  for (int i = 0; i < N; ++i) or_as_it_is[i] = select(mask, yes[i], or_as_it_is[i]);
}

template <int W>
[[gnu::always_inline]] inline bool any(typename Lanes<W>::Mask mask) {
  return any_above_zero(select(mask, Lanes<W>(1.0f), Lanes<W>(0.0f)));
}

template <int W>
[[gnu::always_inline]] inline typename Lanes<W>::Mask is_large(const Spin<3, Lanes<W>>& turn) {
  return ~(dot(turn, turn) < Lanes<W>(kSmallTurnSquare));
}

/// What Newton's method finds of the spin in the middle, from `spin`, in lanes that tumble.
/// @returns false where a turn on the way is too large for a series.
template <int W>
[[gnu::always_inline]] inline bool find_middle(Lanes<W> half, const TurningBodies<W>& bodies,
                                               const Spin<3, Lanes<W>>& spin,
                                               const Spin<3, Lanes<W>>& momentum,
                                               Spin<3, Lanes<W>>& middle) {
  using L = Lanes<W>;
  typename L::Mask open = bodies.tumbles;
  const L enough = L(kMidpointAccuracy) * dot(spin, spin);
  for (int i = 0; i < kMidpointIterations && any<W>(open); ++i) {
    const Spin<3, L> turn = half * (spin + middle);
    if (any<W>(open & is_large<W>(turn))) return false;
    const Spin<3, L> change = small_turned_back_change(turn, momentum);
    const Spin<3, L> moved = solve_turning(bodies.inertia, -half * (momentum + change),
                                           change - times(bodies.inertia, middle));
    choose<3, W>(open, middle + moved, middle);
    open = open & ~(dot(moved, moved).raw <= enough.raw);
  }
  return true;
}

template <int W>
[[gnu::always_inline]] inline void turn_lanes_by(const Rotation<3, Lanes<W>>& by,
                                                 typename Lanes<W>::Mask mask,
                                                 Rotation<3, Lanes<W>>& q) {
  using L = Lanes<W>;
  const Rotation<3, L> turned = compose(by, q);
  const L size = sqrt(dot(turned, turned));
  const auto has_size = size > L(1.0e-12f);
  choose<4, W>(mask & has_size, (L(1.0f) / select(has_size, size, L(1.0f))) * turned, q);
}

template <int W>
bool BodyKernels<W>::move_in_space(float h, const Body<3>* bodies, const std::uint32_t* slots,
                                   Motion<3>* motions) {
  using L = Lanes<W>;
  LaneIndices<W> in_lane;
  for (int lane = 0; lane < kLaneCount<W>; ++lane) in_lane[lane] = slots[lane];
  MotionLanes<3, W> motion = gather<3, W>(motions, in_lane);
  const TurningBodies<W> of = gather_bodies<W>(bodies, in_lane);
  const Rotation<3, L> before = compose(motion.delta_rotation, of.rotation);
  const Spin<3, L> spin = rotate_back(before, motion.spin);
  const Spin<3, L> momentum = times(of.inertia, spin);
  Spin<3, L> middle = Spin<3, L>::zero();
  if (!find_middle<W>(L(0.5f * h), of, spin, momentum, middle)) return false;
  const Spin<3, L> turn = L(h) * (spin + middle);
  Spin<3, L> turn_in_world = L(h) * motion.spin;
  choose<3, W>(of.tumbles, rotate(before, turn), turn_in_world);
  if (any<W>(is_large<W>(turn_in_world) | (of.tumbles & is_large<W>(turn)))) return false;
  const L square = dot(turn_in_world, turn_in_world);
  const Rotation<3, L> by = small_rotation_by(turn_in_world, square);
  turn_lanes_by<W>(by, of.tumbles | (square.raw != L(0.0f).raw), motion.delta_rotation);
  const Rotation<3, L> after = compose(motion.delta_rotation, of.rotation);
  choose<3, W>(
      of.tumbles,
      rotate(by, motion.spin) +
          rotate(after, times(of.inverse_inertia, small_turned_back_change(turn, momentum))),
      motion.spin);
  motion.delta_position += L(h) * motion.velocity;
  scatter_quads<0, kPoseQuads<3>>(motion, kAllLanes<W>, in_lane, motions);
  return true;
}

}  // namespace cycloid::solver
