#pragma once

#include <functional>

#include "solver/collision/manifold.hpp"
#include "solver/world.hpp"

namespace cycloid::peers {

/// Where every body of a state is, by slot: centre of mass, world.
using Poses = std::function<solver::Pose<3>(std::uint32_t body)>;

/// The depth of the deepest overlap of any two shapes that may collide, m; 0 where none overlap.
/// Measured with our manifolds at the given poses, whoever made them. Every pair of shapes whose
/// boxes meet is tried: O(n log n).
float deepest_overlap(const solver::WorldState<3>& state, const Poses& poses);

/// The largest distance between the anchors of any joint that holds two points together, m.
float widest_gap(const solver::WorldState<3>& state, const Poses& poses);

}  // namespace cycloid::peers
