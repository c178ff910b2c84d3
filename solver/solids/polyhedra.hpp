#pragma once

#include "solver/state.hpp"

namespace cycloid::solver {

/// Puts a hull into the pools of a world, or finds the record that is equal to it in every bit and
/// counts one reference more. New records take the lowest free slot, new corners, faces and
/// half-edges the end of the pools. @returns the slot.
/// @pre the view does not look into `polyhedra` itself.
std::uint32_t intern(const PolyhedronView& hull, Polyhedra& polyhedra);

/// Takes one reference away. With the last one the record becomes zero, its ranges leave the pools,
/// and what lay behind them moves down: slots stay, as do the hulls that they name.
/// @pre `slot` has references.
void release(std::uint32_t slot, Polyhedra& polyhedra);

/// Moves the hull of a shape from the pools it was made in to those of a world; of other shapes,
/// and in the plane, nothing.
void adopt_hull(const Polyhedra& from, Polyhedra& to, Shape<2>& shape);
void adopt_hull(const Polyhedra& from, Polyhedra& to, Shape<3>& shape);

/// Gives back what adopt_hull took.
void abandon_hull(const Shape<2>& shape, Polyhedra& polyhedra);
void abandon_hull(const Shape<3>& shape, Polyhedra& polyhedra);

}  // namespace cycloid::solver
