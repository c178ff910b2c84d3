#pragma once

#include "solver/state.hpp"

namespace cycloid::solver {

/// Whether a face of one of two solids shows that they are farther apart than `margin` [m], so that
/// `solid_against_solid` would find no point. Asked before either is placed, of the one face of
/// each that the other's centre is farthest outside of: most pairs whose boxes overlap do no more,
/// and one such face tells so of nearly all of them. False says nothing.
///
/// @param a_to_b  the position of b's body from that of a, m. @pre both are boxes or hulls.
bool a_face_parts(const Shape<3>& a, const Rotation<3>& rotation_a, const Shape<3>& b,
                  const Rotation<3>& rotation_b, const Vec<3>& a_to_b, const Polyhedra& polyhedra,
                  float margin);

}  // namespace cycloid::solver
