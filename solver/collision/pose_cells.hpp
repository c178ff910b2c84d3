#pragma once

#include "solver/collision/placed_pair.hpp"
#include "solver/dim.hpp"
#include "solver/state.hpp"

namespace cycloid::solver {

/// Two solids are collided where they would lie if their relative pose were rounded to a grid, and
/// what is found is moved to where they are. So a manifold is a function of the state, as any other
/// is, and stays the same but for that motion as long as the pose rounds to the same: what moves
/// little is not collided again (held_pairs.hpp).
///
/// Rounded is the pose of the body that reaches less far, in the frame of the other, to some
/// thousandths of how far it reaches: what turns it by a step of the grid moves no point of it by
/// more than a step does.
struct CellGrid {
  bool b_carries;   ///< The frame is that of body b; else of a.
  float reach;      ///< Of the rounded body from its centre of mass, m.
  float far_reach;  ///< Of the one that carries the frame.
  float step;       ///< Of each coordinate, m.
  float turn;       ///< Of each part of the quaternion.
};

/// @param extent_a  Of body a, m (Body::extent).
CellGrid grid_of(float extent_a, float extent_b);

/// The pose of the body that is rounded in the frame of the other.
Pose<3> relative_pose(const CellGrid& grid, const PlacedPair<3>& pair);
/// The same on the grid. The quaternion is not of unit length.
Pose<3> rounded(const CellGrid& grid, const Pose<3>& relative);
/// How far rounding moves points that lie so far from the centre of mass of the rounded body, at
/// most, m.
float moved_by_rounding(const CellGrid& grid, float distance);

/// The margins of pairs on a scale of few: what flies slowly has that which is at rest has.
/// @returns at least what is flown in a tick. @param speculative  Tuning::speculative_distance, m.
float rounded_margin(float margin, float speculative);

/// The manifold of two boxes or hulls at a rounded pose: in the frame of the grid, from the centre
/// of mass of body a as it lies there.
Manifold<3> collide_in_cell(const Shape<3>& a, const Shape<3>& b, const Polyhedra& polyhedra,
                            const CellGrid& grid, const Pose<3>& cell, float margin);

/// What becomes of it at the pose itself, in world axes from body a, into `moved`. Points move with
/// the bodies that they lie on, the normal with that whose face it is of; their distance along it
/// changes.
void move_from_cell(const Manifold<3>& manifold, const CellGrid& grid, const Pose<3>& cell,
                    const Pose<3>& relative, const PlacedPair<3>& pair, Manifold<3>& moved);

}  // namespace cycloid::solver
