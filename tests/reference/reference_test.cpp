#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <utility>

#include "bench/reference/direct.hpp"
#include "bench/reference/projected_gauss_seidel.hpp"
#include "bench/reference/residual.hpp"
#include "bench/reference/sliding_rod.hpp"
#include "bench/reference/stacks.hpp"

namespace cycloid::reference {

using testing::ElementsAre;
using Numbers = std::vector<double>;

static constexpr double kGravity = 10.0;
static constexpr double kStep = 1.0 / 60.0;
static constexpr double kSpeed = kGravity * kStep;  ///< Of everything before the impulses.

static PgsOptions up_to(int sweeps) {
  return {.sweeps = sweeps};
}
static PgsOptions top_down(int sweeps) {
  return {.sweeps = sweeps, .reverse = true};
}

static Assembled stack(const Numbers& masses) {
  return stack_of_circles(masses, kGravity, kStep);
}

/// n - 1 unit circles with one of this mass on top.
static Assembled heavy_top(int n, double mass) {
  Numbers masses(n, 1.0);
  masses.back() = mass;
  return stack(masses);
}

/// Sweeps to 5 % over these problems.
template <class Real = double>
static std::vector<int> sweeps_over(const std::vector<Assembled>& problems,
                                    const PgsOptions& options) {
  std::vector<int> counts;
  for (const Assembled& each : problems)
    counts.push_back(sweeps_to<Real>(each.problem, 0.05, options));
  return counts;
}

static std::vector<Assembled> heavy_tops(int n_max, double mass) {
  std::vector<Assembled> problems;
  for (int n = 1; n <= n_max; ++n) problems.push_back(heavy_top(n, mass));
  return problems;
}

static double max_abs(const Numbers& values) {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

/// The definitions of accuracy that were candidates for the "95 %" of Catto 2014.
using Measure = std::function<double(const Assembled&, const Numbers&, const Numbers&)>;
static double of_row(const Numbers& lambda, const Numbers& exact, std::size_t row) {
  return std::abs(lambda[row] / exact[row] - 1.0);
}
static std::vector<std::pair<Measure, std::vector<int>>> definitions() {
  const auto difference = [](const Numbers& l, const Numbers& e) {
    Numbers result = l;
    for (std::size_t i = 0; i < e.size(); ++i) result[i] -= e[i];
    return result;
  };
  const auto sum = [](auto& l) { return std::accumulate(l.begin(), l.end(), 0.0); };
  return {
      {[](auto&, auto& l, auto& e) { return of_row(l, e, e.size() - 1); }, {1, 5, 3, 8, 32, 20}},
      {[](auto&, auto& l, auto& e) { return impulse_error(l, e).max; }, {1, 5, 3, 8, 32, 20}},
      {[](auto& a, auto& l, auto&) { return max_abs(body_velocities(a, l)) / kSpeed; },
       {1, 5, 3, 8, 32, 20}},
      {[](auto&, auto& l, auto& e) { return of_row(l, e, 0); }, {1, 5, 3, 8, 32, 18}},
      {[](auto&, auto& l, auto& e) { return impulse_error(l, e).l2; }, {1, 5, 3, 8, 32, 19}},
      {[=](auto&, auto& l, auto& e) { return max_abs(difference(l, e)) / max_abs(e); },
       {1, 5, 3, 8, 32, 18}},
      {[=](auto&, auto& l, auto& e) { return 1.0 - sum(l) / sum(e); }, {1, 5, 3, 8, 32, 19}},
      {[](auto& a, auto& l, auto&) { return max_abs(velocities(a.problem, l)) / kSpeed; },
       {1, 5, 3, 8, 32, 15}},
      {[](auto& a, auto& l, auto&) {
         return kinetic_energy(a, body_velocities(a, l)) / kinetic_energy(a, a.velocity);
       },
       {1, 3, 2, 4, 16, 9}},
  };
}

TEST(Stacks, OnlySlowestContactGivesTwentySweepsForFourCircles) {
  const std::vector<Assembled> problems = {stack({1}),    stack({1, 1}),  stack({1, .5}),
                                           stack({1, 2}), stack({1, 10}), stack({1, 1, 1, 1})};
  for (const auto& [measure, expected] : definitions()) {
    std::vector<int> counts;
    for (const Assembled& each : problems) {
      const Numbers exact = solve_direct(each.problem).lambda;
      const auto history = pgs_history<double>(each.problem, up_to(50));
      int sweeps = 1;
      while (measure(each, history[sweeps - 1], exact) > 0.05) ++sweeps;
      counts.push_back(sweeps);
    }
    EXPECT_EQ(counts, expected);
  }
}

template <class Real>
static void expect_three_sweeps_per_unit_of_ratio() {
  for (int r = 1; r <= 50; ++r) {
    const Mlcp problem = stack({1.0, double(r)}).problem;
    EXPECT_EQ(sweeps_to<Real>(problem, 0.05, up_to(1000)), 3 * r + 2) << r;
    EXPECT_EQ(sweeps_to<Real>(problem, 0.05, top_down(1000)), 3 * r + 3) << r;
  }
}

TEST(Stacks, SweepsAreThreeTimesTheMassRatio) {
  expect_three_sweeps_per_unit_of_ratio<float>();
  expect_three_sweeps_per_unit_of_ratio<double>();
  std::vector<Assembled> light;
  for (const double r : {.5, .25, .1, .05}) light.push_back(stack({1, r}));
  EXPECT_THAT(sweeps_over(light, up_to(9)), ElementsAre(3, 2, 2, 1));
  EXPECT_THAT(sweeps_over(light, top_down(9)), ElementsAre(4, 3, 3, 2));
  std::vector<Assembled> heavy;
  for (const double r : {100., 116., 117., 1000.}) heavy.push_back(stack({1, r}));
  EXPECT_THAT(sweeps_over(heavy, up_to(5000)), ElementsAre(302, 350, 352, 2998));
  EXPECT_EQ(sweeps_to<double>(stack({1, 10}).problem, 0.01, up_to(100)), 49);
  EXPECT_EQ(sweeps_to<double>(stack({1, 10}).problem, 0.05, up_to(31)), 0) << "Too few: none.";
}

TEST(Stacks, SweepsDoNotDependOnUnits) {
  for (const double unit : {1e-3, 7.0, 1e4}) {
    EXPECT_EQ(sweeps_to<float>(stack({unit, 10 * unit}).problem, 0.05, up_to(100)), 32);
    const Assembled moon = stack_of_circles({1, 1, 1, 1}, 1.62 * unit, 0.01);
    EXPECT_EQ(sweeps_to<float>(moon.problem, 0.05, up_to(100)), 20);
  }
}

TEST(Stacks, SweepsOverHeightAndOrder) {
  const std::vector<Assembled> equal = heavy_tops(12, 1.0);
  const std::vector<int> up = {1, 5, 11, 20, 31, 45, 61, 81, 102, 127, 154, 184};
  const std::vector<int> down = {1, 6, 13, 23, 35, 50, 67, 88, 110, 136, 164, 195};
  EXPECT_EQ(sweeps_over<double>(equal, up_to(300)), up);
  EXPECT_EQ(sweeps_over<float>(equal, up_to(300)), up);
  EXPECT_EQ(sweeps_over<double>(equal, top_down(300)), down);
  EXPECT_EQ(sweeps_over<float>(equal, top_down(300)), down);
  EXPECT_THAT(sweeps_over({heavy_top(15, 1), heavy_top(20, 1), heavy_top(30, 1)}, up_to(2000)),
              ElementsAre(288, 515, 1166));
  EXPECT_THAT(sweeps_over(heavy_tops(10, 1.0), {.sweeps = 300, .alternate = true}),
              ElementsAre(1, 9, 17, 27, 41, 57, 75, 97, 121, 147));
  std::vector<int> red_black;
  for (int n = 1; n <= 10; ++n) {
    PgsOptions options = up_to(300);
    for (const int first : {0, 1})
      for (int row = first; row < n; row += 2) options.order.push_back(row);
    red_black.push_back(sweeps_to<double>(heavy_top(n, 1.0).problem, 0.05, options));
  }
  EXPECT_THAT(red_black, ElementsAre(1, 5, 12, 21, 33, 47, 64, 84, 106, 131));
}

TEST(Stacks, SweepsWithAHeavyTop) {
  const std::map<double, std::vector<int>> up = {
      {.5, {1, 3, 8, 15, 25, 38, 53, 71, 91, 114}},
      {2, {1, 8, 17, 28, 43, 59, 79, 101, 125, 152}},
      {5, {1, 17, 35, 55, 78, 104, 132, 162, 195, 230}},
      {10, {1, 32, 65, 100, 138, 178, 221, 266, 313, 364}},
      {20, {1, 62, 125, 190, 258, 328, 400, 475, 552, 632}},
      {50, {1, 152, 305, 460, 617, 777, 939, 1104, 1271, 1440}}};
  for (const auto& [mass, counts] : up)
    EXPECT_EQ(sweeps_over(heavy_tops(10, mass), up_to(2000)), counts) << mass;
  const std::map<double, std::vector<int>> down = {
      {.5, {1, 4, 10, 18, 29, 43, 59, 78, 99, 123}},
      {10, {1, 33, 67, 103, 142, 183, 227, 273, 321, 373}},
      {50, {1, 153, 307, 463, 621, 782, 945, 1111, 1279, 1449}}};
  for (const auto& [mass, counts] : down)
    EXPECT_EQ(sweeps_over(heavy_tops(10, mass), top_down(2000)), counts) << mass;
}

TEST(Stacks, ErrorOfTwoCirclesIsAPower) {
  for (const double r : {0.5, 1.0, 10.0, 50.0}) {
    const Mlcp problem = stack({1, r}).problem;
    const auto history = pgs_history<double>(problem, up_to(40));
    const Numbers exact = {(1 + r) * kSpeed, r * kSpeed};
    EXPECT_LE(impulse_error(solve_direct(problem).lambda, exact).max, 1e-14);
    EXPECT_NEAR(history[0][0], kSpeed, 1e-15) << "The ground carries only the lower circle.";
    for (int k = 1; k <= 40; ++k)
      for (const std::size_t row : {0, 1})
        EXPECT_NEAR(of_row(history[k - 1], exact, row), std::pow(r / (1 + r), k), 1e-13);
  }
}

TEST(BoxOnPole, FirstImpulsesAndSweeps) {
  struct Row {
    double offset, first, second;
    std::vector<int> sweeps;  ///< To 5, 1.5 and 1 %.
    double leftover;          ///< What wrong clamping leaves at the left contact, over g h.
  };
  const Row rows[] = {
      {1, .8000, .9600, {2, 2, 2}, 0},           {.75, 1.0847, .9928, {2, 2, 2}, .0776},
      {.5, 1.4545, .7934, {3, 4, 4}, .2479},     {.25, 1.8286, .3135, {9, 12, 13}, .1420},
      {.1, 1.970, .058, {51, 71, 78}, NAN},      {.05, 1.993, .015, {201, 281, 308}, NAN},
      {std::sqrt(2. / 3), 1, 1, {1, 1, 1}, NAN},
  };
  for (const Row& row : rows) {
    const Mlcp problem = box_on_pole(1.0, row.offset).problem;
    const auto history = pgs_history<double>(problem, up_to(9));
    EXPECT_NEAR(history[0][0] / 0.5, row.first, 5e-4) << row.offset;
    EXPECT_NEAR(history[0][1] / 0.5, row.second, 6e-4) << row.offset;
    const double spin = 1.5 * row.offset * row.offset;
    EXPECT_NEAR(history[0][0] / 0.5, 2 / (1 + spin), 1e-14);
    const double rate = std::pow((1 - spin) / (1 + spin), 2);
    for (int k = 1; k < 9; ++k)
      EXPECT_NEAR(history[k][0] / 0.5 - 1, rate * (history[k - 1][0] / 0.5 - 1), 1e-14);
    std::vector<int> sweeps;
    for (const double tolerance : {.05, .015, .01})
      sweeps.push_back(sweeps_to<double>(problem, tolerance, up_to(400)));
    EXPECT_EQ(sweeps, row.sweeps) << row.offset;
    if (std::isnan(row.leftover)) continue;
    const PgsOptions wrong = {.sweeps = 2000, .incremental_clamp = true};
    const Numbers w = velocities(problem, pgs_history<double>(problem, wrong).back());
    EXPECT_NEAR(w[0], row.leftover, 5e-5) << row.offset;
    EXPECT_NEAR(w[1], 0.0, 1e-12);
  }
}

/// 2 x + y = 4, x + 3 y = 7.
TEST(Sweeps, OfTheToyExampleConvergeToOneAndTwo) {
  const Numbers none = {kInfinity, kInfinity};
  Mlcp toy{2, {2, 1, 1, 3}, {-4, -7}, {-none[0], -none[1]}, none, {-1, -1}, {0, 0}};
  const auto history = pgs_history<double>(toy, up_to(30));
  EXPECT_THAT(history[0], ElementsAre(2.0, 5.0 / 3.0));
  EXPECT_NEAR(history.back()[0], 1.0, 1e-15);
  EXPECT_NEAR(history.back()[1], 2.0, 1e-15);
  EXPECT_LE(impulse_error(solve_direct(toy).lambda, {1.0, 2.0}).max, 1e-15);
}

/// Sweeps of one row, whose error then is (1 - sor)^k.
TEST(Sweeps, OverRelaxOneRow) {
  const auto history = pgs_history<double>(stack({1}).problem, {.sweeps = 5, .sor = 0.4});
  for (int k = 1; k <= 5; ++k) EXPECT_NEAR(1 - history[k - 1][0] / kSpeed, std::pow(0.6, k), 1e-14);
}

static SlidingRod rod_with(double friction, double speed) {
  SlidingRod rod;
  rod.friction = friction;
  rod.speed = speed;
  return rod;
}

TEST(SlidingRod, ForcesGrowWithoutBoundAndThenDoNotExist) {
  const std::pair<double, double> rows[] = {{0, .625},   {.5, 1},     {1, 2.5},
                                            {1.2, 6.25}, {1.3, 25.0}, {1.33, 250}};
  for (const auto& [friction, ratio] : rows)
    EXPECT_NEAR(normal_force_over_weight(rod_with(friction, -10)) / ratio, 1.0, 1e-12) << friction;
  EXPECT_NEAR(critical_friction(rod_with(0, -10)), 4.0 / 3.0, 1e-15);
  EXPECT_LT(normal_force_over_weight(rod_with(1.34, -10)), 0.0);
}

TEST(SlidingRod, ImpulsesStopItInOneStep) {
  for (const double friction : {1.3, 4.0 / 3.0, 1.4, 3.0}) {
    const Assembled rod = one_step(rod_with(friction, -10), kGravity, kStep);
    const DirectResult direct = solve_direct(rod.problem);
    ASSERT_TRUE(direct.converged);
    EXPECT_NEAR(direct.lambda[0], 3.14167, 5e-6) << friction;
    EXPECT_NEAR(direct.lambda[1], 4.05, 1e-13);
    EXPECT_LE(max_abs(direct.w), 1e-13);
    EXPECT_NEAR(kinetic_energy(rod, rod.velocity), 50.01, 5e-3);
    EXPECT_NEAR(kinetic_energy(rod, body_velocities(rod, direct.lambda)), 29.50, 5e-3);
  }
  const DirectResult sliding = solve_direct(one_step(rod_with(1.0, -10), kGravity, kStep).problem);
  EXPECT_NEAR(sliding.lambda[0], 5.0 / 12.0, 1e-14);
  EXPECT_NEAR(sliding.lambda[1], sliding.lambda[0], 1e-14);
  EXPECT_LT(sliding.w[1], -9.0) << "Still sliding.";
}

TEST(SlidingRod, SweepsCycleFromTheCriticalFrictionOn) {
  for (const double friction : {0.5, 1.0, 4.0 / 3.0, 1.5, 2.0}) {
    const Mlcp problem = one_step(rod_with(friction, 10), kGravity, kStep).problem;
    const double rate = friction * std::abs(problem.at(0, 1)) / problem.at(0, 0);
    EXPECT_NEAR(rate, 0.75 * friction, 1e-14);
    const DirectResult direct = solve_direct(problem);
    EXPECT_TRUE(direct.converged);
    EXPECT_NEAR(direct.lambda[0], 1.0 / 6.0 / (1.6 + 1.2 * friction), 1e-14);
    const auto history = pgs_history<double>(problem, up_to(200));
    for (int k = 100; rate >= 1.0 && k < 200; k += 2) {
      EXPECT_NEAR(history[k][0], 1.0 / 9.6, 1e-12);
      EXPECT_NEAR(history[k + 1][0], 0.0, 1e-12) << "Falls through.";
    }
    for (int k = 1; rate < 1.0 && k <= 30; ++k)
      EXPECT_NEAR(of_row(history[k], direct.lambda, 0),
                  rate * of_row(history[k - 1], direct.lambda, 0), 1e-12);
  }
}

}  // namespace cycloid::reference
