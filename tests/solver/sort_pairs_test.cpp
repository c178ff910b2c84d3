#include "solver/collision/sort_pairs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace cycloid::solver {
namespace {

std::vector<ShapePair> some_pairs(std::uint32_t shapes, std::size_t count) {
  std::mt19937 random(shapes);
  std::vector<ShapePair> pairs;
  const auto slot = [&] { return static_cast<std::uint32_t>(random() % shapes); };
  for (std::size_t i = 0; i < count; ++i) pairs.push_back({slot(), slot()});
  pairs.push_back({shapes - 1, shapes - 1});
  pairs.push_back({0, shapes - 1});
  pairs.push_back({shapes - 1, 0});
  return pairs;
}

/// Where the number of digits changes, and where both slots no longer are one number of 32 bits.
class SortPairs : public testing::TestWithParam<std::uint32_t> {};

TEST_P(SortPairs, PutsThemInTheOrderOfTheirKeys) {
  std::vector<ShapePair> room;
  for (const std::size_t count : {0u, 10u, 252u, 253u, 5000u}) {
    std::vector<ShapePair> pairs = some_pairs(GetParam(), count);
    std::vector<std::uint64_t> keys;
    for (const ShapePair& pair : pairs) keys.push_back(pair.key());
    // Total order: equal integers are one and the same, on every platform.
    std::sort(keys.begin(), keys.end());
    sort_pairs(GetParam(), room, pairs);
    ASSERT_EQ(pairs.size(), keys.size());
    for (std::size_t i = 0; i < keys.size(); ++i) ASSERT_EQ(pairs[i].key(), keys[i]) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, SortPairs,
                         testing::Values(1u, 2u, 2047u, 2048u, 2049u, 65535u, 65536u, 65537u,
                                         1u << 22, 1u << 23));

}  // namespace
}  // namespace cycloid::solver
