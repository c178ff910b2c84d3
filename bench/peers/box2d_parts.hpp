#pragma once

#include <box2d/box2d.h>

#include "solver/state.hpp"

namespace cycloid::peers {

inline b2Vec2 to_box2d(const solver::Vec<2>& v) {
  return {v[0], v[1]};
}

/// rad
float angle_of(const solver::Rotation<2>& rotation);

/// A body without its fixtures; its origin is the centre of mass.
b2Body* add_box2d_body(const solver::Body<2>& body, b2World& world);

/// Adds every shape of the body to `into`, then gives it the body's own mass.
void add_box2d_fixtures(const solver::WorldState<2>& state, const solver::Body<2>& body,
                        b2Body& into);

/// The joint, or null for a kind that is not there.
b2Joint* add_box2d_joint(const solver::Joint<2>& joint, b2Body* a, b2Body* b, b2World& world);

}  // namespace cycloid::peers
