#pragma once

#include <span>

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
/// polygons included. Half-spaces, segments and triangles have no mass.
/// @param hulls  where the hull of the shape is, if it has one.
template <int D>
void add_mass(const Shape<D>& shape, const Polyhedra& hulls, float density,
              MassProperties<D>& into);

/// The same. @pre the shape is no hull.
template <int D>
void add_mass(const Shape<D>& shape, float density, MassProperties<D>& into);

/// The second moment about the centre of mass instead of the origin. @pre mass > 0.
///
/// Shapes of size s at a distance d from the origin come with a relative error of up to
/// 5e-7 (d / s)^2: 5e-5 at ten times their size, 5e-3 at a hundred times.
template <int D>
Inertia<D> central_inertia(const MassProperties<D>& properties);

/// Mass of shapes together, their centre in the body frame, and the moment about it.
template <int D>
struct CentralMass {
  float mass = 0.0f;  ///< kg; where it is 0, so is the rest.
  Vec<D> centre = Vec<D>::zero();
  Inertia<D> inertia{};
};

/// Of all shapes of a body, each with its density. Wherever they lie, the moment has an error of
/// 5e-5 at most: what lies farther than ten times its size from the origin is taken about its own
/// centre from the start.
template <int D>
CentralMass<D> central_mass(std::span<const Shape<D>> shapes, std::span<const float> densities,
                            const Polyhedra& hulls);

/// The same, thickened: what the least principal moment lacks to 1e-5 of the greatest is added
/// about every axis. Moments of the world are rounded to 6e-8 of the greatest, in which one a
/// million times smaller drowns: a wire of two metres and a millimetre then gains energy from every
/// touch.
inline Inertia<2> thickened(const Inertia<2>& inertia) {
  return inertia;
}
Inertia<3> thickened(const Inertia<3>& inertia);

/// The inverse, or zero where there is none. Moments from 1e-30 to 1e30 kg m^2 have one.
inline Inertia<2> inverse(const Inertia<2>& inertia) {
  return {{inertia.m[0] > 0.0f ? 1.0f / inertia.m[0] : 0.0f}};
}
Inertia<3> inverse(const Inertia<3>& inertia);

}  // namespace cycloid::solver
