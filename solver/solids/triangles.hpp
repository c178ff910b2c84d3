#pragma once

#include <vector>

#include "solver/definitions.hpp"
#include "solver/result.hpp"
#include "solver/state.hpp"

namespace cycloid::solver {

/// Appends one kTriangle record per triangle of a mesh, in its order. `normal` looks to the side
/// from which the corners run counter-clockwise. Where exactly two triangles have an edge, in
/// opposite directions, each becomes the ghost of the other across it; edges count as the same by
/// the indices of their ends, not by where these lie.
/// @param blank  what all the records have in common.
/// @pre validate(def, ...) is ok. @returns kInvalid "triangles" where one has a height below
/// kSizeMin; then nothing was appended.
Error append_mesh(const ShapeDef<3>& def, int index, const Shape<3>& blank,
                  std::vector<Shape<3>>& into);

/// The same for a grid of heights: row by row, two triangles per cell, whose diagonal runs from
/// (column, row) to (column + 1, row + 1); the one towards the next row comes first. Free above.
/// @returns kInvalid "heights" where slopes leave a triangle a height below kSizeMin.
Error append_height_field(const ShapeDef<3>& def, int index, const Shape<3>& blank,
                          std::vector<Shape<3>>& into);

}  // namespace cycloid::solver
