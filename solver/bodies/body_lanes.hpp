#pragma once

#include <cstddef>

#include "solver/bodies/body_kernels.hpp"
#include "solver/constraints/motion_lanes.hpp"
#include "solver/constraints/trig_lanes.hpp"

namespace cycloid::solver {

/// The text of BodyKernels, for the files that compile it and no others. Every function is a
/// template on W, so that those compiled for one instruction set have names of their own.

/// The first `left` slots of a list, one in each lane, as many as there are. @returns which lanes
/// are used: where that are not all, the others stand for the last slot again.
template <int W>
[[gnu::always_inline]] inline LaneBits take_slots(const std::uint32_t* list, int left,
                                                  LaneIndices<W>& slots) {
  if (left >= kLaneCount<W>) {
    std::memcpy(slots, list, sizeof slots);
    return kAllLanes<W>;
  }
  for (int lane = 0; lane < kLaneCount<W>; ++lane)
    slots[lane] = list[lane < left ? lane : left - 1];
  return (LaneBits{1} << left) - 1;
}

template <int W>
[[gnu::always_inline]] inline void move_lanes(Lanes<W> h, MotionLanes<2, W>& motion) {
  using L = Lanes<W>;
  motion.delta_position += h * motion.velocity;
  const L turn = h * motion.spin[0];
  Rotation<2, L> by;
  sin_cos(turn, by[1], by[0]);
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
    move_lanes<W>(Lanes<W>(h), motion);
    scatter_quads<0, kPoseQuads<2>>(motion, used, bodies, motions);
  }
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
