#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "protocol/state/quantised.hpp"
#include "protocol/state/quantised_rotation.hpp"
#include "tests/protocol/state_scenes.hpp"

namespace cycloid::protocol {
namespace {

using states::Played;

/// Of the turn from one rotation to the other, rad.
double angle_between(const std::array<float, 4>& a, const std::array<float, 4>& b) {
  double dot = 0.0;
  for (std::size_t i = 0; i < 4; ++i) dot += double{a[i]} * double{b[i]};
  double chord =
      0.0;  // Between the nearer one of b and -b, so that small angles keep their digits.
  for (std::size_t i = 0; i < 4; ++i) {
    const double difference = double{a[i]} - (dot < 0.0 ? -1.0 : 1.0) * double{b[i]};
    chord += difference * difference;
  }
  return 4.0 * std::asin(std::min(1.0, 0.5 * std::sqrt(chord)));
}

/// Half a step, and what a float that far out is rounded by.
double position_bound_m(double value_m) {
  return 0.5 * double{kPositionStep_m} + std::abs(value_m) * 1.2e-7;
}

solver::Rotation<3> any_rotation(std::mt19937& random) {
  std::normal_distribution<float> normal;
  solver::Rotation<3> q;
  for (int i = 0; i < 4; ++i) q[i] = normal(random);
  // Ties of the largest component, and its smallest size, are the hard cases.
  if (random() % 4 == 0)
    for (int i = 0; i < 4; ++i) q[i] = (q[i] < 0.0f ? -1.0f : 1.0f) + 0.001f * normal(random);
  if (random() % 16 == 0) q = {{1.0f, 0.0f, 0.0f, -1.0f}};
  const float length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (int i = 0; i < 4; ++i) q[i] /= length;
  return q;
}

TEST(Quantised, RotationInSpaceIsWithinItsBound) {
  std::mt19937 random(11);
  double worst = 0.0;
  for (int i = 0; i < 1'000'000; ++i) {
    const solver::Rotation<3> q = any_rotation(random);
    const QuantisedRotation on_grid = quantise_rotation(q);
    ASSERT_TRUE(is_on_grid(on_grid, 3));
    const std::array<float, 4> back = quaternion_of(on_grid, 3);
    worst = std::max(worst, angle_between({q[0], q[1], q[2], q[3]}, back));
  }
  EXPECT_LE(worst, double{kRotationErrorMax_rad});
  EXPECT_GT(worst, 0.7 * double{kRotationErrorMax_rad}) << "a bound that says little";
  std::printf("worst turn in space %.5f rad\n", worst);
}

TEST(Quantised, RotationInThePlaneIsWithinItsBound) {
  std::mt19937 random(12);
  std::uniform_real_distribution<double> any(-3.1415926535, 3.1415926535);
  double worst = 0.0;
  for (int i = 0; i < 1'000'000; ++i) {
    const double angle = any(random);
    const solver::Rotation<2> q = {{float(std::cos(angle)), float(std::sin(angle))}};
    const QuantisedRotation on_grid = quantise_rotation(q);
    ASSERT_TRUE(is_on_grid(on_grid, 2));
    const std::array<float, 4> exact = {0.0f, 0.0f, float(std::sin(0.5 * angle)),
                                        float(std::cos(0.5 * angle))};
    worst = std::max(worst, angle_between(exact, quaternion_of(on_grid, 2)));
  }
  EXPECT_LE(worst, double{kAngleErrorMax_rad});
  EXPECT_GT(worst, 0.9 * double{kAngleErrorMax_rad});
}

TEST(Quantised, AnyNumbersOfARotationAreShownAsOne) {
  std::mt19937 random(13);
  for (int i = 0; i < 100'000; ++i) {
    QuantisedRotation any;
    any.largest = static_cast<std::uint8_t>(random() % 4);
    for (std::int16_t& part : any.parts)
      part = static_cast<std::int16_t>(static_cast<int>(random() % 1023) - kRotationParts);
    double square = 0.0;
    for (const float part : quaternion_of(any, 3)) square += double{part} * double{part};
    ASSERT_NEAR(square, 1.0, 1e-6);
  }
}

TEST(Quantised, ARotationIsGuessedAcrossItsLargestComponent) {
  std::mt19937 random(14);
  for (int i = 0; i < 100'000; ++i) {
    const solver::Rotation<3> q = any_rotation(random);
    const QuantisedRotation on_grid = quantise_rotation(q);
    for (std::uint8_t other = 0; other < 4; ++other) {
      // Only a component that is nearly as large becomes the largest one of a body that turns.
      if (std::abs(q[other]) < 0.9f * std::abs(q[on_grid.largest])) continue;
      const auto parts = parts_without(on_grid, other);
      const float scale = (q[other] < 0.0f ? -1.0f : 1.0f) * kRotationParts / 0.70710678f;
      std::size_t at = 0;
      for (int k = 0; k < 4; ++k)
        if (k != other) {
          ASSERT_NEAR(static_cast<float>(parts[at++]), scale * q[k], 4.0f);
        }
    }
  }
}

TEST(Quantised, PositionsAreWithinHalfAStepAsFarAsTheLimit) {
  Played played("newtons-cradle");
  solver::World<2>* world = played.simulation().planar();
  solver::BodyId moved;
  for (const solver::BodyView<2>& body : world->bodies())
    if (body.kind == solver::BodyKind::kDynamic) moved = body.id;
  std::mt19937 random(15);
  std::uniform_real_distribution<float> any(-1.0f, 1.0f);
  for (int i = 0; i < 20'000; ++i) {
    const float reach = std::ldexp(1.0f, static_cast<int>(random() % 23));
    const float angle = 3.1415926f * any(random);
    ASSERT_TRUE(world
                    ->set_pose(moved, {{reach * any(random), reach * any(random)}},
                               {{std::cos(angle), std::sin(angle)}})
                    .ok());
    const QuantisedState state = capture(played.simulation());
    const auto poses = played.simulation().poses();
    ASSERT_EQ(state.bodies.size(), poses.size());
    for (std::size_t k = 0; k < poses.size(); ++k) {
      const scenes::Pose shown = pose_of(state.bodies[k], state.dimension);
      ASSERT_EQ(shown.index, poses[k].index);
      ASSERT_EQ(shown.generation, poses[k].generation);
      ASSERT_LE(angle_between(shown.rotation, poses[k].rotation), double{kAngleErrorMax_rad});
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double exact =
            std::clamp(poses[k].position[axis], -kPositionLimit_m, kPositionLimit_m);
        ASSERT_NEAR(shown.position[axis], exact, position_bound_m(exact));
      }
    }
  }
  // Farther out it is clamped, and not wrapped round.
  ASSERT_TRUE(world->set_pose(moved, {{9.0e6f, -9.0e6f}}, {{1.0f, 0.0f}}).ok());
  const QuantisedState state = capture(played.simulation());
  const auto at = std::find_if(state.bodies.begin(), state.bodies.end(),
                               [&](const auto& body) { return body.index == moved.index; });
  EXPECT_EQ(pose_of(*at, 2).position[0], kPositionLimit_m);
  EXPECT_EQ(pose_of(*at, 2).position[1], -kPositionLimit_m);
}

void expect_within(const scenes::Simulation& simulation, const QuantisedState& state) {
  const auto poses = simulation.poses();
  const double turn_max = state.dimension == 2 ? kAngleErrorMax_rad : kRotationErrorMax_rad;
  ASSERT_EQ(state.bodies.size(), poses.size());
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const scenes::Pose shown = pose_of(state.bodies[k], state.dimension);
    ASSERT_EQ(shown.index, poses[k].index);
    ASSERT_LE(angle_between(shown.rotation, poses[k].rotation), turn_max);
    for (std::size_t axis = 0; axis < 3; ++axis)
      ASSERT_NEAR(shown.position[axis], poses[k].position[axis],
                  position_bound_m(poses[k].position[axis]));
  }
  const auto characters = simulation.characters();
  ASSERT_EQ(state.characters.size(), characters.size());
  for (std::size_t k = 0; k < characters.size(); ++k) {
    const scenes::CharacterPose shown = pose_of(state.characters[k]);
    EXPECT_EQ(shown.grounded, characters[k].grounded);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      ASSERT_NEAR(shown.position[axis], characters[k].position[axis],
                  position_bound_m(characters[k].position[axis]));
      ASSERT_NEAR(shown.velocity[axis], characters[k].velocity[axis], 0.5f * kVelocityStep + 1e-5f);
    }
  }
}

TEST(Quantised, WhatScenesShowIsWithinTheBounds) {
  for (const std::string& name : states::names()) {
    SCOPED_TRACE(name);
    Played played(name);
    for (int tick = 0; tick < 120; ++tick) {
      played.step();
      expect_within(played.simulation(), capture(played.simulation()));
    }
  }
}

TEST(Quantised, VelocitiesAreWithinHalfAStepWhereTheyAreWanted) {
  Played played("ragdolls-3d");
  played.step(40);
  const QuantisedState without = capture(played.simulation());
  const QuantisedState with = capture(played.simulation(), {true});
  std::size_t moving = 0;
  for (const QuantisedBody& body : without.bodies)
    EXPECT_EQ(velocity_of(body), (std::array<float, 3>{}));
  for (const QuantisedBody& body : with.bodies) {
    const auto& exact = played.simulation().spatial()->state().bodies[body.index];
    const solver::Vec<3> centre = rotate(exact.rotation, exact.local_center);
    const solver::Vec<3> velocity = exact.velocity - cross(exact.spin, centre);
    moving += body.at_rest ? 0 : 1;
    for (int axis = 0; axis < 3; ++axis) {
      const auto at = static_cast<std::size_t>(axis);
      ASSERT_NEAR(velocity_of(body)[at], velocity[axis], 0.5f * kVelocityStep + 1e-4f);
      ASSERT_NEAR(spin_of(body)[at], exact.spin[axis], 0.5f * kVelocityStep + 1e-4f);
    }
  }
  EXPECT_GT(moving, 5u);
}

TEST(Quantised, ABodyAsleepIsAtRest) {
  Played played("cubes-901");
  played.idle(400);
  for (const QuantisedBody& body : capture(played.simulation()).bodies)
    EXPECT_TRUE(body.at_rest) << body.index;
  played.step(60);
  std::size_t moving = 0;
  for (const QuantisedBody& body : capture(played.simulation()).bodies)
    moving += body.at_rest ? 0 : 1;
  EXPECT_GE(moving, 1u);
}

TEST(Quantised, EveryNumberIsInTheDigest) {
  Played played("character-course-3d");
  played.step(20);
  const QuantisedState state = capture(played.simulation());
  std::vector<QuantisedState> others(12, state);
  others[0].tick += 1;
  others[1].dimension = 2;
  others[2].bodies[1].index += 100;
  others[3].bodies[1].generation += 1;
  others[4].bodies[1].position[2] += 1;
  others[5].bodies[1].rotation.largest ^= 1;
  others[6].bodies[1].rotation.parts[2] += 1;
  others[7].bodies[1].velocity[0] += 1;
  others[8].bodies[1].spin[2] += 1;
  others[9].bodies[1].at_rest = !others[9].bodies[1].at_rest;
  others[10].characters[0].velocity[1] += 1;
  others[11].characters[0].grounded = !others[11].characters[0].grounded;
  for (const QuantisedState& other : others) {
    EXPECT_NE(digest_of(other), digest_of(state)) << &other - others.data();
    EXPECT_NE(other, state);
  }
  EXPECT_TRUE(shows_the_same(others[0], state));
  EXPECT_FALSE(shows_the_same(others[4], state));
}

}  // namespace
}  // namespace cycloid::protocol
