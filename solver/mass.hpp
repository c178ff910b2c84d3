#pragma once

#include "solver/definitions.hpp"
#include "solver/state.hpp"

namespace cycloid::solver {

/// Moments of a mass distribution about the origin of the body frame.
template <int D>
struct MassProperties {
  float mass = 0.0f;              ///< kg
  Vec<D> first = Vec<D>::zero();  ///< kg m: mass times centre
  Inertia<D> second{};            ///< kg m^2, about the origin
};

/// Adds what one shape record contributes at `density` [kg/m^D]. Exact for every kind, rounded
/// polygons included. Half-spaces and segments have no mass.
template <int D>
void add_mass(const Shape<D>& shape, float density, MassProperties<D>& into);

/// The second moment about the centre of mass instead of the origin. @pre mass > 0.
template <int D>
Inertia<D> central_inertia(const MassProperties<D>& properties);

/// The inverse, or zero where there is none.
template <int D>
Inertia<D> inverse(const Inertia<D>& inertia);

}  // namespace cycloid::solver
