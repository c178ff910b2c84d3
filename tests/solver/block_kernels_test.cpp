#include "solver/direct/block_kernels.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <random>
#include <vector>

#include "solver/lane_widths.hpp"

namespace cycloid::solver {

/// Three bodies that all hold each other: node 0 goes first, then 1, then 2. The blocks lie beside
/// the diagonal as (1, 0), (0, 2) and (2, 1), of which the second is transposed.
template <int D>
struct TriangleOfBlocks {
  static constexpr int kSize = Dim<D>::kFreedoms;
  using Block = SquareBlock<kSize>;

  std::vector<EliminationStep> steps{{0, 0, 0}, {1, 2, 1}, {2, 3, 1}, {-1, 3, 1}};
  std::vector<ColumnEntry> entries{{1, 0, false}, {2, 1, true}, {2, 2, false}};
  std::vector<int> targets{2};
  std::vector<Block> diagonal = std::vector<Block>(3);
  std::vector<Block> beside = std::vector<Block>(3);
  std::vector<Pivot<kSize>> pivots = std::vector<Pivot<kSize>>(3);
  std::vector<Block> column = std::vector<Block>(2);

  explicit TriangleOfBlocks(unsigned seed) {
    std::minstd_rand random(seed);
    const auto number = [&] { return static_cast<double>(random() % 2001u) / 1000.0 - 1.0; };
    for (Block& block : diagonal)
      for (int i = 0; i < kSize; ++i) {
        for (int j = 0; j < i; ++j) block.at(i, j) = block.at(j, i) = number();
        block.at(i, i) = 20.0 + number();
      }
    for (Block& block : beside)
      for (int i = 0; i < kSize; ++i)
        for (int j = 0; j < kSize; ++j) block.at(i, j) = number();
  }

  template <int W>
  void factor_by_kernel() {
    BlockKernels<D, W>::factor(
        {0, 3}, {steps.data(), entries.data(), targets.data(), diagonal.data(), beside.data(),
                 pivots.data(), column.data()});
  }

  /// What the kernels have to come to: each number by itself, in the order of the formulas.
  void factor_by_number() {
    for (int node = 0; node < 3; ++node) {
      factor_own(diagonal[static_cast<std::size_t>(node)], pivots[static_cast<std::size_t>(node)]);
      const int first = steps[static_cast<std::size_t>(node)].entries;
      const int end = steps[static_cast<std::size_t>(node) + 1].entries;
      for (int e = first; e < end; ++e) eliminate(node, e, first);
    }
  }

 private:
  static void factor_own(const Block& block, Pivot<kSize>& pivot) {
    for (int i = 0; i < kSize; ++i) {
      double row[kSize];
      double left = block.at(i, i);
      for (int j = 0; j < i; ++j) {
        row[j] = block.at(i, j);
        for (int k = 0; k < j; ++k) row[j] -= row[k] * pivot.lower[j][k];
        pivot.lower[i][j] = row[j] * pivot.inverse[j];
        left -= row[j] * pivot.lower[i][j];
      }
      pivot.inverse[i] = 1.0 / left;
    }
  }

  static void subtract(const Block& a, const Block& b, Block& from) {
    for (int i = 0; i < kSize; ++i)
      for (int j = 0; j < kSize; ++j) {
        double sum = a.at(i, 0) * b.at(j, 0);
        for (int k = 1; k < kSize; ++k) sum += a.at(i, k) * b.at(j, k);
        from.at(i, j) -= sum;
      }
  }

  void eliminate(int node, int e, int first) {
    const ColumnEntry& entry = entries[static_cast<std::size_t>(e)];
    const Pivot<kSize>& pivot = pivots[static_cast<std::size_t>(node)];
    Block& block = beside[static_cast<std::size_t>(entry.block)];
    Block& divided = column[static_cast<std::size_t>(e - first)];
    const Block before = block;
    for (int i = 0; i < kSize; ++i)
      for (int j = 0; j < kSize; ++j) {
        block.at(i, j) = entry.transposed ? before.at(j, i) : before.at(i, j);
        for (int k = 0; k < j; ++k) block.at(i, j) -= block.at(i, k) * pivot.lower[j][k];
        divided.at(i, j) = block.at(i, j) * pivot.inverse[j];
      }
    if (e > first) subtract(block, column[0], beside[static_cast<std::size_t>(targets[0])]);
    subtract(block, divided, diagonal[static_cast<std::size_t>(entry.node)]);
    for (int i = 0; i < kSize; ++i)
      for (int j = kSize; j-- > 0;) {
        block.at(i, j) = divided.at(i, j);
        for (int k = j + 1; k < kSize; ++k) block.at(i, j) -= block.at(i, k) * pivot.lower[k][j];
      }
  }
};

static std::uint64_t bits(double x) {
  return std::bit_cast<std::uint64_t>(x);
}

template <int D>
static void expect_equal_bits(const TriangleOfBlocks<D>& expected, const TriangleOfBlocks<D>& got) {
  constexpr int kSize = Dim<D>::kFreedoms;
  for (std::size_t n = 0; n < 3; ++n)
    for (int i = 0; i < kSize; ++i) {
      EXPECT_EQ(bits(expected.pivots[n].inverse[i]), bits(got.pivots[n].inverse[i]))
          << n << " " << i;
      for (int j = 0; j < i; ++j)
        EXPECT_EQ(bits(expected.pivots[n].lower[i][j]), bits(got.pivots[n].lower[i][j]))
            << n << i << j;
      for (int j = 0; j < kSize; ++j)
        EXPECT_EQ(bits(expected.beside[n].at(i, j)), bits(got.beside[n].at(i, j))) << n << i << j;
    }
}

template <int D>
static void expect_factors_of_every_set() {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    TriangleOfBlocks<D> expected(seed);
    expected.factor_by_number();
    TriangleOfBlocks<D> by_pairs(seed);
    by_pairs.template factor_by_kernel<4>();
    expect_equal_bits(expected, by_pairs);
    if constexpr (kHasAvxKernels) {
      if (!has_avx2_kernels()) continue;
      TriangleOfBlocks<D> by_fours(seed);
      by_fours.template factor_by_kernel<kAvx2Lanes>();
      expect_equal_bits(expected, by_fours);
    }
  }
}

TEST(BlockKernels, FactorToTheBitAsNumberAfterNumber) {
  expect_factors_of_every_set<2>();
  expect_factors_of_every_set<3>();
}

}  // namespace cycloid::solver
