#pragma once

#include <box2d/box2d.h>

#include "solver/state.hpp"

namespace cycloid::peers {

inline b2Vec2 to_box2d3(const solver::Vec<2>& v) {
  return {v[0], v[1]};
}

/// A body with every shape of it that `state` has, and its own mass; its origin is the centre of
/// mass.
b2BodyId add_box2d3_body(const solver::WorldState<2>& state, const solver::Body<2>& body,
                         b2WorldId world);

/// Whether the engine takes every polygon: its hull has as many corners as the polygon.
bool takes_box2d3_polygons(const solver::WorldState<2>& state);

/// The joint, or one that is not valid for a kind that is not there.
b2JointId add_box2d3_joint(const solver::Joint<2>& joint, b2BodyId a, b2BodyId b, b2WorldId world);

}  // namespace cycloid::peers
