#include "solver/collision/bounds_kernels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "solver/collision/bounds_tree.hpp"
#include "tests/solver/every_width.hpp"

namespace cycloid::solver {

template <int D>
static Bounds<D> drawn_box(std::mt19937& random, float size) {
  Bounds<D> box;
  for (int i = 0; i < D; ++i) {
    box.lower[i] = static_cast<float>(random() % 1000) * 0.01f;
    box.upper[i] = box.lower[i] + size * static_cast<float>(random() % 100) * 0.01f;
  }
  return box;
}

template <int D>
struct FilledRows {
  explicit FilledRows(const std::vector<Bounds<D>>& boxes) {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      if (i % BoundsRow<D>::kBoxes == 0) rows.push_back(BoundsRow<D>::empty());
      rows.back().set(static_cast<int>(i % BoundsRow<D>::kBoxes), boxes[i]);
    }
  }
  std::vector<BoundsRow<D>> rows;
};

template <int D>
static std::vector<std::uint32_t> found_by_comparing(const std::vector<Bounds<D>>& boxes,
                                                     const Bounds<D>& box) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t i = 0; i < boxes.size(); ++i)
    if (overlaps(boxes[i], box)) found.push_back(i);
  return found;
}

/// Two levels: the rows of the boxes, and one row of what holds each of those.
template <int D, int W>
static std::vector<std::uint32_t> found_in_tree(const FilledRows<D>& leaves, const Bounds<D>& box) {
  std::vector<BoundsRow<D>> rows = leaves.rows;
  const int first_row[2] = {0, static_cast<int>(rows.size())};
  std::vector<Bounds<D>> held;
  for (const BoundsRow<D>& row : leaves.rows) held.push_back(row.all());
  rows.push_back(FilledRows<D>(held).rows.at(0));
  const RowsOfTree<D> tree{rows.data(), first_row, 2};
  std::vector<std::uint32_t> found;
  for_each_found(
      box,
      [&](BoundsSearch<D>& search, FoundBoxes& boxes) {
        return BoundsKernels<D, W>::search_tree(tree, search, boxes);
      },
      [&](std::uint32_t number) { found.push_back(number); });
  return found;
}

template <int D, int W>
static std::vector<std::uint32_t> found_in_rows(const FilledRows<D>& rows, const Bounds<D>& box) {
  std::vector<std::uint32_t> found;
  for_each_found(
      box,
      [&](BoundsSearch<D>& search, FoundBoxes& boxes) {
        return BoundsKernels<D, W>::search_rows(rows.rows.data(),
                                                static_cast<int>(rows.rows.size()), search, boxes);
      },
      [&](std::uint32_t number) { found.push_back(number); });
  return found;
}

/// Searches for few boxes and for so many that a kernel is called several times.
template <int D, int W>
static void expect_what_comparing_finds() {
  std::mt19937 random(D);
  for (const int count : {1, 15, 16, 17, 250}) {
    std::vector<Bounds<D>> boxes;
    for (int i = 0; i < count; ++i) boxes.push_back(drawn_box<D>(random, 2.0f));
    const FilledRows<D> rows(boxes);
    std::size_t most = 0;
    for (int i = 0; i < 200; ++i) {
      const Bounds<D> box = drawn_box<D>(random, i % 4 == 0 ? 20.0f : 1.0f);
      const std::vector<std::uint32_t> expected = found_by_comparing(boxes, box);
      most = std::max(most, expected.size());
      ASSERT_EQ((found_in_tree<D, W>(rows, box)), expected) << count << " boxes, " << W << " lanes";
      ASSERT_EQ((found_in_rows<D, W>(rows, box)), expected) << count << " boxes, " << W << " lanes";
    }
    EXPECT_TRUE(count < 250 || most > FoundBoxes::kMax);
  }
}

template <int D>
static void expect_it_of_every_width() {
  for_each_width<4>([]<int W>() { expect_what_comparing_finds<D, W>(); });
}

TEST(BoundsKernels, FindWhatComparingFindsInItsOrderAtEveryWidth) {
  expect_it_of_every_width<2>();
  expect_it_of_every_width<3>();
}

// A tree of three levels whose last rows are not full.
TEST(BoundsTree, OfManyFindsWhatComparingFinds) {
  std::mt19937 random(7);
  std::vector<BoundsTree<2>::Leaf> leaves;
  for (std::uint32_t i = 0; i < 4103; ++i) leaves.push_back({drawn_box<2>(random, 0.2f), i});
  BoundsTree<2> tree;
  TreeRoom<2> room;
  Workers workers(1);
  tree.build(leaves, workers, room);
  for (int i = 0; i < 100; ++i) {
    const Bounds<2> box = drawn_box<2>(random, i % 4 == 0 ? 5.0f : 0.3f);
    std::vector<int> found;
    tree.query(box, [&](int rank) { found.push_back(rank); });
    std::vector<int> expected;
    for (int rank = 0; rank < tree.size(); ++rank)
      if (overlaps(tree.leaf(rank).bounds, box)) expected.push_back(rank);
    ASSERT_EQ(found, expected);
  }
}

// Many lie in few places, and so have one code: their ids alone put them in order. Each thread
// sorts a part of them.
TEST(BoundsTree, IsTheSameInWhateverOrderItsLeavesComeAndByHoweverManyThreads) {
  std::mt19937 random(8);
  Bounds<2> places[5];
  for (Bounds<2>& place : places) place = drawn_box<2>(random, 0.2f);
  std::vector<BoundsTree<2>::Leaf> leaves;
  for (std::uint32_t i = 0; i < 4000; ++i) {
    const bool in_crowd = i % 3 != 0;
    leaves.push_back({in_crowd ? places[random() % 5] : drawn_box<2>(random, 0.2f), i});
  }
  BoundsTree<2> ordered;
  TreeRoom<2> room;
  Workers workers(1);
  ordered.build(leaves, workers, room);
  for (std::size_t i = leaves.size(); i > 1; --i) std::swap(leaves[i - 1], leaves[random() % i]);
  for (const int threads : {1, 2, 5}) {
    Workers several(threads);
    BoundsTree<2> shuffled;
    shuffled.build(leaves, several, room);
    ASSERT_EQ(ordered.size(), shuffled.size());
    for (int rank = 0; rank < ordered.size(); ++rank)
      ASSERT_EQ(ordered.leaf(rank).id, shuffled.leaf(rank).id) << rank << " by " << threads;
  }
}

}  // namespace cycloid::solver
