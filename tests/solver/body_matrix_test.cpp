#include "solver/direct/body_matrix.hpp"

#include <gtest/gtest.h>

#include <random>
#include <type_traits>

namespace cycloid::solver {

template <class T>
struct BodyMatrixTest : testing::Test {
  static constexpr int kDim = T::value;
};
using MatrixDimensions =
    testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(BodyMatrixTest, MatrixDimensions);

struct NodePair {
  int a;
  int b;
};

/// Springs of random directions and stiffness, up to 1e6 times the masses, between nodes.
template <int D>
struct SpringSystem {
  static constexpr int kFreedoms = Dim<D>::kFreedoms;
  using Vector = typename BodyMatrix<D>::Vector;

  BodyMatrix<D> matrix;
  std::vector<NodePair> pairs;
  std::vector<Vector> a;
  std::vector<Vector> b;
  std::vector<double> stiffness;
  int nodes = 0;
  Range steps{};
  int ground_node = -1;  ///< Of a spring of 1000 to what does not move; -1: there is none.
  Vector ground;

  void draw(int count, std::vector<NodePair> graph, unsigned seed) {
    std::minstd_rand random(seed);
    const auto number = [&] { return static_cast<double>(random() % 2001u) / 1000.0 - 1.0; };
    nodes = count;
    pairs = std::move(graph);
    for (std::size_t p = 0; p < pairs.size(); ++p) {
      Vector from;
      Vector to;
      for (int i = 0; i < kFreedoms; ++i) {
        from[i] = number();
        to[i] = number();
      }
      a.push_back(from);
      b.push_back(to);
      stiffness.push_back(random() % 2 == 0 ? 1.0 : 1.0e6);
    }
  }

  void assemble() {
    matrix.clear(steps);
    for (int n = 0; n < nodes; ++n)
      for (int i = 0; i < kFreedoms; ++i) matrix.diagonal(n).at(i, i) += 1.0 + n;
    for (std::size_t p = 0; p < pairs.size(); ++p) {
      const bool a_is_row = pairs[p].a > pairs[p].b;
      auto& beside = matrix.beside(matrix.join(pairs[p].a, pairs[p].b));
      for (int i = 0; i < kFreedoms; ++i)
        for (int j = 0; j < kFreedoms; ++j) {
          matrix.diagonal(pairs[p].a).at(i, j) += stiffness[p] * a[p][i] * a[p][j];
          matrix.diagonal(pairs[p].b).at(i, j) += stiffness[p] * b[p][i] * b[p][j];
          beside.at(i, j) += stiffness[p] * (a_is_row ? a[p][i] * b[p][j] : b[p][i] * a[p][j]);
        }
    }
  }

  /// The product with a vector, from the springs and not from the blocks.
  std::vector<Vector> times(const std::vector<Vector>& x) const {
    std::vector<Vector> y = x;
    for (int n = 0; n < nodes; ++n)
      y[static_cast<std::size_t>(n)] = (1.0 + n) * y[static_cast<std::size_t>(n)];
    for (std::size_t p = 0; p < pairs.size(); ++p) {
      const auto at_a = static_cast<std::size_t>(pairs[p].a);
      const auto at_b = static_cast<std::size_t>(pairs[p].b);
      const double stretch = stiffness[p] * (dot(a[p], x[at_a]) + dot(b[p], x[at_b]));
      y[at_a] += stretch * a[p];
      y[at_b] += stretch * b[p];
    }
    if (ground_node >= 0) {
      const auto at = static_cast<std::size_t>(ground_node);
      y[at] += 1000.0 * dot(ground, x[at]) * ground;
    }
    return y;
  }

  bool analyse(int products_max, const std::vector<int>& last = {}) {
    matrix.begin(nodes);
    for (const NodePair& pair : pairs) matrix.join(pair.a, pair.b);
    for (const int node : last) matrix.put_last(node);
    return matrix.analyse({0, nodes}, products_max, steps);
  }
};

static std::vector<NodePair> pairs_of_grid(int side) {
  std::vector<NodePair> pairs;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      if (x > 0) pairs.push_back({y * side + x - 1, y * side + x});
      if (y > 0) pairs.push_back({y * side + x, (y - 1) * side + x});
    }
  return pairs;
}

TYPED_TEST(BodyMatrixTest, SolvesLoopsOfStiffAndWeakSprings) {
  constexpr int D = TestFixture::kDim;
  using Vector = typename BodyMatrix<D>::Vector;
  for (const unsigned seed : {1u, 2u, 3u}) {
    SpringSystem<D> system;
    system.draw(25, pairs_of_grid(5), seed);
    ASSERT_TRUE(system.analyse(1 << 20));
    for (int turn = 0; turn < 2; ++turn) {  // The second time over what the first has left.
      system.assemble();
      system.matrix.factor(system.steps);
      std::vector<Vector> wanted(25);
      for (std::size_t n = 0; n < wanted.size(); ++n)
        for (int i = 0; i < D; ++i) wanted[n][i] = static_cast<double>(n % 3) - i;
      std::vector<Vector> right = system.times(wanted);
      system.matrix.solve(system.steps, right);
      for (std::size_t n = 0; n < wanted.size(); ++n)
        for (int i = 0; i < Dim<D>::kFreedoms; ++i)
          EXPECT_NEAR(right[n][i], wanted[n][i], 1.0e-7) << "seed " << seed << ", node " << n;
    }
  }
}

TYPED_TEST(BodyMatrixTest, SolvesTwoAtOnceToTheBitsOfOneAfterTheOther) {
  constexpr int D = TestFixture::kDim;
  using Matrix = BodyMatrix<D>;
  SpringSystem<D> system;
  system.draw(25, pairs_of_grid(5), 9);
  ASSERT_TRUE(system.analyse(1 << 20));
  system.assemble();
  system.matrix.factor(system.steps);
  std::vector<typename Matrix::Vector> first(25);
  std::vector<typename Matrix::Vector> second(25);
  std::vector<typename Matrix::VectorPair> both(25);
  for (std::size_t n = 0; n < both.size(); ++n)
    for (int i = 0; i < Dim<D>::kFreedoms; ++i) {
      first[n][i] = static_cast<double>(n % 7) - 0.3 * i;
      second[n][i] = 0.01 * static_cast<double>(n) + i;
      both[n][i] = WidePair(first[n][i], second[n][i]);
    }
  system.matrix.solve(system.steps, first);
  system.matrix.solve(system.steps, second);
  system.matrix.solve(system.steps, both);
  for (std::size_t n = 0; n < both.size(); ++n)
    for (int i = 0; i < Dim<D>::kFreedoms; ++i) {
      EXPECT_EQ(both[n][i].raw[0], first[n][i]) << n;
      EXPECT_EQ(both[n][i].raw[1], second[n][i]) << n;
    }
}

TYPED_TEST(BodyMatrixTest, ChainsAndStarsFillInNothing) {
  constexpr int D = TestFixture::kDim;
  std::vector<NodePair> chain;
  std::vector<NodePair> star;
  for (int n = 1; n < 50; ++n) {
    chain.push_back({n, n - 1});
    star.push_back({0, n});
  }
  for (const auto& graph : {chain, star}) {
    SpringSystem<D> system;
    system.draw(50, graph, 7);
    ASSERT_TRUE(system.analyse(1 << 20));
    EXPECT_EQ(system.matrix.products(system.steps), 2 * 49);
  }
}

/// Right-hand sides of which the solution is known, solved.
template <int D>
static std::vector<typename BodyMatrix<D>::Vector> solve_in_two(SpringSystem<D>& system,
                                                                Range first, Range last) {
  using Vector = typename BodyMatrix<D>::Vector;
  std::vector<Vector> wanted(static_cast<std::size_t>(system.nodes));
  for (std::size_t n = 0; n < wanted.size(); ++n)
    for (int i = 0; i < Dim<D>::kFreedoms; ++i) wanted[n][i] = static_cast<double>(n % 5) - i;
  std::vector<Vector> right = system.times(wanted);
  system.matrix.solve_lower(first, right);
  system.matrix.solve(last, right);
  system.matrix.solve_upper(first, right);
  for (std::size_t n = 0; n < wanted.size(); ++n)
    for (int i = 0; i < Dim<D>::kFreedoms; ++i) EXPECT_NEAR(right[n][i], wanted[n][i], 1.0e-7);
  return right;
}

TYPED_TEST(BodyMatrixTest, WhatWasPutLastIsSolvedAgainWithoutTheRest) {
  constexpr int D = TestFixture::kDim;
  SpringSystem<D> system;
  system.draw(25, pairs_of_grid(5), 4);
  ASSERT_TRUE(system.analyse(1 << 20, {3, 12, 24}));
  const Range last = system.matrix.last_of(system.steps);
  ASSERT_EQ(last.end, system.steps.end);
  ASSERT_EQ(last.end - last.begin, 3);
  const Range first{system.steps.begin, last.begin};
  EXPECT_EQ(system.matrix.products(first) + system.matrix.products(last),
            system.matrix.products(system.steps));
  system.assemble();
  system.matrix.factor(first);
  system.matrix.keep(last);
  system.matrix.factor(last);
  const auto before = solve_in_two(system, first, last);

  // A spring between the middle and what does not move; then it is gone again.
  typename SpringSystem<D>::Vector spring;
  for (int i = 0; i < Dim<D>::kFreedoms; ++i) spring[i] = 1.0 + i;
  system.matrix.restore(last);
  for (int i = 0; i < Dim<D>::kFreedoms; ++i)
    for (int j = 0; j < Dim<D>::kFreedoms; ++j)
      system.matrix.diagonal(12).at(i, j) += 1000.0 * spring[i] * spring[j];
  system.matrix.factor(last);
  system.ground_node = 12;
  system.ground = spring;
  solve_in_two(system, first, last);

  system.matrix.restore(last);
  system.matrix.factor(last);
  system.ground_node = -1;
  const auto after = solve_in_two(system, first, last);
  for (std::size_t n = 0; n < before.size(); ++n)
    for (int i = 0; i < Dim<D>::kFreedoms; ++i) EXPECT_EQ(after[n][i], before[n][i]);
}

TYPED_TEST(BodyMatrixTest, RefusesAnIslandThatCostsTooMuchAndKeepsTheNext) {
  constexpr int D = TestFixture::kDim;
  BodyMatrix<D> matrix;
  matrix.begin(30);
  for (const NodePair& pair : pairs_of_grid(5)) matrix.join(pair.a, pair.b);
  for (int n = 26; n < 30; ++n) matrix.join(n - 1, n);
  Range dear{};
  EXPECT_FALSE(matrix.analyse({0, 25}, 30, dear));
  Range cheap{};
  ASSERT_TRUE(matrix.analyse({25, 30}, 30, cheap));
  EXPECT_EQ(cheap.end - cheap.begin, 5);
  EXPECT_EQ(matrix.products(cheap), 8);
}

}  // namespace cycloid::solver
