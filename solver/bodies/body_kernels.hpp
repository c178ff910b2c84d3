#pragma once

#include "solver/collision/bounds.hpp"
#include "solver/motion.hpp"
#include "solver/transpose.hpp"

namespace cycloid::solver {

/// A shape of the plane on its way through a tick.
struct alignas(16) FlyingShape {
  Pose<2> pose;
  Vec<2> flight;  ///< Of its body in the tick, m.
  float reach;    ///< Of its box beyond its vertices, m.
  float last;     ///< Number of its last vertex.
};

/// Pairs of bodies, by their slots.
struct BodyPairs {
  int count = 0;
  std::uint32_t a[64];
  std::uint32_t b[64];
};

/// What is done to each body by itself, W of them at a time: the same formulas as for one, so the
/// same bits. Compiled for each width: body_kernels.cpp, body_kernels_avx2.cpp and
/// body_kernels_avx512.cpp, from the text in body_lanes.hpp, passing_lanes.hpp and turn_lanes.hpp.
template <int W>
struct BodyKernels {
  /// x' = x + h v,  q' = exp(h w) q, at unit length, to the bit as turn_by turns one.
  static void move(float h, const std::uint32_t* slots, int count, Motion<2>* motions);

  /// The same after v' = (v + h a) / (1 + h c), as integrate_velocities has it, in each of so many
  /// substeps. @param accelerations  In the order of the slots.
  static void fly(float h, int substeps, const Acceleration<2>* accelerations,
                  const std::uint32_t* slots, int count, Motion<2>* motions);

  /// The same as `move` of W bodies of space, which turn as turn_freely has it. @returns false
  /// where one of them turns by half a radian or more, for which a lane has no series; then nothing
  /// has changed.
  static bool move_in_space(float h, const Body<3>* bodies, const std::uint32_t* slots,
                            Motion<3>* motions);

  /// A bit for each body that may have moved by nearly half its thickness in the tick, or its
  /// corner turned so far: of all others is_fast is false. @pre count <= 64.
  static std::uint64_t moved_far(float tick_s, const Body<2>* bodies, const std::uint32_t* slots,
                                 int count, const Motion<2>* motions);

  /// A bit for each pair of bodies of which one may pass through the other in the tick, see
  /// passing.hpp.
  static std::uint64_t can_pass(float tick_s, const Body<2>* bodies, const Motion<2>* motions,
                                const BodyPairs& pairs);
  static std::uint64_t can_pass(float tick_s, const Body<3>* bodies, const Motion<3>* motions,
                                const BodyPairs& pairs);

  /// The boxes of shapes: bounds_of, then along the flight. @pre every shape has one to four
  /// vertices.
  static void find_boxes(const FlyingShape* flying, const std::uint32_t* shapes, int count,
                         const Shape<2>* of, Bounds<2>* boxes);
};

}  // namespace cycloid::solver
