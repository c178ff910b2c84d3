#pragma once

#include "bench/experiments/worlds.hpp"

namespace cycloid::experiments::space {

// The worlds of worlds.hpp in space: y is up, gravity and tick are the same.

solver::World<3> make_world(const solver::Tuning& tuning, double gravity = kGravity,
                            const solver::Material& material = {0.0f});
solver::ShapeDef<3> ball(double radius);
solver::ShapeDef<3> box(double half_x, double half_y, double half_z);
/// A static half-space under y = 0.
solver::BodyId add_ground(solver::World<3>& world);
/// Of mass `mass` (kg; 0: from density 1), its origin at height y (m) over the origin.
solver::BodyId add(solver::World<3>& world, std::span<const solver::ShapeDef<3>> shapes, double y,
                   double mass = 0.0);

/// Ground and balls of radius 0.5 m in one vertical line that just touch, bottom first.
solver::World<3> stack_of_balls(const std::vector<double>& masses, const solver::Tuning& tuning);
/// Of every contact point, in the order of state().contacts, N s.
std::vector<double> normal_impulses(const solver::World<3>& world);
void step(solver::World<3>& world, int ticks = 1);

}  // namespace cycloid::experiments::space
