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

/// Whether the engine takes every polygon: it ends the program over one of which fewer than three
/// corners are left when those within half its slop of each other are one.
bool takes_box2d_polygons(const solver::WorldState<2>& state);

/// Takes off the skin by which the engine lets polygons and edges overlap less than they are: with
/// it boxes rest 1.5 cm apart, which a ruler of overlaps takes for accuracy.
void take_box2d_skin_off(b2Body& body);

/// The joint, or null for a kind that is not there.
b2Joint* add_box2d_joint(const solver::Joint<2>& joint, b2Body* a, b2Body* b, b2World& world);

}  // namespace cycloid::peers
