#pragma once

#include <array>
#include <cstring>
#include <span>

#include "solver/motion.hpp"

namespace cycloid::solver {

template <int W>
using LaneIndices = std::array<std::uint32_t, static_cast<std::size_t>(W)>;

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

/// W floats of each of a motion's components, in the order of the record.
template <int D, int W>
struct MotionColumns {
  static constexpr int kUsed = 2 * D + Dim<D>::kSpin + Dim<D>::kRotation;
  float column[kUsed][W];
};

template <int D, int W>
[[gnu::always_inline]] inline MotionLanes<D, W> gather(std::span<const Motion<D>> motions,
                                                       const LaneIndices<W>& bodies) {
  MotionColumns<D, W> columns;
  for (int lane = 0; lane < W; ++lane) {
    float row[MotionColumns<D, W>::kUsed];
    std::memcpy(row, &motions[bodies[static_cast<std::size_t>(lane)]], sizeof row);
    for (int i = 0; i < MotionColumns<D, W>::kUsed; ++i) columns.column[i][lane] = row[i];
  }
  MotionLanes<D, W> lanes;
  int i = 0;
  for (auto& value : lanes.velocity.v) value = Lanes<W>::load(columns.column[i++]);
  for (auto& value : lanes.spin.v) value = Lanes<W>::load(columns.column[i++]);
  for (auto& value : lanes.delta_position.v) value = Lanes<W>::load(columns.column[i++]);
  for (auto& value : lanes.delta_rotation.v) value = Lanes<W>::load(columns.column[i++]);
  return lanes;
}

/// Writes velocity and spin back, but only to bodies with mass: a body without mass may stand in
/// many lanes at once, and nothing changes it.
template <int D, int W>
[[gnu::always_inline]] inline void scatter(const MotionLanes<D, W>& lanes,
                                           const LaneMass<D, W>& mass, const LaneIndices<W>& bodies,
                                           std::span<Motion<D>> motions) {
  float velocity[D][W];
  float spin[Dim<D>::kSpin][W];
  float inverse_mass[W];
  for (int i = 0; i < D; ++i) lanes.velocity[i].store(velocity[i]);
  for (int i = 0; i < Dim<D>::kSpin; ++i) lanes.spin[i].store(spin[i]);
  mass.inverse_mass.store(inverse_mass);
  for (int lane = 0; lane < W; ++lane) {
    if (inverse_mass[lane] == 0.0f) continue;
    Motion<D>& motion = motions[bodies[static_cast<std::size_t>(lane)]];
    for (int i = 0; i < D; ++i) motion.velocity[i] = velocity[i][lane];
    for (int i = 0; i < Dim<D>::kSpin; ++i) motion.spin[i] = spin[i][lane];
  }
}

/// Writes the poses back, to bodies with mass.
template <int D, int W>
void scatter_pose(const MotionLanes<D, W>& lanes, const LaneMass<D, W>& mass,
                  const LaneIndices<W>& bodies, std::span<Motion<D>> motions) {
  float position[D][W];
  float rotation[Dim<D>::kRotation][W];
  float inverse_mass[W];
  for (int i = 0; i < D; ++i) lanes.delta_position[i].store(position[i]);
  for (int i = 0; i < Dim<D>::kRotation; ++i) lanes.delta_rotation[i].store(rotation[i]);
  mass.inverse_mass.store(inverse_mass);
  for (int lane = 0; lane < W; ++lane) {
    if (inverse_mass[lane] == 0.0f) continue;
    Motion<D>& motion = motions[bodies[static_cast<std::size_t>(lane)]];
    for (int i = 0; i < D; ++i) motion.delta_position[i] = position[i][lane];
    for (int i = 0; i < Dim<D>::kRotation; ++i) motion.delta_rotation[i] = rotation[i][lane];
  }
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
