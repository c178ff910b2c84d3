#include "bench/peers/accuracy.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace cycloid::peers {

static solver::ShapeDef<2> square() {
  solver::ShapeDef<2> shape;
  shape.kind = solver::ShapeKind::kPolygon;
  shape.points = {{{-0.5f, -0.5f}}, {{0.5f, -0.5f}}, {{0.5f, 0.5f}}, {{-0.5f, 0.5f}}};
  return shape;
}

/// Two squares side by side, their middles 1 m apart.
static solver::World<2> two_squares() {
  solver::World<2> world = std::move(solver::World<2>::create({}).value());
  const auto shape = square();
  for (const float x : {0.0f, 1.0f}) {
    solver::BodyDef<2> body;
    body.position = {{x, 0.0f}};
    EXPECT_TRUE(world.create_body(body, std::span(&shape, 1)).ok());
  }
  return world;
}

/// The poses of a state with its second body moved along x.
template <int D>
static Poses<D> moved(const solver::WorldState<D>& state, float by) {
  return [&state, by](std::uint32_t body) {
    solver::Pose<D> pose{state.bodies[body].position, state.bodies[body].rotation};
    if (body == 1) pose.position[0] += by;
    return pose;
  };
}

TEST(AccuracyRuler, MeasuresTheDeepestOverlapInThePlane) {
  const solver::World<2> world = two_squares();
  EXPECT_NEAR(measure_accuracy(world.state(), moved(world.state(), -0.03f)).overlap_m, 0.03f, 1e-6);
  EXPECT_EQ(measure_accuracy(world.state(), moved(world.state(), 0.03f)).overlap_m, 0.0f);
}

TEST(AccuracyRuler, MeasuresTheDeepestOverlapInSpace) {
  solver::World<3> world = std::move(solver::World<3>::create({}).value());
  solver::ShapeDef<3> shape;
  shape.radius = 0.5f;
  for (const float x : {0.0f, 1.0f}) {
    solver::BodyDef<3> body;
    body.position = {{x, 0.0f, 0.0f}};
    ASSERT_TRUE(world.create_body(body, std::span(&shape, 1)).ok());
  }
  EXPECT_NEAR(measure_accuracy(world.state(), moved(world.state(), -0.25f)).overlap_m, 0.25f, 1e-6);
}

TEST(AccuracyRuler, MeasuresGapsOfJointsAndNoOverlapOfWhatTheyHold) {
  solver::World<2> world = two_squares();
  solver::JointDef<2> pin;
  pin.body_a = world.bodies()[0].id;
  pin.body_b = world.bodies()[1].id;
  pin.anchor_a = {{0.5f, 0.0f}};
  pin.anchor_b = {{-0.5f, 0.0f}};
  ASSERT_TRUE(world.create_joint(pin).ok());
  const Accuracy measured = measure_accuracy(world.state(), moved(world.state(), -0.2f));
  EXPECT_NEAR(measured.gap_m, 0.2f, 1e-6);
  EXPECT_EQ(measured.overlap_m, 0.0f);
}

TEST(AccuracyRuler, SeesBodiesThatAnEngineHasLost) {
  const solver::World<2> world = two_squares();
  EXPECT_TRUE(measure_accuracy(world.state(), moved(world.state(), 0.0f)).finite);
  const float nowhere = std::numeric_limits<float>::infinity();
  EXPECT_FALSE(measure_accuracy(world.state(), moved(world.state(), nowhere)).finite);
}

}  // namespace cycloid::peers
