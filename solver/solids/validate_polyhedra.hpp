#pragma once

#include "solver/result.hpp"
#include "solver/state.hpp"

namespace cycloid::solver {

/// The hulls of a state that came from outside: kCorrupt "polyhedron" with the slot unless every
/// record in use covers ranges of its own, in the same order in all pools, which it shares with
/// none, they cover the pools, its references are the shapes that name it, its half-edges are a
/// closed surface in the form that polyhedron.hpp states, and but for rounding no corner
/// lies outside of a face, and the corners of a face on it. A free record is zero. In the plane
/// there are no hulls.
Error validate_polyhedra(const WorldState<2>& state);
Error validate_polyhedra(const WorldState<3>& state);

}  // namespace cycloid::solver
