#include "bench/trials/motions.hpp"

#include <algorithm>
#include <cmath>

namespace cycloid::trials {

std::array<double, 3> momentum_of(const solver::Body<2>& body) {
  return {static_cast<double>(body.inertia.m[0]) * static_cast<double>(body.spin[0]), 0.0, 0.0};
}
std::array<double, 3> momentum_of(const solver::Body<3>& body) {
  const solver::Vec<3> turned = solver::rotate_back(body.rotation, body.spin);
  const solver::Vec<3> momentum = solver::rotate(body.rotation, body.inertia * turned);
  return {static_cast<double>(momentum[0]), static_cast<double>(momentum[1]),
          static_cast<double>(momentum[2])};
}

template <int D>
Motions motions_of(const solver::WorldState<D>& state) {
  Motions motions;
  for (const solver::Body<D>& body : state.bodies) {
    if (!responds(body)) continue;
    const double mass = static_cast<double>(body.mass);
    double square = 0.0;
    double height = 0.0;
    for (int i = 0; i < D; ++i) {
      square += static_cast<double>(body.velocity[i]) * static_cast<double>(body.velocity[i]);
      height -= static_cast<double>(state.header.gravity[i]) *
                static_cast<double>(body.gravity_scale) * static_cast<double>(body.position[i]);
    }
    const std::array<double, 3> momentum = momentum_of(body);
    double turning = 0.0;
    for (int i = 0; i < solver::Dim<D>::kSpin; ++i)
      turning += momentum[static_cast<std::size_t>(i)] * static_cast<double>(body.spin[i]);
    for (std::size_t i = 0; i < 3; ++i) motions.momentum[i] += momentum[i];
    motions.kinetic_j += 0.5 * mass * square + 0.5 * turning;
    motions.energy_j += 0.5 * mass * square + 0.5 * turning + mass * height;
    motions.speed_m_s = std::max(motions.speed_m_s, std::sqrt(square));
    motions.highest_m = std::max(motions.highest_m, static_cast<double>(body.position[1]));
  }
  motions.finite = std::isfinite(motions.energy_j);
  return motions;
}

template Motions motions_of(const solver::WorldState<2>&);
template Motions motions_of(const solver::WorldState<3>&);

}  // namespace cycloid::trials
