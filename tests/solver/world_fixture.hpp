#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <span>
#include <vector>

#include "solver/world.hpp"

namespace cycloid::solver {

/// Shapes and worlds that many tests need; gravity is 10 m/s^2, downwards along axis 1.

inline constexpr float kTick = 1.0f / 60.0f;  ///< Of a world by default, s.

template <int D>
World<D> make_world(WorldDef<D> def = {}) {
  Result<World<D>> world = World<D>::create(def);
  EXPECT_TRUE(world.ok()) << world.error().field;
  return std::move(world.value());
}

template <int D>
WorldDef<D> with_gravity(Material material = {}) {
  WorldDef<D> def;
  def.gravity[1] = -10.0f;
  def.materials = {material};
  return def;
}

template <int D>
WorldDef<D> def_with(const Tuning& tuning, Material material = {}) {
  WorldDef<D> def = with_gravity<D>(material);
  def.tuning = tuning;
  return def;
}

template <int D>
Vec<D> at(float x, float y) {
  Vec<D> position = Vec<D>::zero();
  position[0] = x;
  position[1] = y;
  return position;
}

template <int D>
ShapeDef<D> ball(float radius) {
  ShapeDef<D> shape;
  shape.radius = radius;
  return shape;
}

inline ShapeDef<2> box(float half_x, float half_y) {
  ShapeDef<2> shape;
  shape.kind = ShapeKind::kPolygon;
  shape.points = {
      {{-half_x, -half_y}}, {{half_x, -half_y}}, {{half_x, half_y}}, {{-half_x, half_y}}};
  return shape;
}

inline ShapeDef<2> capsule(float half_length, float radius) {
  ShapeDef<2> shape;
  shape.kind = ShapeKind::kCapsule;
  shape.points = {{{-half_length, 0.0f}}, {{half_length, 0.0f}}};
  shape.radius = radius;
  return shape;
}

template <int D>
BodyId add(World<D>& world, const BodyDef<D>& def, const ShapeDef<D>& shape) {
  const Result<BodyId> id = world.create_body(def, std::span(&shape, 1));
  EXPECT_TRUE(id.ok()) << id.error().field;
  return id.ok() ? id.value() : BodyId{};
}

template <int D>
BodyId add_at(World<D>& world, Vec<D> position, const ShapeDef<D>& shape) {
  BodyDef<D> def;
  def.position = position;
  return add(world, def, shape);
}

/// Boxes of 1 m on one another, the lowest from height 0 to 1: on the plane of add_ground.
inline std::vector<BodyId> add_stack(World<2>& world, int count, float x = 0.0f) {
  std::vector<BodyId> boxes;
  for (int i = 0; i < count; ++i)
    boxes.push_back(add_at<2>(world, {{x, 0.5f + static_cast<float>(i)}}, box(0.5f, 0.5f)));
  return boxes;
}

/// A static half-space below the plane through the origin with this normal.
template <int D>
BodyId add_ground(World<D>& world, Vec<D> normal) {
  BodyDef<D> def;
  def.kind = BodyKind::kStatic;
  ShapeDef<D> shape;
  shape.kind = ShapeKind::kHalfSpace;
  shape.normal = normal;
  return add(world, def, shape);
}

template <int D>
Vec<D> up() {
  Vec<D> normal = Vec<D>::zero();
  normal[1] = 1.0f;
  return normal;
}

template <int D>
void step(World<D>& world, int ticks) {
  for (int i = 0; i < ticks; ++i) {
    const Error error = world.step();
    ASSERT_TRUE(error.ok()) << error.field;
  }
}

template <int D>
BodyView<D> view(const World<D>& world, BodyId id) {
  return world.body(id).value();
}

inline Rotation<2> turned(float angle) {
  return {{std::cos(angle), std::sin(angle)}};
}

}  // namespace cycloid::solver
