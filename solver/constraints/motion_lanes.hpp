#pragma once

#include "solver/motion.hpp"
#include "solver/transpose.hpp"

namespace cycloid::solver {

/// The motions of W bodies, transposed: one body in each lane.
template <int D, int W>
struct MotionLanes {
  Vec<D, Lanes<W>> velocity;
  Spin<D, Lanes<W>> spin;
  Vec<D, Lanes<W>> delta_position;
  Rotation<D, Lanes<W>> delta_rotation;
};

template <int D, int W>
struct LaneMass {
  Lanes<W> inverse_mass;
  Lanes<W> inverse_inertia[Dim<D>::kSpin * Dim<D>::kSpin];
};

/// Component i of a motion, in the order of the record.
template <int D, int W>
[[gnu::always_inline]] inline Lanes<W>& component(MotionLanes<D, W>& lanes, int i) {
  constexpr int kSpin = Dim<D>::kSpin;
  if (i < D) return lanes.velocity.v[i];
  if (i < D + kSpin) return lanes.spin.v[i - D];
  if (i < 2 * D + kSpin) return lanes.delta_position.v[i - D - kSpin];
  return lanes.delta_rotation.v[i - 2 * D - kSpin];
}

/// Quads [0, kQuads) of the records of W bodies; what lies in later ones is left as it is.
template <int kQuads, int D, int W>
[[gnu::always_inline]] inline void gather_quads(const Motion<D>* motions,
                                                const LaneIndices<W>& bodies,
                                                MotionLanes<D, W>& lanes) {
  for (int quad = 0; quad < kQuads; ++quad) {
    Lanes<W> columns[4];
    gather_columns<W>(motions, bodies, quad, columns);
    for (int i = 0; i < 4; ++i)
      if (4 * quad + i < kMotionComponents<D>) component(lanes, 4 * quad + i) = columns[i];
  }
}

template <int D, int W>
[[gnu::always_inline]] inline MotionLanes<D, W> gather(const Motion<D>* motions,
                                                       const LaneIndices<W>& bodies) {
  MotionLanes<D, W> lanes;
  gather_quads<kPoseQuads<D>>(motions, bodies, lanes);
  return lanes;
}

/// Writes quads [kFrom, kTo) back, but only to the bodies in lanes of `moves`, which have mass: one
/// without may stand in many lanes at once, and nothing changes it.
template <int kFrom, int kTo, int D, int W>
[[gnu::always_inline]] inline void scatter_quads(MotionLanes<D, W>& lanes, LaneBits moves,
                                                 const LaneIndices<W>& bodies, Motion<D>* motions) {
  for (int quad = kFrom; quad < kTo; ++quad) {
    Lanes<W> columns[4];
    for (int i = 0; i < 4; ++i)
      columns[i] =
          4 * quad + i < kMotionComponents<D> ? component(lanes, 4 * quad + i) : Lanes<W>(0.0f);
    scatter_columns<W>(columns, moves, quad, bodies, motions);
  }
}

/// Writes velocity and spin back. What shares their quads is written as it was gathered.
template <int D, int W>
[[gnu::always_inline]] inline void scatter(MotionLanes<D, W>& lanes, LaneBits moves,
                                           const LaneIndices<W>& bodies, Motion<D>* motions) {
  scatter_quads<0, kVelocityQuads<D>>(lanes, moves, bodies, motions);
}

/// Writes the poses back. @pre velocities are as they were gathered.
template <int D, int W>
void scatter_pose(MotionLanes<D, W>& lanes, LaneBits moves, const LaneIndices<W>& bodies,
                  Motion<D>* motions) {
  scatter_quads<0, kPoseQuads<D>>(lanes, moves, bodies, motions);
}

/// q' = q + turn q (in space turn / 2) at unit length, in lanes that turn at all: for corrections,
/// which are small. A lane that does not turn keeps its bits.
template <class L, int N, int S>
void turn_lanes(const Vec<S, L>& turn, Vec<N, L>& q) {
  const Vec<N, L> raised = q + turn_derivative(turn, q);
  L square = turn[0] * turn[0];
  for (int i = 1; i < S; ++i) square += turn[i] * turn[i];
  const L scale = L(1.0f) / sqrt(dot(raised, raised));
  for (int i = 0; i < N; ++i) q[i] = select(square > L(0.0f), scale * raised[i], q[i]);
}

template <int D, int W>
[[gnu::always_inline]] inline Spin<D, Lanes<W>> turned_by(const LaneMass<D, W>& mass,
                                                          const Spin<D, Lanes<W>>& moment_of) {
  constexpr int kSpin = Dim<D>::kSpin;
  Spin<D, Lanes<W>> result;
  for (int i = 0; i < kSpin; ++i) {
    result[i] = mass.inverse_inertia[i * kSpin] * moment_of[0];
    for (int j = 1; j < kSpin; ++j)
      result[i] = result[i] + mass.inverse_inertia[i * kSpin + j] * moment_of[j];
  }
  return result;
}

/// v += m^-1 P,  w += I^-1 (r x P).
template <int D, int W>
[[gnu::always_inline]] inline void apply_impulse(const Vec<D, Lanes<W>>& impulse,
                                                 const Vec<D, Lanes<W>>& r,
                                                 const LaneMass<D, W>& mass,
                                                 MotionLanes<D, W>& motion) {
  motion.velocity += mass.inverse_mass * impulse;
  motion.spin += turned_by<D, W>(mass, moment(r, impulse));
}

}  // namespace cycloid::solver
