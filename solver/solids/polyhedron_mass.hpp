#pragma once

#include "solver/mass.hpp"
#include "solver/solids/polyhedron.hpp"

namespace cycloid::solver {

/// Moments of a hull of `density` [kg/m^3] about the origin of its pool frame: exact sums over the
/// tetrahedra from that origin to the triangles of each face.
/// Source: Eberly, "Polyhedral Mass Properties (Revisited)" (2002).
MassProperties<3> mass_of(const PolyhedronView& hull, float density);

}  // namespace cycloid::solver
