#pragma once

#include "solver/constraints/motion_lanes.hpp"

namespace cycloid::solver {

/// Reading and writing what one lane has.

template <int W>
void set_lane(Lanes<W>& lanes, int lane, float value) {
  // One float in memory: to load and store the whole vector would cost a fifth of a step in space.
  lanes.raw[lane] = value;
}
template <int N, int W>
void set_lane(Vec<N, Lanes<W>>& lanes, int lane, const Vec<N>& value) {
  for (int i = 0; i < N; ++i) set_lane(lanes[i], lane, value[i]);
}

template <int W>
float lane_of(const Lanes<W>& lanes, int lane) {
  return lanes.raw[lane];
}
template <int N, int W>
Vec<N> lane_of(const Vec<N, Lanes<W>>& lanes, int lane) {
  Vec<N> value;
  for (int i = 0; i < N; ++i) value[i] = lane_of(lanes[i], lane);
  return value;
}

template <int D, int W>
void set_mass(LaneMass<D, W>& lanes, int lane, const BodyMass<D>& mass) {
  set_lane(lanes.inverse_mass, lane, mass.inverse_mass);
  for (int i = 0; i < Dim<D>::kSpin * Dim<D>::kSpin; ++i)
    set_lane(lanes.inverse_inertia[i], lane, mass.inverse_inertia.m[i]);
}

}  // namespace cycloid::solver
