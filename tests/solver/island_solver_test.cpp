#include "solver/direct/island_solver.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace cycloid::solver {

/// A body of 1 kg that two points of contact with the ground push up and rub to the right.
struct BodyOnGround {
  IslandSolver<2> solver;
  IslandSolver<2>::Island island{};
  std::vector<BodyMass<2>> masses = {{1.0f, {{1.0f}}}};
  std::vector<Motion<2>> motions = std::vector<Motion<2>>(1);

  BodyOnGround() {
    solver.matrix.begin(1);
    solver.matrix.put_last(0);
    EXPECT_TRUE(solver.matrix.analyse({0, 1}, 100, island.steps));
    island.nodes = {0, 1};
    island.contact_steps = solver.matrix.last_of(island.steps);
    island.products = island.contact_products = 1;
    island.products_left = 1000;
    solver.body_of = {0};
    solver.change.resize(1);
    solver.before.resize(1);
    solver.correction.resize(1);
    for (int point = 0; point < 2; ++point) {
      solver.groups.push_back({-1, 0, -1, 2 * point, 2, true, 0.5, {}, {}});
      add_row(0.0f, 1.0f);
      add_row(1.0f, 0.0f);
    }
    island.groups = {0, 2};
    island.joints = {2, 2};
  }
  void add_row(float x, float y) {
    IslandRow<2> row{};
    row.b[0] = x;
    row.b[1] = y;
    row.mass = 1.0f;
    row.stiffness = 1000.0f;
    solver.rows.push_back(row);
  }
  Solved solve() { return solver.solve(island, masses, motions, {1.0 / 240.0, 3.0}); }
};

TEST(IslandSolver, StopsABodyThatFallsOnTwoPoints) {
  BodyOnGround body;
  for (const std::size_t normal : {0, 2}) body.solver.rows[normal].missing = -1.0;
  EXPECT_EQ(body.solve(), Solved::kWhole);
  EXPECT_NEAR(body.solver.change[0][1], 1.0, 1.0e-3);
  EXPECT_NEAR(body.solver.rows[0].impulse + body.solver.rows[2].impulse, 1.0, 1.0e-3);
}

/// One that began the substep with 4 mm/s downwards, and to which gravity has added 40.
struct BodyThatSettles : BodyOnGround {
  explicit BodyThatSettles(bool calm) {
    island.calm = calm;
    solver.before[0].numbers[1] = -0.004f;
    motions[0].velocity[1] = -0.044f;
    for (const std::size_t normal : {0, 2}) solver.rows[normal].missing = -0.044;
  }
  Wide pushes() const { return solver.rows[0].impulse + solver.rows[2].impulse; }
};

TEST(IslandSolver, LeavesOfACalmIslandWhatItCarriesAndNotWhatStoppedIt) {
  for (const bool calm : {false, true}) {
    BodyThatSettles body(calm);
    EXPECT_EQ(body.solve(), Solved::kWhole);
    EXPECT_NEAR(body.solver.change[0][1], 0.044, 1.0e-4);
    EXPECT_NEAR(body.pushes(), calm ? 0.040 : 0.044, 1.0e-4);
  }
}

// Of rows so soft that a solve stops a tenth of what it should, the guess has a quarter of what
// would stop the rest, as far as it goes by one more solve.
TEST(IslandSolver, LeavesAPartOfWhatWouldStopWhatGoesOn) {
  BodyThatSettles body(true);
  body.masses[0].inverse_mass = 1.0f / 18000.0f;  // Two rows of 1,000 kg.
  EXPECT_EQ(body.solve(), Solved::kWhole);
  const Wide stops = 18000.0 * 0.1;
  EXPECT_NEAR(body.solver.change[0][1], 0.0044, 1.0e-6);
  EXPECT_NEAR(body.pushes(), stops * (0.040 + 0.25 * (0.044 - 0.0044)), 1.0e-3);
}

TEST(IslandSolver, LeavesTheWholeGuessWhereSomethingOfACalmIslandSlides) {
  BodyThatSettles body(true);
  for (const std::size_t tangent : {1, 3}) body.solver.rows[tangent].missing = 3.0;
  body.solve();
  EXPECT_NEAR(body.pushes(), 0.044, 1.0e-4);
}

/// One that falls and slides, of which no step is whole.
struct BodyThatSlides : BodyOnGround {
  BodyThatSlides() {
    for (const std::size_t normal : {0, 2}) solver.rows[normal].missing = -1.0;
    for (const std::size_t tangent : {1, 3}) {
      solver.rows[tangent].missing = 3.0;
      solver.rows[tangent].impulse = 2.0;
    }
  }
};

TEST(IslandSolver, TriesNoFurtherOnceItHasCostEnough) {
  const auto factors = [](std::int64_t products_left) {
    BodyThatSlides body;
    body.island.products_left = products_left;
    EXPECT_EQ(body.solve(), Solved::kPartly);
    EXPECT_EQ(body.island.products_left,
              products_left - static_cast<std::int64_t>(body.solver.work.factors));
    return body.solver.work.factors;
  };
  EXPECT_GT(factors(1000), factors(1));
}

TEST(IslandSolver, LooksForWhatHoldsBrieflyWhereSweepsGoOnFromIt) {
  const auto factors = [](bool only_thin, int joints) {
    BodyThatSlides body;
    body.solver.only_thin = only_thin;
    body.island.joint_count = joints;
    EXPECT_EQ(body.solve(), Solved::kPartly);
    return body.solver.work.factors;
  };
  EXPECT_EQ(factors(true, 0), 2u);
  EXPECT_GT(factors(true, 1), 2u) << "a joint cannot wait for the sweeps";
  EXPECT_GT(factors(false, 0), 2u) << "soft-islands solves to the end";
}

TEST(IslandSolver, LeavesForSweepsWhatSlidesPullsOrApproaches) {
  BodyOnGround body;
  for (const std::size_t normal : {0, 2}) body.solver.rows[normal].missing = -1.0;
  ASSERT_EQ(body.solve(), Solved::kWhole);
  EXPECT_FALSE(body.solver.leaves_for_sweeps(body.island, 1.0e-2));
  const std::vector<IslandRow<2>> solved = body.solver.rows;
  body.solver.rows[0].missing = -0.1;
  EXPECT_TRUE(body.solver.leaves_for_sweeps(body.island, 1.0e-2)) << "it approaches";
  body.solver.rows = solved;
  body.solver.rows[2].missing = 0.1;
  EXPECT_TRUE(body.solver.leaves_for_sweeps(body.island, 1.0e-2)) << "it is pulled";
  body.solver.rows = solved;
  body.solver.rows[3].missing = -0.1;
  EXPECT_TRUE(body.solver.leaves_for_sweeps(body.island, 1.0e-2)) << "it slides";
  body.solver.rows[2].impulse = 0.0;
  EXPECT_FALSE(body.solver.leaves_for_sweeps(body.island, 1.0e-2)) << "and nothing holds it";
}

// What is left of an impulse can be so small that its square is no float: 0 over 0 is no direction.
TEST(IslandSolver, LetsGoOfFrictionTooSmallToHaveADirection) {
  for (const double rest : {1.0e-20, 1.0e-25, 1.0e-40}) {
    BodyOnGround body;
    body.solver.rows[0].missing = -1.0;
    body.solver.rows[2].missing = 1.0;
    body.solver.rows[3].impulse = rest;
    EXPECT_EQ(body.solve(), Solved::kWhole) << rest;
    EXPECT_EQ(body.solver.rows[3].impulse, 0.0) << rest;
    EXPECT_NEAR(body.solver.change[0][1], 1.0, 2.0e-3) << rest;
  }
}

// Two smooth walls that lean by a hundredth, a millimetre into the body each: out of both is a long
// way along them, which no row looks along.
TEST(IslandSolver, PushesWhatIsWedgedNoFasterThanItsBound) {
  BodyOnGround body;
  body.solver.groups[0].count = body.solver.groups[1].count = 1;
  for (const std::size_t normal : {0, 2}) {
    body.solver.rows[normal].b[0] = 0.01;
    body.solver.rows[normal].b[1] = normal == 0 ? 1.0 : -1.0;
    body.solver.rows[normal].impulse = 1.0;
    body.solver.rows[normal].closing = -1.0;
  }
  EXPECT_EQ(body.solve(), Solved::kWhole);
  EXPECT_TRUE(body.island.corrects);
  EXPECT_NEAR(body.solver.correction[0][0], 3.0, 1.0e-6) << "unbounded it would be 17 m/s";
}

/// Two joints that pull a body of 1 kg against each other.
struct BodyBetweenJoints : BodyOnGround {
  BodyBetweenJoints(float left, float right, float speed) {
    solver.groups.clear();
    solver.rows.clear();
    for (const float side : {-1.0f, 1.0f}) {
      const int first = static_cast<int>(solver.rows.size());
      solver.groups.push_back({-1, 0, -1, first, 1, false, 0.0, {}, {}});
      add_row(side, 0.0f);
      solver.rows.back().impulse = side < 0.0f ? left : right;
      solver.rows.back().missing = side * speed;
    }
    island.joints = island.groups;
  }
};

// A thousand newton seconds that hold nothing; a hundredth of that, where one of them has turned a
// little, throws the body away at 10 m/s.
TEST(IslandSolver, TakesAStressBackThatThrowsABodyAway) {
  BodyBetweenJoints body(1000.0f, 1010.0f, 10.0f);
  EXPECT_EQ(body.solve(), Solved::kWhole);
  EXPECT_NEAR(body.solver.change[0][0], -10.0, 1.0e-2) << "it is held again";
  for (const IslandRow<2>& row : body.solver.rows) EXPECT_LT(row.impulse, 20.0);
}

// The same beside a load of 1 N s, which it happens to hold.
TEST(IslandSolver, KeepsNoStressBeyondManyTimesItsLoad) {
  BodyBetweenJoints body(1000.0f, 1001.0f, 0.0f);
  EXPECT_EQ(body.solve(), Solved::kWhole);
  EXPECT_NEAR(body.solver.change[0][0], 0.0, 1.0e-2) << "it is still held";
  for (const IslandRow<2>& row : body.solver.rows) EXPECT_LT(row.impulse, 20.0);
}

/// A body of 1 kg whose only point is held by a joint to the world, half a metre from its centre.
struct BodyOnJoint : BodyOnGround {
  BodyOnJoint() {
    solver.groups.clear();
    solver.rows.clear();
    solver.groups.push_back({-1, 0, -1, 0, 2, false, 0.0, {}, {{0.5, 0.0}}});
    add_row(1.0f, 0.0f);
    add_row(0.0f, 1.0f);
    island.groups = island.joints = {0, 1};
    island.joint_count = 1;
  }
};

TEST(IslandSolver, ForeseesThatABodyTurnsAsItMoves) {
  BodyOnJoint body;
  body.motions[0].spin[0] = 6.0f;
  ASSERT_EQ(body.solve(), Solved::kWhole);
  // The point goes round the centre, so the centre has to come after it by h w^2 r / 2.
  EXPECT_NEAR(body.solver.change[0][0], 36.0 * 0.5 / 480.0, 1.0e-4);
  EXPECT_NEAR(body.solver.change[0][1], 0.0, 1.0e-9);
}

TEST(IslandSolver, ForeseesOfAWildSpinNoMoreThanATenthOfARadian) {
  BodyOnJoint body;
  body.motions[0].spin[0] = 1000.0f;
  ASSERT_EQ(body.solve(), Solved::kWhole);
  EXPECT_NEAR(body.solver.change[0][0], 24.0 * 24.0 * 0.5 / 480.0, 2.0e-3);
}

TEST(IslandSolver, ClosesAJointNoFasterThanABodyMayBeMoved) {
  for (const double apart : {0.2, 3.0, 50.0}) {
    BodyOnJoint body;
    body.solver.rows[1].closing = apart;
    ASSERT_EQ(body.solve(), Solved::kWhole);
    EXPECT_NEAR(body.solver.change[0][1], -std::min(apart, std::max(0.5, 0.12 * apart)), 1.0e-2);
  }
}

}  // namespace cycloid::solver
