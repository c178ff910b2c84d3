#include "bench/peers/accuracy.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <span>
#include <utility>
#include <vector>

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

/// The gaps of two bodies 1 m apart along x that a joint holds, the second moved by `by` from where
/// it was made.
template <int D>
static std::vector<float> gaps_when_moved(solver::JointDef<D> joint, const solver::Vec<D>& by) {
  solver::World<D> world = std::move(solver::World<D>::create({}).value());
  solver::ShapeDef<D> ball;
  ball.radius = 0.5f;
  solver::BodyDef<D> body;
  joint.body_a = world.create_body(body, std::span(&ball, 1)).value();
  body.position[0] = 1.0f;
  joint.body_b = world.create_body(body, std::span(&ball, 1)).value();
  const auto made = world.create_joint(joint);
  EXPECT_TRUE(made.ok()) << made.error().field;
  return gaps_of<D>(world.state(), [&](std::uint32_t slot) {
    const solver::Body<D>& at = world.state().bodies[slot];
    return solver::Pose<D>{slot == 1 ? at.position + by : at.position, at.rotation};
  });
}

template <int D>
static void expect_joint_gap(const solver::JointDef<D>& joint, const solver::Vec<D>& by,
                             float gap) {
  const std::vector<float> gaps = gaps_when_moved(joint, by);
  ASSERT_EQ(gaps.size(), 1u);
  EXPECT_NEAR(gaps[0], gap, 1e-6f);
}

TEST(AccuracyRuler, MeasuresWhatARodOrARopeIsOffItsLength) {
  solver::JointDef<2> rod;
  rod.kind = solver::JointKind::kDistance;
  rod.length = 1.0f;
  expect_joint_gap(rod, {{0.2f, 0.0f}}, 0.2f);
  expect_joint_gap(rod, {{-0.2f, 0.0f}}, 0.2f);
  solver::JointDef<2> rope = rod;
  rope.limit_enabled = true;
  rope.lower = 0.5f;
  rope.upper = 1.1f;
  expect_joint_gap(rope, {{0.3f, 0.0f}}, 0.2f);
  expect_joint_gap(rope, {{0.05f, 0.0f}}, 0.0f);
  expect_joint_gap(rope, {{-0.7f, 0.0f}}, 0.2f);
  solver::JointDef<3> in_space;
  in_space.kind = solver::JointKind::kDistance;
  in_space.length = 1.0f;
  expect_joint_gap(in_space, {{0.2f, 0.0f, 0.0f}}, 0.2f);
}

TEST(AccuracyRuler, MeasuresSlidersAcrossTheirAxisAndBeyondTheirLimits) {
  solver::JointDef<2> rail;
  rail.kind = solver::JointKind::kPrismatic;
  rail.anchor_a = {{1.0f, 0.0f}};
  rail.axis = {{1.0f, 0.0f}};
  expect_joint_gap(rail, {{0.5f, 0.2f}}, 0.2f);
  rail.limit_enabled = true;
  rail.upper = 0.1f;
  expect_joint_gap(rail, {{0.5f, 0.3f}}, 0.5f);
  solver::JointDef<3> in_space;
  in_space.kind = solver::JointKind::kPrismatic;
  in_space.anchor_a = {{1.0f, 0.0f, 0.0f}};
  in_space.axis = {{1.0f, 0.0f, 0.0f}};
  expect_joint_gap(in_space, {{0.5f, 0.3f, 0.4f}}, 0.5f);
}

TEST(AccuracyRuler, MeasuresWheelsAcrossTheirSuspension) {
  solver::JointDef<2> wheel;
  wheel.kind = solver::JointKind::kWheel;
  wheel.anchor_a = {{1.0f, 0.0f}};
  wheel.axis = {{0.0f, 1.0f}};
  wheel.hertz = 4.0f;
  expect_joint_gap(wheel, {{0.2f, 0.5f}}, 0.2f);
  solver::JointDef<3> in_space;
  in_space.kind = solver::JointKind::kWheel;
  in_space.anchor_a = {{1.0f, 0.0f, 0.0f}};
  in_space.axis = {{0.0f, 1.0f, 0.0f}};
  in_space.axle = {{0.0f, 0.0f, 1.0f}};
  in_space.hertz = 4.0f;
  expect_joint_gap(in_space, {{0.3f, 0.7f, 0.4f}}, 0.5f);
}

TEST(AccuracyRuler, MeasuresPulleysAndCurves) {
  solver::JointDef<2> pulley;
  pulley.kind = solver::JointKind::kPulley;
  pulley.ground_a = {{0.0f, 4.0f}};
  pulley.ground_b = {{1.0f, 4.0f}};
  pulley.ratio = 2.0f;
  expect_joint_gap(pulley, {{0.0f, -0.1f}}, 0.2f);
  solver::JointDef<2> bead;
  bead.kind = solver::JointKind::kCurve;
  bead.curve = solver::CurveKind::kCircle;
  bead.size = {1.0f, 0.0f};
  expect_joint_gap(bead, {{0.2f, 0.0f}}, 0.2f);
  expect_joint_gap(bead, {{-1.0f, 1.0f}}, 0.0f);
}

// A spring that gives way is no error, and of what has no length nobody can say one.
TEST(AccuracyRuler, LeavesOutWhatGivesWayByDesignAndWhatHasNoLength) {
  solver::JointDef<2> weld;
  weld.kind = solver::JointKind::kWeld;
  weld.anchor_a = {{1.0f, 0.0f}};
  weld.angular_hertz = 2.0f;
  expect_joint_gap(weld, {{0.2f, 0.0f}}, 0.2f);
  weld.hertz = 2.0f;
  EXPECT_TRUE(gaps_when_moved(weld, {{0.2f, 0.0f}}).empty());
  solver::JointDef<2> spring;
  spring.kind = solver::JointKind::kDistance;
  spring.length = 1.0f;
  spring.hertz = 2.0f;
  EXPECT_TRUE(gaps_when_moved(spring, {{0.2f, 0.0f}}).empty());
  for (const auto kind :
       {solver::JointKind::kMotor, solver::JointKind::kTarget, solver::JointKind::kGear}) {
    solver::JointDef<2> joint;
    joint.kind = kind;
    EXPECT_TRUE(gaps_when_moved(joint, {{0.2f, 0.0f}}).empty());
  }
}

TEST(AccuracyRuler, SeesBodiesThatAnEngineHasLost) {
  const solver::World<2> world = two_squares();
  EXPECT_TRUE(measure_accuracy(world.state(), moved(world.state(), 0.0f)).finite);
  const float nowhere = std::numeric_limits<float>::infinity();
  EXPECT_FALSE(measure_accuracy(world.state(), moved(world.state(), nowhere)).finite);
}

}  // namespace cycloid::peers
