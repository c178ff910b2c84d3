#pragma once

#include <cstddef>

#include "solver/bodies/body_kernels.hpp"
#include "solver/bodies/passing.hpp"
#include "solver/bodies/slots_in_lanes.hpp"
#include "solver/constraints/motion_lanes.hpp"

namespace cycloid::solver {

/// The text of BodyKernels::can_pass. Every function is a template on W.

/// Lanes of bodies that forces move.
template <int D, int W>
[[gnu::always_inline]] inline typename Lanes<W>::Mask respond_in_lanes(
    const Body<D>* bodies, const LaneIndices<W>& slots) {
  static_assert(BodyKind::kDynamic > BodyKind::kKinematic &&
                BodyKind::kParticle > BodyKind::kKinematic);
  constexpr int kKindAt = offsetof(BodyProperties<D>, kind) / sizeof(float);
  Lanes<W> columns[4];
  gather_floats<W>(bodies, slots, kKindAt, columns);
  typename Lanes<W>::Mask kinds;
  std::memcpy(&kinds, &columns[0].raw, sizeof kinds);
  return kinds > static_cast<int>(BodyKind::kKinematic);
}

template <int D, int W>
[[gnu::always_inline]] inline PassingBody<D, Lanes<W>> gather_passing(const Body<D>* bodies,
                                                                      const Motion<D>* motions,
                                                                      const LaneIndices<W>& slots) {
  using L = Lanes<W>;
  constexpr int kPositionAt = (kMotionAt<D> + offsetof(BodyMotion<D>, position)) / sizeof(float);
  constexpr int kExtentAt = offsetof(BodyProperties<D>, extent) / sizeof(float);
  static_assert(offsetof(BodyProperties<D>, thickness) ==
                offsetof(BodyProperties<D>, extent) + sizeof(float));
  static_assert(sizeof(Body<D>) >= offsetof(BodyProperties<D>, extent) + sizeof(Quad));
  L place[4];
  L sizes[4];
  gather_floats<W>(bodies, slots, kPositionAt, place);
  gather_floats<W>(bodies, slots, kExtentAt, sizes);
  const MotionLanes<D, W> motion = gather<D, W>(motions, slots);
  PassingBody<D, L> body;
  for (int i = 0; i < D; ++i) body.position[i] = place[i];
  body.extent = sizes[0];
  body.thickness = select(respond_in_lanes<D, W>(bodies, slots), sizes[1], L(kUnyielding));
  body.spin = motion.spin;
  body.delta_position = motion.delta_position;
  body.delta_rotation = motion.delta_rotation;
  return body;
}

template <int D, int W>
[[gnu::always_inline]] inline std::uint64_t which_can_pass(float tick_s, const Body<D>* bodies,
                                                           const Motion<D>* motions,
                                                           const BodyPairs& pairs) {
  std::uint64_t passing = 0;
  for (int begin = 0; begin < pairs.count; begin += kLaneCount<W>) {
    LaneIndices<W> a;
    LaneIndices<W> b;
    const int left = pairs.count - begin;
    const LaneBits used = take_slots<W>(pairs.a + begin, left, a);
    take_slots<W>(pairs.b + begin, left, b);
    const Lanes<W> passes =
        solver::can_pass<D, Lanes<W>>(Lanes<W>(tick_s), gather_passing<D, W>(bodies, motions, a),
                                      gather_passing<D, W>(bodies, motions, b));
    passing |= std::uint64_t{used & bits_of<W>(passes > Lanes<W>(0.0f))} << begin;
  }
  return passing;
}

template <int W>
std::uint64_t BodyKernels<W>::can_pass(float tick_s, const Body<2>* bodies,
                                       const Motion<2>* motions, const BodyPairs& pairs) {
  return which_can_pass<2, W>(tick_s, bodies, motions, pairs);
}

template <int W>
std::uint64_t BodyKernels<W>::can_pass(float tick_s, const Body<3>* bodies,
                                       const Motion<3>* motions, const BodyPairs& pairs) {
  return which_can_pass<3, W>(tick_s, bodies, motions, pairs);
}

}  // namespace cycloid::solver
