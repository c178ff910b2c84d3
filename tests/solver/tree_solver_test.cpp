#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <type_traits>

#include "tests/solver/tree_system.hpp"

namespace cycloid::solver {

static constexpr float kFall = 10.0f / 240.0f;  ///< g h, m/s.

template <class T>
struct TreeSolverTest : testing::Test {
  static constexpr int kDim = T::value;
};
using TreeDimensions =
    testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(TreeSolverTest, TreeDimensions);

/// One number in [lower, upper), the same with every library.
static float uniform(std::minstd_rand& random, float lower, float upper) {
  return lower + (upper - lower) * static_cast<float>(random() % 65536u) / 65536.0f;
}

template <int D>
static Vec<D> random_point(std::minstd_rand& random) {
  Vec<D> point;
  for (int i = 0; i < D; ++i) point[i] = uniform(random, -2.0f, 2.0f);
  return point;
}

/// Every body hangs on an earlier one by 1 to kFreedoms rows; about one in eight on ground.
template <int D>
static TreeSystem<D> random_tree(unsigned seed, int bodies, bool fixed_rotations) {
  std::minstd_rand random(seed);
  TreeSystem<D> system;
  for (int i = 0; i < bodies; ++i) {
    const bool turns = !fixed_rotations || random() % 2 == 0;
    const std::uint32_t body =
        system.add_body(uniform(random, 0.5f, 4.0f), turns ? uniform(random, 0.2f, 2.0f) : 0.0f,
                        random_point<D>(random));
    const std::uint32_t parent =
        random() % 8 == 0 ? 0 : static_cast<std::uint32_t>(random() % body);
    // Without rotation of both bodies, only the rows of the point are independent.
    const int most = fixed_rotations ? D : TreeSystem<D>::kFreedoms;
    const int rows = 1 + static_cast<int>(random() % static_cast<unsigned>(most));
    const bool swapped = random() % 2 == 0;
    JointBlock<D>& joint = system.add_joint(swapped ? body : parent, swapped ? parent : body,
                                            random_point<D>(random), rows);
    for (int row = 0; row < rows; ++row)
      if (random() % 4 == 0) joint.softness[row] = uniform(random, 0.0f, 0.5f);
  }
  for (float& wanted : system.rhs) wanted = uniform(random, -1.0f, 1.0f);
  return system;
}

/// A chain of links of 1 kg and 0.1 m in the plane of the first two axes, from ground at the
/// origin or free. `bend` turns each link against the one before; the last weighs `tip` kg. The
/// rows cancel what one tick of gravity does to all bodies, or to the first where none is ground.
template <int D>
static TreeSystem<D> chain_of_links(int links, float tip, double angle, double bend, int grounds) {
  TreeSystem<D> system;
  Vec<D> end = Vec<D>::zero();
  for (int i = 0; i < links; ++i) {
    Vec<D> link = Vec<D>::zero();
    link[0] = static_cast<float>(0.1 * std::cos(angle + bend * i));
    link[1] = static_cast<float>(0.1 * std::sin(angle + bend * i));
    const float mass = i + 1 == links ? tip : 1.0f;
    const std::uint32_t body = system.add_body(mass, mass * 0.01f / 12.0f, end + 0.5f * link);
    if (i > 0 || grounds > 0) system.add_joint(body - 1, body, end, D);
    end = end + link;
  }
  if (grounds == 2) system.add_joint(static_cast<std::uint32_t>(links), 0, end, D);
  const auto falls = [&](std::uint32_t body) { return grounds > 0 ? body > 0 : body == 1; };
  for (std::size_t i = 0; i < system.joints.size(); ++i) {
    const float a = falls(system.joints[i].body_a) ? -kFall : 0.0f;
    const float b = falls(system.joints[i].body_b) ? -kFall : 0.0f;
    system.rhs[i * TreeSystem<D>::kFreedoms + 1] = a - b;
  }
  return system;
}

TYPED_TEST(TreeSolverTest, RandomTreesAgreeWithADenseSolveInDouble) {
  for (unsigned seed = 1; seed <= 30; ++seed) {
    auto system = random_tree<TestFixture::kDim>(seed, 24, seed % 3 == 0);
    system.solve();
    for (int i = 0; i < 24; ++i) ASSERT_TRUE(system.solver.in_tree(i));
    EXPECT_LE(system.error_of_velocities(), 1e-5) << seed;
    EXPECT_LE(system.error_of_impulses(), 1e-4) << seed;
    EXPECT_LE(system.relative_impulse_error(), 1e-5) << seed;
  }
}

/// The tension of a hanging chain is the weight below, whatever the mass ratio.
TYPED_TEST(TreeSolverTest, HangingChainsCarryTheWeightBelow) {
  constexpr int kFreedoms = TreeSystem<TestFixture::kDim>::kFreedoms;
  for (const int links : {10, 40, 160})
    for (const float tip : {1.0f, 1e2f, 1e5f}) {
      auto system = chain_of_links<TestFixture::kDim>(links, tip, -std::acos(-1.0) / 2.0, 0.0, 1);
      system.solve();
      for (int i = 0; i < links; ++i) {
        const float weight = (tip + static_cast<float>(links - 1 - i)) * kFall;
        EXPECT_NEAR(system.lambda[i * kFreedoms + 1] / weight, 1.0f, 1e-5f) << links << " " << tip;
      }
      EXPECT_LE(system.error_of_velocities(), 1e-6 * kFall);
    }
}

TYPED_TEST(TreeSolverTest, SlantedAndHorizontalChainsFulfilTheirRowsAtAnyMassRatio) {
  for (const int links : {10, 40, 160})
    for (const float tip : {1.0f, 1e2f, 1e5f})
      for (const double angle : {-0.7, 0.0}) {
        auto system =
            chain_of_links<TestFixture::kDim>(links, tip, angle, angle == 0.0 ? 0.0 : 0.01, 1);
        system.solve();
        EXPECT_LE(system.error_of_velocities(), 1e-5 * kFall) << links << " " << tip;
        EXPECT_LE(system.error_of_impulses(), 1e-3 * kFall) << links << " " << tip;
        EXPECT_LE(system.relative_impulse_error(), 1e-5) << links << " " << tip;
      }
}

/// Impulses alone miss by their rounding: 2^-24 of 1e5 kg g h on a mass of 1/2 kg, at most 1.2e-2.
TYPED_TEST(TreeSolverTest, ASecondSolveTakesAwayWhatRoundingOfTheImpulsesLeft) {
  auto system = chain_of_links<TestFixture::kDim>(40, 1e5f, -std::acos(-1.0) / 2.0, 0.0, 1);
  system.solve();
  EXPECT_LE(system.error_of_impulses(), 1.5e-2 * kFall);
  const Eigen::MatrixXd j = system.jacobian();
  const Eigen::VectorXd left =
      system.in_double(system.rhs) -
      j * (system.inverse_mass() * (j.transpose() * system.in_double(system.lambda)));
  for (int i = 0; i < left.size(); ++i) system.rhs[i] = static_cast<float>(left[i]);
  system.solver.solve(system.rhs, system.lambda);
  EXPECT_LE(system.error_of_impulses(), 1e-3 * kFall);
}

TYPED_TEST(TreeSolverTest, HeavyBodiesAreExactAtEitherEndOfAFreeChain) {
  for (const bool heavy_first : {false, true}) {
    auto system = chain_of_links<TestFixture::kDim>(40, heavy_first ? 1.0f : 1e5f, -0.7, 0.02, 0);
    if (heavy_first) {
      system.masses[1].inverse_mass = 1e-5f;
      for (float& m : system.masses[1].inverse_inertia.m) m *= 1e-5f;
    }
    system.solve();
    EXPECT_LE(system.error_of_velocities(), 1e-6 * kFall);
    EXPECT_LE(system.relative_impulse_error(), 1e-6);
  }
}

TYPED_TEST(TreeSolverTest, ChainsBetweenTwoGroundsAreTreesAndExact) {
  for (const int links : {10, 40, 160})
    for (const float middle : {1.0f, 1e5f}) {
      auto system = chain_of_links<TestFixture::kDim>(links, 1.0f, -0.7, 1.4 / links, 2);
      auto& mass = system.masses[static_cast<std::size_t>(links) / 2];
      mass.inverse_mass /= middle;
      for (float& m : mass.inverse_inertia.m) m /= middle;
      system.solve();
      for (int i = 0; i <= links; ++i) ASSERT_TRUE(system.solver.in_tree(i));
      EXPECT_LE(system.error_of_velocities(), 1e-5 * kFall) << links;
      EXPECT_LE(system.error_of_impulses(), 1e-3 * kFall) << links;
      EXPECT_LE(system.relative_impulse_error(), 1e-5) << links;
    }
}

/// Straight between two grounds, the rows along the chain depend on each other.
TYPED_TEST(TreeSolverTest, DependentRowsAreFulfilledWhereTheyAgreeAndBoundedWhereTheyDoNot) {
  constexpr int kFreedoms = TreeSystem<TestFixture::kDim>::kFreedoms;
  for (const double angle : {0.0, -0.7}) {
    auto system = chain_of_links<TestFixture::kDim>(40, 1.0f, angle, 0.0, 2);
    system.solve();
    EXPECT_LE(system.error_of_velocities(), 1e-5 * kFall);
  }
  auto stretched = chain_of_links<TestFixture::kDim>(40, 1.0f, 0.0, 0.0, 2);
  stretched.rhs[40 * kFreedoms] = 1.0f;
  stretched.solve();
  // Three solves, each against the compliance 1e-5 of a link of 1 kg.
  for (const float impulse : stretched.lambda) EXPECT_LE(std::abs(impulse), 3.1e5f);
}

TYPED_TEST(TreeSolverTest, AnEmptyRowGetsNoImpulse) {
  constexpr int kFreedoms = TreeSystem<TestFixture::kDim>::kFreedoms;
  TreeSystem<TestFixture::kDim> system;
  const std::uint32_t particle = system.add_body(2.0f, 0.0f, Vec<TestFixture::kDim>::zero());
  system.add_joint(0, particle, Vec<TestFixture::kDim>::zero(), kFreedoms);
  for (int row = 0; row < kFreedoms; ++row) system.rhs[row] = 3.0f;
  system.solve();
  for (int row = 0; row < kFreedoms; ++row)
    EXPECT_EQ(system.lambda[row], row < TestFixture::kDim ? 6.0f : 0.0f);
}

/// A body that cannot turn, welded to one that can: the angular row acts on the latter alone.
TYPED_TEST(TreeSolverTest, FixedRotationHoldsTheBodyThatTurns) {
  constexpr int D = TestFixture::kDim;
  TreeSystem<D> system;
  const std::uint32_t turns = system.add_body(2.0f, 0.5f, Vec<D>::zero());
  const std::uint32_t fixed = system.add_body(1.0f, 0.0f, Vec<D>::zero());
  system.add_joint(turns, fixed, Vec<D>::zero(), system.kFreedoms);
  system.rhs[D] = 4.0f;
  system.solve();
  EXPECT_LE(system.relative_impulse_error(), 1e-6);
  EXPECT_NEAR(system.solver.velocity_change(turns, D), -4.0f, 1e-5f);
  EXPECT_EQ(system.solver.velocity_change(fixed, D), 0.0f);
}

TYPED_TEST(TreeSolverTest, ASoftRowYieldsByItsCompliance) {
  TreeSystem<TestFixture::kDim> system;
  const std::uint32_t body = system.add_body(2.0f, 1.0f, Vec<TestFixture::kDim>::zero());
  system.add_joint(0, body, Vec<TestFixture::kDim>::zero(), 1).softness[0] = 1.5f;
  system.rhs[0] = 3.0f;
  system.solve();
  EXPECT_NEAR(system.lambda[0], 3.0f / (0.5f + 1.5f), 1e-6f);
  EXPECT_NEAR(system.solver.velocity_change(body, 0), 0.5f * 1.5f, 1e-6f);
}

TYPED_TEST(TreeSolverTest, TwentyArmsOnOneBodyAgreeWithADenseSolve) {
  constexpr int D = TestFixture::kDim;
  std::minstd_rand random(7);
  TreeSystem<D> system;
  const std::uint32_t hub = system.add_body(3.0f, 1.0f, Vec<D>::zero());
  for (int arm = 0; arm < 20; ++arm) {
    const Vec<D> point = random_point<D>(random);
    system.add_joint(hub, system.add_body(1.0f, 0.1f, 1.2f * point), point, D);
  }
  for (float& wanted : system.rhs) wanted = uniform(random, -1.0f, 1.0f);
  system.solve();
  EXPECT_LE(system.error_of_impulses(), 1e-5);
  EXPECT_LE(system.relative_impulse_error(), 1e-5);
}

TYPED_TEST(TreeSolverTest, LoopsAndJointsWithoutAMovingBodyAreLeftOut) {
  constexpr int D = TestFixture::kDim;
  TreeSystem<D> system;
  std::vector<std::uint32_t> bodies;
  for (int i = 0; i < 7; ++i) {
    Vec<D> at = Vec<D>::zero();
    at[0] = static_cast<float>(i);
    bodies.push_back(system.add_body(1.0f, 1.0f, at));
  }
  const auto join = [&](std::uint32_t a, std::uint32_t b) {
    system.add_joint(a, b, system.positions[b], D);
  };
  join(bodies[0], bodies[1]);
  join(bodies[1], bodies[2]);
  join(bodies[2], bodies[0]);  // Closes a loop.
  join(bodies[1], bodies[2]);  // Twice the same.
  join(0, 0);                  // Ground to ground.
  join(bodies[3], bodies[4]);  // A second tree.
  join(0, bodies[5]);
  join(bodies[4], bodies[3]);  // Twice the same.
  for (float& wanted : system.rhs) wanted = 1.0f;
  system.solve();
  const bool in_tree[] = {true, true, false, false, false, true, true, false};
  for (int i = 0; i < 8; ++i) {
    EXPECT_EQ(system.solver.in_tree(i), in_tree[i]) << i;
    for (int row = 0; row < system.kFreedoms; ++row)
      EXPECT_EQ(system.lambda[i * system.kFreedoms + row] != 0.0f, in_tree[i] && row < D) << i;
  }
  EXPECT_LE(system.error_of_impulses(), 1e-5);
  EXPECT_EQ(system.solver.velocity_change(bodies[6], 0), 0.0f);
  EXPECT_EQ(system.solver.velocity_change(0, 0), 0.0f);
}

TYPED_TEST(TreeSolverTest, GivesTheSameBitsAgainAndAfterOtherTrees) {
  auto system = random_tree<TestFixture::kDim>(5, 50, false);
  system.solve();
  const std::vector<float> first = system.lambda;
  system.solver.solve(system.rhs, system.lambda);
  EXPECT_EQ(system.lambda, first);
  auto other = random_tree<TestFixture::kDim>(6, 80, true);
  other.solve();
  std::swap(system.solver, other.solver);
  system.solve();
  EXPECT_EQ(system.lambda, first);
}

TYPED_TEST(TreeSolverTest, TakesTwiceTheOperationsForTwiceTheLinks) {
  std::uint64_t operations[2];
  for (const int doubled : {0, 1}) {
    auto system = chain_of_links<TestFixture::kDim>(100 << doubled, 1.0f, -0.7, 0.01, 1);
    system.solve();
    operations[doubled] = system.solver.operations();
  }
  EXPECT_GT(operations[0], 1000u);
  EXPECT_NEAR(static_cast<double>(operations[1]) / static_cast<double>(operations[0]), 2.0, 0.1);
}

TYPED_TEST(TreeSolverTest, NothingToSolveIsNoError) {
  TreeSystem<TestFixture::kDim> system;
  system.solve();
  EXPECT_EQ(system.solver.operations(), 0u);
  system.masses.clear();
  system.solve();
  EXPECT_TRUE(system.lambda.empty());
}

}  // namespace cycloid::solver
