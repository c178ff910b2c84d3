#pragma once

#include <array>

#include "solver/state.hpp"

namespace cycloid::trials {

/// How all bodies of a world move, those left out that do not respond to forces.
struct Motions {
  double kinetic_j = 0.0;
  double energy_j = 0.0;             ///< Kinetic, and of gravity: 0 where a body is at the origin.
  std::array<double, 3> momentum{};  ///< Angular, each body about its own centre, kg m^2/s.
  double speed_m_s = 0.0;            ///< Of the fastest.
  double highest_m = -1e30;          ///< y of the highest.
  bool finite = true;
};

/// By sums, products and roots alone, so that it is the same on every machine.
template <int D>
Motions motions_of(const solver::WorldState<D>& state);

/// Angular momentum of a body about its own centre, kg m^2/s; in the plane the first number.
std::array<double, 3> momentum_of(const solver::Body<2>& body);
std::array<double, 3> momentum_of(const solver::Body<3>& body);

/// Whether forces move it.
template <int D>
bool responds(const solver::Body<D>& body) {
  return body.kind == solver::BodyKind::kDynamic || body.kind == solver::BodyKind::kParticle;
}

}  // namespace cycloid::trials
