#include "solver/constraints/contact_plane.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "solver/constraints/contact_lanes.hpp"

namespace cycloid::solver {

using PlaneLanes = Lanes<4>;
using PlaneBlock = ContactBlock<2, 4>;

/// Two bodies in each lane that touch at two points, drawn, and their motions.
struct TouchingPairs {
  PlaneBlock block{};
  MotionLanes<2, 4> a;
  MotionLanes<2, 4> b;
};

static PlaneLanes drawn_lanes(std::mt19937& random, float least, float most) {
  float lanes[4];
  for (float& value : lanes)
    value = least + (most - least) * static_cast<float>(random() % 65536) / 65536.0f;
  return PlaneLanes::load(lanes);
}

static MotionLanes<2, 4> drawn_motions(std::mt19937& random) {
  MotionLanes<2, 4> motions{};
  for (PlaneLanes& part : motions.velocity.v) part = drawn_lanes(random, -2.0f, 2.0f);
  motions.spin[0] = drawn_lanes(random, -3.0f, 3.0f);
  return motions;
}

static LaneMass<2, 4> drawn_mass(std::mt19937& random) {
  LaneMass<2, 4> mass;
  mass.inverse_mass = drawn_lanes(random, 0.1f, 4.0f);
  mass.inverse_inertia[0] = drawn_lanes(random, 0.2f, 9.0f);
  return mass;
}

static TouchingPairs drawn_pairs(std::mt19937& random) {
  TouchingPairs pairs;
  PlaneBlock& block = pairs.block;
  block.point_count = 2;
  block.turns = true;
  block.rubs = true;
  block.moves_a = block.moves_b = kAllLanes<4>;
  block.mass_a = drawn_mass(random);
  block.mass_b = drawn_mass(random);
  const PlaneLanes x = drawn_lanes(random, -1.0f, 1.0f);
  block.normal = {{x, sqrt(PlaneLanes(1.0f) - x * x)}};
  for (PlaneLanes& part : block.between.v) part = drawn_lanes(random, -2.0f, 2.0f);
  for (PlaneLanes& part : block.slide_a.v) part = drawn_lanes(random, -0.05f, 0.05f);
  for (PlaneLanes& part : block.slide_b.v) part = drawn_lanes(random, -0.05f, 0.05f);
  block.friction = drawn_lanes(random, 0.2f, 1.0f);
  for (auto& point : block.points) {
    for (PlaneLanes& part : point.r_a.v) part = drawn_lanes(random, -1.0f, 1.0f);
    point.gap = drawn_lanes(random, -0.02f, 0.01f);
    point.normal_mass = PlaneLanes(1.0f);  // It exists; its effective mass comes now.
    point.normal_impulse = drawn_lanes(random, 0.0f, 1.0f);
    point.tangent_impulse[0] = drawn_lanes(random, -0.2f, 0.2f);
  }
  set_first_masses(PlaneLanes(1.0f), block);
  pairs.a = drawn_motions(random);
  pairs.b = drawn_motions(random);
  return pairs;
}

static StepContext<2> soft_context(bool odd) {
  StepContext<2> context = make_step_context<2>(1.0f / 60.0f, {{0.0f, -10.0f}}, Tuning{});
  context.odd = odd;
  return context;
}

static void expect_lanes_near(const PlaneLanes& expected, const PlaneLanes& actual) {
  float one[4];
  float other[4];
  expected.store(one);
  actual.store(other);
  for (int lane = 0; lane < 4; ++lane) EXPECT_NEAR(one[lane], other[lane], 2.0e-5f);
}

static void expect_lanes_near(const MotionLanes<2, 4>& expected, const MotionLanes<2, 4>& actual) {
  for (int i = 0; i < 2; ++i) expect_lanes_near(expected.velocity[i], actual.velocity[i]);
  expect_lanes_near(expected.spin[0], actual.spin[0]);
}

/// The same sweep row by row: each row reads and moves both bodies.
static void sweep_row_by_row(const StepContext<2>& context, Sweep sweep, TouchingPairs& pairs) {
  const SoftnessLanes<4> soft = softness_of(context, pairs.block);
  for (std::uint32_t i = 0; i < 2; ++i)
    solve_normal(context, sweep, pairs.block, soft,
                 pairs.block.points[point_in_turn(context, sweep, i, 2)], pairs.a, pairs.b);
  for (std::uint32_t i = 0; i < 2; ++i) solve_friction(context, pairs.block, i, pairs.a, pairs.b);
}

static void sweep_along(const StepContext<2>& context, Sweep sweep, TouchingPairs& pairs) {
  solve_normals_along(context, sweep, pairs.block, softness_of(context, pairs.block), pairs.a,
                      pairs.b);
  solve_frictions_along(context, pairs.block, pairs.a, pairs.b);
}

TEST(ContactPlane, SweepsBothPointsAsRowByRow) {
  std::mt19937 random(20261127);
  for (int round = 0; round < 400; ++round) {
    const StepContext<2> context = soft_context(round % 2 == 1);
    TouchingPairs by_row = drawn_pairs(random);
    TouchingPairs along = by_row;
    const Sweep sweep = round % 4 < 2 ? Sweep::kBiased : Sweep::kRelax;
    sweep_row_by_row(context, sweep, by_row);
    sweep_along(context, sweep, along);
    expect_lanes_near(by_row.a, along.a);
    expect_lanes_near(by_row.b, along.b);
    for (int p = 0; p < 2; ++p) {
      expect_lanes_near(by_row.block.points[p].normal_impulse,
                        along.block.points[p].normal_impulse);
      expect_lanes_near(by_row.block.points[p].tangent_impulse[0],
                        along.block.points[p].tangent_impulse[0]);
    }
    ASSERT_FALSE(HasFailure()) << "round " << round;
  }
}

TEST(ContactPlane, WarmStartsBothPointsAsOneByOne) {
  std::mt19937 random(20261128);
  for (int round = 0; round < 200; ++round) {
    TouchingPairs one_by_one = drawn_pairs(random);
    TouchingPairs along = one_by_one;
    warm_start_points(one_by_one.block, one_by_one.a, one_by_one.b);
    warm_start_along(along.block, along.a, along.b);
    expect_lanes_near(one_by_one.a, along.a);
    expect_lanes_near(one_by_one.b, along.b);
    ASSERT_FALSE(HasFailure()) << "round " << round;
  }
}

/// A lane may stand in a block whose other lanes have two points.
TEST(ContactPlane, APointThatALaneLacksChangesNoBit) {
  std::mt19937 random(20261129);
  for (int round = 0; round < 400; ++round) {
    const StepContext<2> context = soft_context(round % 2 == 1);
    TouchingPairs among_others = drawn_pairs(random);
    among_others.block.points[1] = {};
    TouchingPairs alone = among_others;
    alone.block.point_count = 1;
    const Sweep sweep = round % 4 < 2 ? Sweep::kBiased : Sweep::kRelax;
    for (TouchingPairs* pairs : {&among_others, &alone}) {
      warm_start_along(pairs->block, pairs->a, pairs->b);
      sweep_along(context, sweep, *pairs);
    }
    EXPECT_EQ(std::memcmp(&among_others.a, &alone.a, sizeof alone.a), 0) << "round " << round;
    EXPECT_EQ(std::memcmp(&among_others.b, &alone.b, sizeof alone.b), 0) << "round " << round;
    EXPECT_EQ(std::memcmp(among_others.block.points, alone.block.points, sizeof alone.block.points),
              0)
        << "round " << round;
  }
}

}  // namespace cycloid::solver
