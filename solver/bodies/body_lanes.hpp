#pragma once

#include <cstddef>

#include "solver/bodies/body_kernels.hpp"
#include "solver/bodies/passing.hpp"
#include "solver/bodies/slots_in_lanes.hpp"
#include "solver/constraints/motion_lanes.hpp"
#include "solver/constraints/trig_lanes.hpp"

namespace cycloid::solver {

/// The text of BodyKernels, for the files that compile it and no others. Every function is a
/// template on W, so that those compiled for one instruction set have names of their own.

/// @param by  The rotation by `turn` [rad].
template <int W>
[[gnu::always_inline]] inline void move_lanes(Lanes<W> h, Lanes<W> turn,
                                              const Rotation<2, Lanes<W>>& by,
                                              MotionLanes<2, W>& motion) {
  using L = Lanes<W>;
  motion.delta_position += h * motion.velocity;
  const Rotation<2, L> turned = compose(by, motion.delta_rotation);
  const L size = sqrt(dot(turned, turned));
  const auto has_size = size > L(1.0e-12f);
  const L inverse = L(1.0f) / select(has_size, size, L(1.0f));
  const L square = turn * turn;
  for (int i = 0; i < 2; ++i) {
    L& q = motion.delta_rotation[i];
    const L to = select(has_size, inverse * turned[i], q);
    // What does not turn keeps its bits; what is no number does not.
    q = select(square > L(0.0f), to, select(square < L(1.0f), q, to));
  }
}

template <int W>
void BodyKernels<W>::move(float h, const std::uint32_t* slots, int count, Motion<2>* motions) {
  for (int begin = 0; begin < count; begin += kLaneCount<W>) {
    LaneIndices<W> bodies;
    const LaneBits used = take_slots<W>(slots + begin, count - begin, bodies);
    MotionLanes<2, W> motion = gather<2, W>(motions, bodies);
    const Lanes<W> turn = Lanes<W>(h) * motion.spin[0];
    Rotation<2, Lanes<W>> by;
    sin_cos(turn, by[1], by[0]);
    move_lanes<W>(Lanes<W>(h), turn, by, motion);
    scatter_quads<0, kPoseQuads<2>>(motion, used, bodies, motions);
  }
}

/// W bodies that nothing touches, on their way through a tick.
template <int W>
struct FlightLanes {
  MotionLanes<2, W> motion;
  Lanes<W> factor[4];
  Lanes<W> rate[4];
  Lanes<W> turn;  ///< Of the last substep, rad; none is 0, whose rotation stands beside it.
  Rotation<2, Lanes<W>> by;
  LaneIndices<W> bodies;
  LaneBits used;
};

template <int W>
[[gnu::always_inline]] inline void take_off(const Acceleration<2>* accelerations,
                                            const std::uint32_t* slots, int left,
                                            const Motion<2>* motions, FlightLanes<W>& flight) {
  static_assert(sizeof(Acceleration<2>) == 2 * sizeof(Quad));
  flight.used = take_slots<W>(slots, left, flight.bodies);
  LaneIndices<W> place;
  for (int lane = 0; lane < kLaneCount<W>; ++lane)
    place[lane] = static_cast<std::uint32_t>(lane < left ? lane : left - 1);
  gather_columns<W>(accelerations, place, 0, flight.factor);
  gather_columns<W>(accelerations, place, 1, flight.rate);
  flight.motion = gather<2, W>(motions, flight.bodies);
  flight.turn = Lanes<W>(0.0f);
  flight.by = {{Lanes<W>(1.0f), Lanes<W>(0.0f)}};
}

/// Most bodies turn as far in each substep as in the one before, or not at all.
template <int W>
[[gnu::always_inline]] inline void fly_on(Lanes<W> h, FlightLanes<W>& flight) {
  using L = Lanes<W>;
  for (int i = 0; i < 3; ++i) {
    L& moved = component(flight.motion, i);
    moved = flight.factor[i] * (moved + h * flight.rate[i]);
  }
  const L turn = h * flight.motion.spin[0];
  if (bits_of<W>(turn == flight.turn) != kAllLanes<W>) sin_cos(turn, flight.by[1], flight.by[0]);
  flight.turn = turn;
  move_lanes<W>(h, turn, flight.by, flight.motion);
}

template <int W>
void BodyKernels<W>::fly(float h, int substeps, const Acceleration<2>* accelerations,
                         const std::uint32_t* slots, int count, Motion<2>* motions) {
  constexpr int kAtOnce = 4;  // Each waits for its own root and quotient, meanwhile others do not.
  FlightLanes<W> flights[kAtOnce];
  for (int begin = 0; begin < count;) {
    int taken = 0;
    for (; taken < kAtOnce && begin < count; ++taken, begin += kLaneCount<W>)
      take_off<W>(accelerations + begin, slots + begin, count - begin, motions, flights[taken]);
    for (int substep = 0; substep < substeps; ++substep)
      for (int i = 0; i < taken; ++i) fly_on<W>(Lanes<W>(h), flights[i]);
    for (int i = 0; i < taken; ++i) {
      FlightLanes<W>& flight = flights[i];
      scatter_quads<0, kPoseQuads<2>>(flight.motion, flight.used, flight.bodies, motions);
    }
  }
}

/// As is_slow has it in space (stages/list_fast_bodies.cpp), with squares in place of the root:
/// nobody sees who is asked once more, as long as nobody fast is left out.
template <int W>
[[gnu::always_inline]] inline LaneBits moved_far_in_lanes(Lanes<W> tick_s, Lanes<W> extent,
                                                          Lanes<W> thickness,
                                                          const MotionLanes<2, W>& motion) {
  using L = Lanes<W>;
  const L spun = tick_s * motion.spin[0];
  const L room = L(0.499f) * thickness - extent * turn_bound(motion.delta_rotation);
  const auto is_slow = (room > L(0.0f)) & (spun * spun < L(9.0f)) &
                       (dot(motion.delta_position, motion.delta_position) < room * room);
  return kAllLanes<W> & ~bits_of<W>(is_slow);
}

template <int W>
std::uint64_t BodyKernels<W>::moved_far(float tick_s, const Body<2>* bodies,
                                        const std::uint32_t* slots, int count,
                                        const Motion<2>* motions) {
  constexpr int kExtentAt = offsetof(BodyProperties<2>, extent) / sizeof(float);
  static_assert(offsetof(BodyProperties<2>, thickness) ==
                offsetof(BodyProperties<2>, extent) + sizeof(float));
  static_assert(sizeof(Body<2>) >= offsetof(BodyProperties<2>, extent) + sizeof(Quad));
  std::uint64_t far = 0;
  for (int begin = 0; begin < count; begin += kLaneCount<W>) {
    LaneIndices<W> in_lane;
    const LaneBits used = take_slots<W>(slots + begin, count - begin, in_lane);
    Lanes<W> of_body[4];
    gather_floats<W>(bodies, in_lane, kExtentAt, of_body);
    const MotionLanes<2, W> motion = gather<2, W>(motions, in_lane);
    const LaneBits bits =
        used & moved_far_in_lanes<W>(Lanes<W>(tick_s), of_body[0], of_body[1], motion);
    far |= std::uint64_t{bits} << begin;
  }
  return far;
}

/// The corners of boxes in lanes.
template <int W>
struct BoundsLanes {
  Vec<2, Lanes<W>> lower;
  Vec<2, Lanes<W>> upper;
};

template <int W>
[[gnu::always_inline]] inline BoundsLanes<W> bounds_in_lanes(const Shape<2>* of,
                                                             const LaneIndices<W>& shapes,
                                                             const Rotation<2, Lanes<W>>& rotation,
                                                             const Vec<2, Lanes<W>>& position,
                                                             Lanes<W> last) {
  using L = Lanes<W>;
  static_assert(offsetof(Geometry<2>, vertices) == 0);
  BoundsLanes<W> bounds;
  Vec<2, L> first = Vec<2, L>::zero();
  for (int half = 0; half < 2; ++half) {
    L xy[4];
    gather_columns<W>(of, shapes, half, xy);
    for (int i = 0; i < 2; ++i) {
      const int corner = 2 * half + i;
      const Vec<2, L> vertex = position + rotate(rotation, Vec<2, L>{{xy[2 * i], xy[2 * i + 1]}});
      if (corner == 0) first = vertex;
      // Behind the last vertex comes the first again.
      const auto is_vertex = last > L(static_cast<float>(corner) - 0.5f);
      for (int axis = 0; axis < 2; ++axis) {
        const L at = select(is_vertex, vertex[axis], first[axis]);
        bounds.lower[axis] = corner == 0 ? at : min(bounds.lower[axis], at);
        bounds.upper[axis] = corner == 0 ? at : max(bounds.upper[axis], at);
      }
    }
  }
  return bounds;
}

template <int W>
void BodyKernels<W>::find_boxes(const FlyingShape* flying, const std::uint32_t* shapes, int count,
                                const Shape<2>* of, Bounds<2>* boxes) {
  using L = Lanes<W>;
  static_assert(sizeof(Bounds<2>) == sizeof(Quad) && sizeof(FlyingShape) == 2 * sizeof(Quad));
  for (int begin = 0; begin < count; begin += kLaneCount<W>) {
    LaneIndices<W> shape;
    const LaneBits used = take_slots<W>(shapes + begin, count - begin, shape);
    LaneIndices<W> place;
    for (int lane = 0; lane < kLaneCount<W>; ++lane)
      place[lane] = static_cast<std::uint32_t>(begin + lane < count ? lane : count - begin - 1);
    L pose[4];
    L more[4];
    gather_columns<W>(flying + begin, place, 0, pose);
    gather_columns<W>(flying + begin, place, 1, more);
    const BoundsLanes<W> bounds =
        bounds_in_lanes<W>(of, shape, {{pose[2], pose[3]}}, {{pose[0], pose[1]}}, more[3]);
    L box[4];
    for (int i = 0; i < 2; ++i) {
      box[i] = (bounds.lower[i] - more[2]) + min(more[i], L(0.0f));
      box[2 + i] = (bounds.upper[i] + more[2]) + max(more[i], L(0.0f));
    }
    scatter_columns<W>(box, used, 0, shape, boxes);
  }
}

}  // namespace cycloid::solver
