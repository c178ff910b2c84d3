#include "bench/reference/direct.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "bench/reference/projected_gauss_seidel.hpp"
#include "bench/reference/residual.hpp"
#include "bench/reference/stacks.hpp"

namespace cycloid::reference {

using testing::Pointwise;
using Numbers = std::vector<double>;

/// Uniform numbers, the same with every standard library.
class Chance {
 public:
  explicit Chance(std::uint64_t seed) : bits_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(bits_() >> 11) * 0x1p-53;
  }
  int below(int end) { return static_cast<int>(between(0, end)); }

 private:
  std::mt19937_64 bits_;
};

/// These numbers to rounding.
static auto near(const Numbers& expected) {
  return Pointwise(testing::DoubleNear(1e-13), expected);
}

/// Contacts over random bodies, of which 40 % of the entries of the Jacobian are 0; often more rows
/// than degrees of freedom, so that A is singular.
static Assembled random_contacts(Chance& chance, int n) {
  const int dof = 1 + chance.below(16);
  Numbers jacobian(static_cast<std::size_t>(n) * dof), inverse_mass(dof), velocity(dof);
  for (double& x : jacobian) x = chance.between(0, 1) < 0.4 ? 0.0 : chance.between(-1, 1);
  for (double& x : inverse_mass) x = chance.between(0.1, 2);
  for (double& x : velocity) x = chance.between(-3, 3);
  return assemble(n, jacobian, inverse_mass, velocity);
}

/// Joints, motors, limits and pins instead of contacts.
static void bound_randomly(Chance& chance, Mlcp& problem) {
  for (int i = 0; i < problem.n; ++i) {
    const double kind = chance.between(0, 1);
    problem.lower[i] = kind < 0.3 ? -kInfinity : chance.between(-1, 0);
    problem.upper[i] = kind < 0.2 ? kInfinity : chance.between(0, 1);
    if (kind > 0.9) problem.lower[i] = problem.upper[i];
  }
}

/// Every second row the friction of the one before.
static void add_friction(Chance& chance, Mlcp& problem) {
  for (int i = 1; i < problem.n; i += 2) {
    problem.normal_of[i] = i - 1;
    problem.friction[i] = chance.between(0, 1);
  }
}

/// Checks each case of the definition on its own, without the natural map.
static void expect_solves(const Mlcp& problem, const DirectResult& direct) {
  EXPECT_TRUE(direct.converged);
  EXPECT_LE(direct.residual, 1e-10);
  double scale = 1.0;
  for (const double impulse : direct.lambda) scale = std::max(scale, std::abs(impulse));
  const double tolerance = 1e-10 * scale;
  const Numbers w = velocities(problem, direct.lambda);
  for (int i = 0; i < problem.n; ++i) {
    const Bounds bounds = bounds_of(problem, direct.lambda, i);
    EXPECT_EQ(w[i], direct.w[i]);
    EXPECT_GE(direct.lambda[i], bounds.lower - tolerance);
    EXPECT_LE(direct.lambda[i], bounds.upper + tolerance);
    if (direct.lambda[i] > bounds.lower + tolerance) {
      EXPECT_LE(w[i], tolerance) << i;
    }
    if (direct.lambda[i] < bounds.upper - tolerance) {
      EXPECT_GE(w[i], -tolerance) << i;
    }
  }
}

TEST(Direct, SolvesTwoThousandRandomProblems) {
  Chance chance(20);
  int deficient = 0;
  for (int k = 0; k < 2000 && !testing::Test::HasFailure(); ++k) {
    SCOPED_TRACE(k);
    Mlcp problem = random_contacts(chance, 2 * (1 + chance.below(7))).problem;
    if (k % 3 == 1) bound_randomly(chance, problem);
    if (k % 3 == 2) add_friction(chance, problem);
    const DirectResult direct = solve_direct(problem);
    expect_solves(problem, direct);
    deficient += direct.rank_deficient;
  }
  EXPECT_GT(deficient, 200) << "The hard ones are among them.";
}

TEST(Direct, AgreesWithSweepsWhereTheyConverge) {
  Chance chance(21);
  for (int k = 0; k < 100; ++k) {
    Mlcp problem = random_contacts(chance, 4).problem;
    for (std::size_t i = 0; i < 4; ++i) problem.a[i * 5] += 1.0;  // Well conditioned.
    if (k % 2 == 1) bound_randomly(chance, problem);
    const Numbers swept = pgs_history<double>(problem, {.sweeps = 2000}).back();
    const DirectResult direct = solve_direct(problem);
    EXPECT_FALSE(direct.rank_deficient);
    for (int i = 0; i < 4; ++i) EXPECT_NEAR(direct.lambda[i], swept[i], 1e-10) << k;
  }
}

/// All solutions of two contacts without friction, by trying the four sets of contacts that push.
static std::vector<Numbers> enumerate(const Mlcp& problem) {
  const double a = problem.at(0, 0), b = problem.at(0, 1), d = problem.at(1, 1);
  const double p = problem.b[0], q = problem.b[1];
  const double determinant = a * d - b * b;
  const Numbers candidates[] = {{(b * q - d * p) / determinant, (b * p - a * q) / determinant},
                                {0, -q / d},
                                {-p / a, 0},
                                {0, 0}};
  std::vector<Numbers> solutions;
  for (const Numbers& lambda : candidates) {
    const Numbers w = velocities(problem, lambda);
    if (std::min({lambda[0], lambda[1], w[0], w[1]}) < -1e-12) continue;
    EXPECT_LE(residual_of(problem, lambda).complementarity, 1e-12);
    solutions.push_back(lambda);
  }
  return solutions;
}

TEST(Direct, FindsTheOneOfFourCasesOfTwoContacts) {
  int seen[2][2] = {};
  for (const double offset : {0.3, 0.75, 1.0})
    for (const double left : {-1.0, -0.3, 0.2, 1.0})
      for (const double right : {-1.1, -0.4, 0.25, 1.3}) {
        Mlcp problem = box_on_pole(1.0, offset).problem;
        problem.b = {left, right};
        const std::vector<Numbers> solutions = enumerate(problem);
        ASSERT_EQ(solutions.size(), 1u) << offset << " " << left << " " << right;
        const DirectResult direct = solve_direct(problem);
        for (const std::size_t i : {0u, 1u}) EXPECT_NEAR(direct.lambda[i], solutions[0][i], 1e-12);
        ++seen[solutions[0][0] > 0][solutions[0][1] > 0];
      }
  for (const auto& row : seen)
    for (const int count : row) EXPECT_GT(count, 0) << "Each case occurs.";
}

/// The rows of a problem so many times.
static Assembled repeated(const Assembled& once, int times) {
  const int n = once.problem.n;
  Numbers jacobian;
  for (int k = 0; k < times; ++k)
    jacobian.insert(jacobian.end(), once.jacobian.begin(), once.jacobian.end());
  Assembled result = assemble(n * times, jacobian, once.inverse_mass, once.velocity);
  for (int i = 0; i < n * times; ++i) {
    const int normal = once.problem.normal_of[i % n];
    result.problem.normal_of[i] = normal < 0 ? -1 : normal + i / n * n;
    result.problem.friction[i] = once.problem.friction[i % n];
  }
  return result;
}

/// The wrench over that of the problem solved once.
static double repeated_error(const Assembled& once, const Assembled& many) {
  const DirectResult direct = solve_direct(many.problem);
  expect_solves(many.problem, direct);
  EXPECT_TRUE(direct.rank_deficient);
  Numbers summed(once.problem.n, 0.0);
  for (int i = 0; i < many.problem.n; ++i) summed[i % once.problem.n] += direct.lambda[i];
  return wrench_error(once.jacobian, once.dof, summed, solve_direct(once.problem).lambda);
}

/// A point of 1 kg against a slope: row 0 the normal, row 1 along it.
static Assembled point_on_slope(double friction) {
  Assembled point = assemble(2, {0, 1, 1, 0}, {1, 1}, {-0.5, -1});
  point.problem.normal_of[1] = 0;
  point.problem.friction[1] = friction;
  return point;
}

TEST(Direct, ReportsDuplicatesAndGivesTheSameWrench) {
  const std::vector<Assembled> problems = {stack_of_circles({1, 3, 2, 10}, 10, 0.01),
                                           box_on_pole(1, 0.5), point_on_slope(0.2),
                                           point_on_slope(0.9)};
  for (const Assembled& once : problems) {
    EXPECT_FALSE(solve_direct(once.problem).rank_deficient);
    EXPECT_LE(repeated_error(once, repeated(once, 10)), 1e-12);
  }
  const DirectResult ten = solve_direct(repeated(problems[0], 10).problem);
  EXPECT_EQ(ten.rank, 4) << "Of 40 active rows.";
  const DirectResult sliding = solve_direct(repeated(point_on_slope(0.2), 10).problem);
  for (int i = 0; i < 20; ++i)
    EXPECT_NEAR(sliding.lambda[i], i % 2 == 0 ? 0.1 : 0.02, 1e-13) << "Equal shares.";
}

TEST(Direct, FrictionHoldsUpToItsConeAndNotBeyond) {
  EXPECT_THAT(solve_direct(point_on_slope(0.9).problem).lambda, near({1.0, 0.5}));
  const DirectResult slides = solve_direct(point_on_slope(0.2).problem);
  EXPECT_THAT(slides.lambda, near({1.0, 0.2}));
  EXPECT_NEAR(slides.w[1], -0.3, 1e-15);
  EXPECT_THAT(solve_direct(point_on_slope(0.0).problem).lambda, near({1.0, 0.0}));
}

TEST(Direct, SharesTheLoadOfFourEqualContacts) {
  // Height and two tilts of a square plate on its corners; 2 kg m/s come down.
  const Assembled plate =
      assemble(4, {1, -1, -1, 1, 1, -1, 1, 1, 1, 1, -1, 1}, {0.5, 3, 3}, {-1, 0, 0});
  const DirectResult direct = solve_direct(plate.problem);
  EXPECT_EQ(direct.rank, 3);
  EXPECT_TRUE(direct.rank_deficient);
  for (const double impulse : direct.lambda) EXPECT_NEAR(impulse, 0.5, 1e-13);
}

TEST(Direct, KeepsBothBoundsAndFreeRows) {
  Mlcp problem = stack_of_circles({2, 2, 2}, 10, 0.1).problem;
  problem.a = {2, 0, 0, 0, 2, 0, 0, 0, 2};
  problem.b = {-3, -3, 3};
  problem.lower = {0, -kInfinity, -1};
  problem.upper = {1, kInfinity, 5};
  EXPECT_THAT(solve_direct(problem).lambda, near({1.0, 1.5, -1.0}));
  EXPECT_THAT(solve_direct(problem).w, near({-1.0, 0.0, 1.0}));
  EXPECT_EQ(solve_direct(problem).rank, 1);
}

TEST(Direct, SaysSoWhereThereIsNoSolution) {
  Mlcp immovable{1, {0}, {-1}, {0}, {kInfinity}, {-1}, {0}};
  EXPECT_FALSE(solve_direct(immovable).converged);
  Mlcp contradiction{2, {1, 1, 1, 1}, {1, 2}, {}, {}, {-1, -1}, {0, 0}};
  contradiction.lower = {-kInfinity, -kInfinity};
  contradiction.upper = {kInfinity, kInfinity};
  EXPECT_FALSE(solve_direct(contradiction).converged);
  Mlcp pulling = point_on_slope(0.5).problem;
  pulling.lower[0] = -1;
  EXPECT_FALSE(solve_direct(pulling).converged);
  EXPECT_TRUE(solve_direct(Mlcp{}).converged) << "Nothing to solve.";
}

TEST(Residual, IsWhatItsDefinitionSays) {
  Mlcp problem{2, {2, 0, 0, 4}, {-4, 8}, {0, -1}, {kInfinity, 3}, {-1, -1}, {0, 0}};
  const Numbers guess = {1, 4};  // w = {-2, 24}; exact is {2, -1}.
  EXPECT_EQ(natural_map(problem, guess, 0), -1.0);
  EXPECT_EQ(natural_map(problem, guess, 1), 5.0);
  const Residual residual = residual_of(problem, guess);
  EXPECT_EQ(residual.natural_map, 5.0);
  EXPECT_EQ(residual.impulse_scale, 4.0);
  EXPECT_EQ(residual.relative, 1.25);
  EXPECT_EQ(residual.complementarity, 120.0);
  EXPECT_EQ(residual.outside, 1.0);
  EXPECT_EQ(residual_of(problem, {2, -1}).relative, 0.0);
  EXPECT_EQ(residual_of(problem, {2, -1}).complementarity, 0.0);
}

TEST(Residual, ErrorsOfImpulses) {
  EXPECT_EQ(impulse_error({1.5, 8}, {1, 10}).max, 0.5);
  EXPECT_NEAR(impulse_error({4, 0}, {3, 4}).l2, std::sqrt(17.0) / 5.0, 1e-15);
  EXPECT_EQ(impulse_error({5, 10}, {0, 10}).max, 0.5) << "Against the largest.";
  EXPECT_EQ(impulse_error({0, 0}, {0, 0}).max, 0.0);
  EXPECT_EQ(impulse_error({1}, {0}).l2, kInfinity);
  const Assembled twice = repeated(stack_of_circles({4}, 10, 0.1), 2);
  EXPECT_EQ(impulse_error({4, 0}, {2, 2}).max, 1.0);
  EXPECT_EQ(wrench_error(twice.jacobian, 1, {4, 0}, {2, 2}), 0.0) << "They do the same.";
  EXPECT_EQ(wrench_error(twice.jacobian, 1, {3, 0}, {2, 2}), 0.25);
  EXPECT_EQ(velocity_error(twice.problem, {4, 0}, {2, 2}), 0.0);
  EXPECT_EQ(velocity_error(twice.problem, {3, 0}, {2, 2}), 0.25);
}

}  // namespace cycloid::reference
