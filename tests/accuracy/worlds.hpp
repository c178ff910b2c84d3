#pragma once

#include <gtest/gtest.h>

#include "solver/world.hpp"

namespace cycloid::accuracy {

/// A square or cube of 1 m.
inline solver::ShapeDef<2> unit_box(const solver::Dim<2>&) {
  solver::ShapeDef<2> shape;
  shape.kind = solver::ShapeKind::kPolygon;
  shape.points = {{{-0.5f, -0.5f}}, {{0.5f, -0.5f}}, {{0.5f, 0.5f}}, {{-0.5f, 0.5f}}};
  return shape;
}
inline solver::ShapeDef<3> unit_box(const solver::Dim<3>&) {
  solver::ShapeDef<3> shape;
  shape.kind = solver::ShapeKind::kBox;
  shape.half = {{0.5f, 0.5f, 0.5f}};
  return shape;
}

/// No bodies; gravity of 10 m/s^2, ticks of 1/60 s, friction 0.6.
template <int D>
solver::World<D> empty_world(const solver::Tuning& tuning = {}) {
  solver::WorldDef<D> def;
  def.gravity[1] = -10.0f;
  def.tuning = tuning;
  def.tuning.sleep_s = 0.0f;
  return std::move(solver::World<D>::create(def).value());
}

/// Solid below y = 0.
template <int D>
void add_ground(solver::World<D>& world) {
  solver::ShapeDef<D> plane;
  plane.kind = solver::ShapeKind::kHalfSpace;
  plane.normal[1] = 1.0f;
  solver::BodyDef<D> ground;
  ground.kind = solver::BodyKind::kStatic;
  ASSERT_TRUE(world.create_body(ground, std::span(&plane, 1)).ok());
}

template <int D>
solver::BodyId add_box(solver::World<D>& world, float x, float y, float mass = 1.0f) {
  const auto shape = unit_box(solver::Dim<D>{});
  solver::BodyDef<D> body;
  body.position[0] = x;
  body.position[1] = y;
  body.mass = mass;
  return world.create_body(body, std::span(&shape, 1)).value();
}

template <int D>
void step(solver::World<D>& world, int ticks) {
  for (int i = 0; i < ticks; ++i) ASSERT_TRUE(world.step().ok());
}

/// A box of 1 kg that rests on the ground, sunk to where soft contacts let it.
template <int D>
solver::World<D> resting_box() {
  solver::World<D> world = empty_world<D>();
  add_ground(world);
  add_box(world, 0.0f, 0.5f);
  step(world, 900);
  return world;
}

}  // namespace cycloid::accuracy
