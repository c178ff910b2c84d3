#pragma once

#include <cstddef>

#include "solver/bodies/body_kernels.hpp"
#include "solver/bodies/passing.hpp"
#include "solver/bodies/slots_in_lanes.hpp"
#include "solver/constraints/motion_lanes.hpp"

namespace cycloid::solver {

/// The text of BodyKernels::can_pass. Every function is a template on W.

/// 1 in lanes of bodies that forces move.
template <int W>
[[gnu::always_inline]] inline typename Lanes<W>::Mask respond_in_lanes(
    const Body<2>* bodies, const LaneIndices<W>& slots) {
  static_assert(BodyKind::kDynamic > BodyKind::kKinematic &&
                BodyKind::kParticle > BodyKind::kKinematic);
  constexpr int kKindAt = offsetof(Body<2>, kind) / sizeof(float);
  Lanes<W> columns[4];
  gather_floats<W>(bodies, slots, kKindAt, columns);
  typename Lanes<W>::Mask kinds;
  std::memcpy(&kinds, &columns[0].raw, sizeof kinds);
  return kinds > static_cast<int>(BodyKind::kKinematic);
}

template <int W>
[[gnu::always_inline]] inline PassingBody<2, Lanes<W>> gather_passing(const Body<2>* bodies,
                                                                      const Motion<2>* motions,
                                                                      const LaneIndices<W>& slots) {
  using L = Lanes<W>;
  constexpr int kPositionAt = offsetof(Body<2>, position) / sizeof(float);
  constexpr int kExtentAt = offsetof(Body<2>, extent) / sizeof(float);
  static_assert(offsetof(Body<2>, thickness) == offsetof(Body<2>, extent) + sizeof(float));
  static_assert(sizeof(Body<2>) >= offsetof(Body<2>, extent) + sizeof(Quad));
  L pose[4];
  L sizes[4];
  gather_floats<W>(bodies, slots, kPositionAt, pose);
  gather_floats<W>(bodies, slots, kExtentAt, sizes);
  const MotionLanes<2, W> motion = gather<2, W>(motions, slots);
  return {{{pose[0], pose[1]}},
          sizes[0],
          select(respond_in_lanes<W>(bodies, slots), sizes[1], L(kUnyielding)),
          motion.spin,
          motion.delta_position,
          motion.delta_rotation};
}

template <int W>
std::uint64_t BodyKernels<W>::can_pass(float tick_s, const Body<2>* bodies,
                                       const Motion<2>* motions, const BodyPairs& pairs) {
  std::uint64_t passing = 0;
  for (int begin = 0; begin < pairs.count; begin += kLaneCount<W>) {
    LaneIndices<W> a;
    LaneIndices<W> b;
    const int left = pairs.count - begin;
    const LaneBits used = take_slots<W>(pairs.a + begin, left, a);
    take_slots<W>(pairs.b + begin, left, b);
    const Lanes<W> passes =
        solver::can_pass<2, Lanes<W>>(Lanes<W>(tick_s), gather_passing<W>(bodies, motions, a),
                                      gather_passing<W>(bodies, motions, b));
    passing |= std::uint64_t{used & bits_of<W>(passes > Lanes<W>(0.0f))} << begin;
  }
  return passing;
}

}  // namespace cycloid::solver
