#pragma once

#include <cmath>
#include <vector>

#include "solver/queries/query.hpp"
#include "solver/trig.hpp"
#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

/// Probes, static shapes and comparisons that the tests of the queries share.

inline constexpr float kRound = 2e-6f;

template <int D>
Probe<D> ball_probe(float radius) {
  Probe<D> probe;
  probe.count = 1;
  probe.radius = radius;
  return probe;
}

inline Probe<2> box_probe(float half_x, float half_y) {
  Probe<2> probe;
  probe.count = 4;
  probe.points = {
      {{{-half_x, -half_y}}, {{half_x, -half_y}}, {{half_x, half_y}}, {{-half_x, half_y}}}};
  return probe;
}

template <int D>
Pose<D> pose_of(Vec<D> position) {
  return {position, identity_rotation<D>()};
}

inline BodyId add_static(World<2>& world, Vec<2> position, const ShapeDef<2>& shape,
                         float angle = 0.0f) {
  BodyDef<2> def;
  def.kind = BodyKind::kStatic;
  def.position = position;
  def.rotation = turned(angle);
  return add(world, def, shape);
}

inline ShapeDef<2> chain(std::vector<Vec<2>> points) {
  ShapeDef<2> shape;
  shape.kind = ShapeKind::kChain;
  shape.points = std::move(points);
  return shape;
}

template <int D>
void expect_near(const Vec<D>& a, const Vec<D>& b, float tolerance = kRound) {
  for (int i = 0; i < D; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << "axis " << i;
}

}  // namespace cycloid::solver
