#include "bench/accuracy/contact_problem.hpp"

#include <cmath>

#include "tests/accuracy/worlds.hpp"

namespace cycloid::accuracy {

using solver::World;
using solver::WorldState;

/// Of gravity on 1 kg in one of four substeps, N s.
static constexpr double kWeight = 10.0 / 240.0;

template <int D>
static double sum_of_normals(const ContactProblem<D>& problem) {
  double sum = 0.0;
  for (const ProblemRow<D>& row : problem.rows)
    if (row.kind == RowKind::kNormal) sum += row.impulse;
  return sum;
}

template <int D>
static void expect_a_resting_box_to_be_solved() {
  const World<D> world = resting_box<D>();
  const ContactProblem<D> problem = contact_problem(world.state());
  ASSERT_EQ(problem.rows.size(), D == 2 ? 4u : 12u);
  EXPECT_NEAR(sum_of_normals(problem), kWeight, 1e-5 * kWeight);
  const auto residual = residual_of(problem);
  EXPECT_LT(residual.relative, 1e-4);
  EXPECT_LT(residual.complementarity, 1e-6);
  EXPECT_EQ(cone_excess(problem), 0.0);
  const auto errors = direct_errors(problem, world.state(), 80);
  ASSERT_TRUE(errors.has_value());
  EXPECT_FALSE(errors->impulse.has_value()) << "two or four points share one weight at will";
  EXPECT_LT(errors->wrench, 1e-4);
  EXPECT_LT(errors->velocity, 1e-4);
}

TEST(ContactProblem, OfARestingBoxIsSolvedInThePlane) {
  expect_a_resting_box_to_be_solved<2>();
}
TEST(ContactProblem, OfARestingBoxIsSolvedInSpace) {
  expect_a_resting_box_to_be_solved<3>();
}

// A box that falls at 1 m/s while nothing pushes: each point should push until it does not.
template <int D>
static void expect_a_falling_box_to_be_wrong() {
  World<D> world = resting_box<D>();
  WorldState<D> state = world.state();
  state.bodies.moved(1).velocity[1] = -1.0f;
  for (auto& point : state.contacts[0].points) point.normal_impulse = 0.0f;
  const ContactProblem<D> problem = contact_problem(state);
  double inverse = 0.0;
  for (const auto& row : problem.rows)
    if (row.kind == RowKind::kNormal) inverse = std::max(inverse, row.inverse);
  const auto residual = residual_of(problem);
  EXPECT_NEAR(residual.natural_map, 1.0 / inverse, 1e-3);
  EXPECT_NEAR(residual.relative, 1.0, 1e-2) << "as wrong as no impulses at all";
  const auto errors = direct_errors(problem, state, 80);
  ASSERT_TRUE(errors.has_value());
  EXPECT_NEAR(errors->wrench, 1.0, 1e-6);
  EXPECT_NEAR(errors->velocity, 1.0, 1e-6);
}

TEST(ContactProblem, OfAFallingBoxIsWrongInThePlane) {
  expect_a_falling_box_to_be_wrong<2>();
}
TEST(ContactProblem, OfAFallingBoxIsWrongInSpace) {
  expect_a_falling_box_to_be_wrong<3>();
}

// Impulses of twice the weight that lift the box: the work lambda w of it.
TEST(ContactProblem, PushingWhatAlreadyPartsIsWork) {
  World<2> world = resting_box<2>();
  WorldState<2> state = world.state();
  state.bodies.moved(1).velocity = {{0.0f, 0.5f}};
  state.bodies.moved(1).spin = {{0.0f}};
  double largest = 0.0;
  for (const auto& point : state.contacts[0].points)
    largest = std::max(largest, static_cast<double>(point.normal_impulse));
  const auto residual = residual_of(contact_problem(state));
  EXPECT_NEAR(residual.complementarity, 0.5 * largest, 1e-3 * largest);
}

TEST(ContactProblem, FrictionBeyondItsConeIsSeen) {
  World<3> world = resting_box<3>();
  WorldState<3> state = world.state();
  double largest = 0.0;
  for (const auto& point : state.contacts[0].points)
    largest = std::max(largest, static_cast<double>(point.normal_impulse));
  auto& point = state.contacts[0].points[0];
  const float over = 0.6f * point.normal_impulse + 0.25f * static_cast<float>(largest);
  point.tangent_impulse = {{0.6f * over, 0.8f * over}};
  EXPECT_NEAR(cone_excess(contact_problem(state)), 0.25, 1e-3);
}

// Where the reference has the same problem with its matrix, both measure alike.
TEST(ContactProblem, AgreesWithTheReferenceInThePlane) {
  World<2> world = empty_world<2>(solver::Tuning::pgs());
  add_ground(world);
  for (int i = 0; i < 4; ++i)
    add_box(world, 0.1f * static_cast<float>(i % 2), 0.5f + static_cast<float>(i),
            i == 3 ? 30.0f : 1.0f);
  solver::JointDef<2> pin;
  pin.body_a = world.bodies()[3].id;
  pin.body_b = world.bodies()[4].id;
  pin.anchor_a = {{0.5f, 0.5f}};
  pin.anchor_b = {{0.4f, -0.5f}};
  ASSERT_TRUE(world.create_joint(pin).ok());
  ASSERT_TRUE(world.set_velocity(world.bodies()[2].id, {{3.0f, 0.0f}}, {{0.0f}}).ok());
  step(world, 5);
  const auto problem = contact_problem(world.state());
  ASSERT_GT(problem.rows.size(), 8u);
  const reference::Mlcp mlcp = dense(problem, world.state());
  std::vector<double> lambda;
  for (const auto& row : problem.rows) lambda.push_back(row.impulse);
  const std::vector<double> w = reference::velocities(mlcp, lambda);
  for (std::size_t i = 0; i < w.size(); ++i) EXPECT_NEAR(w[i], problem.rows[i].speed, 1e-9);
  const auto ours = residual_of(problem);
  const auto theirs = reference::residual_of(mlcp, lambda);
  EXPECT_GT(ours.natural_map, 0.0);
  EXPECT_NEAR(ours.natural_map, theirs.natural_map, 1e-9 * theirs.impulse_scale);
  EXPECT_NEAR(ours.relative, theirs.relative, 1e-9);
  EXPECT_NEAR(ours.complementarity, theirs.complementarity, 1e-9);
  EXPECT_NEAR(ours.impulse_scale, theirs.impulse_scale, 1e-9 * theirs.impulse_scale);
}

// A weight on a pin: the one impulse that there can be, so the error of each row has a meaning.
TEST(ContactProblem, UniqueImpulsesAreCompared) {
  World<2> world = empty_world<2>();
  solver::BodyDef<2> wall;
  wall.kind = solver::BodyKind::kStatic;
  solver::JointDef<2> pin;
  pin.body_a = world.create_body(wall, {}).value();
  pin.body_b = add_box(world, 0.0f, -1.0f, 3.0f);
  pin.anchor_b = {{0.0f, 1.0f}};
  ASSERT_TRUE(world.create_joint(pin).ok());
  step(world, 60);
  WorldState<2> state = world.state();
  auto errors = direct_errors(contact_problem(state), state, 80);
  ASSERT_TRUE(errors.has_value());
  ASSERT_TRUE(errors->impulse.has_value());
  EXPECT_LT(*errors->impulse, 1e-5);
  const double weight = 3.0 * kWeight;
  const auto problem = contact_problem(state);
  EXPECT_NEAR(std::abs(problem.rows[1].impulse), weight, 1e-5 * weight);
  // A tenth less, and the weight falls by as much.
  state.joints.moved(0).impulse[1] *= 0.9f;
  state.bodies.moved(1).velocity[1] -= static_cast<float>(0.1 * weight / 3.0);
  errors = direct_errors(contact_problem(state), state, 80);
  ASSERT_TRUE(errors && errors->impulse);
  EXPECT_NEAR(*errors->impulse, 0.1, 1e-4);
  EXPECT_NEAR(errors->velocity, 0.1, 1e-4);
}

/// How many rows of a weight that hangs on a joint count.
template <int D>
static std::size_t rows_of_weight_on(solver::JointDef<D> joint) {
  World<D> world = empty_world<D>();
  solver::BodyDef<D> wall;
  wall.kind = solver::BodyKind::kStatic;
  joint.body_a = world.create_body(wall, {}).value();
  joint.body_b = add_box(world, 0.0f, -1.0f);
  joint.anchor_b[1] = 1.0f;
  EXPECT_TRUE(world.create_joint(joint).ok());
  step(world, 10);
  return contact_problem(world.state()).rows.size();
}

// What rubs or springs about a point that holds takes nothing from it.
TEST(ContactProblem, TakesTheBlocksOfAJointThatDoNotYield) {
  solver::JointDef<3> shoulder;
  shoulder.kind = solver::JointKind::kConeTwist;
  shoulder.axis = {{0.0f, 0.0f, 1.0f}};
  EXPECT_EQ(rows_of_weight_on(shoulder), 3u);
  shoulder.torque_max = 0.5f;
  EXPECT_EQ(rows_of_weight_on(shoulder), 3u);
  shoulder.angular_hertz = 2.0f;
  EXPECT_EQ(rows_of_weight_on(shoulder), 3u);
  solver::JointDef<2> weld;
  weld.kind = solver::JointKind::kWeld;
  EXPECT_EQ(rows_of_weight_on(weld), 3u);
  weld.angular_hertz = 2.0f;
  EXPECT_EQ(rows_of_weight_on(weld), 2u) << "the point";
  weld.hertz = 2.0f;
  EXPECT_EQ(rows_of_weight_on(weld), 0u);
  weld.angular_hertz = 0.0f;
  EXPECT_EQ(rows_of_weight_on(weld), 1u) << "the angle";
  solver::JointDef<2> target;
  target.kind = solver::JointKind::kTarget;
  target.force_max = 100.0f;
  EXPECT_EQ(rows_of_weight_on(target), 0u);
}

TEST(ContactProblem, DirectSolutionIsLeftOutWhereItHasNoConeOrTooManyRows) {
  World<3> world = resting_box<3>();
  EXPECT_FALSE(direct_errors(contact_problem(world.state()), world.state(), 11).has_value());
  ASSERT_TRUE(world.set_velocity(world.bodies()[1].id, {{3.0f, 0.0f, 1.0f}}, {}).ok());
  step(world, 1);
  EXPECT_FALSE(direct_errors(contact_problem(world.state()), world.state(), 80).has_value());
}

}  // namespace cycloid::accuracy
