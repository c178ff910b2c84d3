#pragma once

#include "solver/collision/placed_pair.hpp"
#include "solver/state.hpp"

namespace cycloid::solver {

/// Whether `gap_beside_a_face` is worth asking about: not of two boxes, whose axes are known
/// beforehand. @pre both are boxes or hulls.
bool may_be_parted(const Shape<3>& a, const Shape<3>& b);

/// How far a face of one of two solids parts them at least.
struct FaceGap {
  float gap;  ///< m.
  bool of_b;  ///< It is a face of b.
};

/// A gap above `margin` [m] tells that `solid_against_solid` would find no point with that; another
/// says nothing. Asked before either is placed, of the one face of each that the other's centre is
/// farthest outside of: most pairs whose boxes overlap do no more, and one such face tells so of
/// nearly all of them.
///
/// @param b_first  Whether b's is asked first; the first that parts them by more is told.
/// @pre both are boxes or hulls.
FaceGap gap_beside_a_face(const Shape<3>& a, const Shape<3>& b, const PlacedPair<3>& pair,
                          bool b_first, const Polyhedra& polyhedra, float margin);

}  // namespace cycloid::solver
