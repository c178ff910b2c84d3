#include "solver/shared_array.hpp"

#include <gtest/gtest.h>

namespace cycloid::solver {

/// The sum of an array as its kept number, and how often it was made.
struct Summing {
  int made = 0;

  std::uint64_t of(const SharedArray<std::uint64_t>& array) {
    return array.kept_number([&] {
      ++made;
      std::uint64_t sum = 1;
      for (const std::uint64_t value : array) sum += value;
      return sum;
    });
  }
};

static void append(std::uint64_t value, SharedArray<std::uint64_t>& array) {
  array.edit([&](std::vector<std::uint64_t>& items) { items.push_back(value); });
}

TEST(SharedArray, KeepsANumberForAllItsCopiesUntilOneIsEdited) {
  Summing sum;
  SharedArray<std::uint64_t> array;
  EXPECT_EQ(sum.of(array), 1u);
  append(5, array);
  EXPECT_EQ(sum.of(array), 6u);
  SharedArray<std::uint64_t> copy = array;
  sum.made = 0;
  EXPECT_EQ(sum.of(array), 6u);
  EXPECT_EQ(sum.of(copy), 6u);
  EXPECT_EQ(sum.made, 0);
  append(2, copy);
  EXPECT_EQ(sum.of(copy), 8u);
  EXPECT_EQ(sum.of(array), 6u);
  EXPECT_EQ(sum.made, 1);
}

// Nobody shares it, so it is edited where it lies, beside the number that was made of it.
TEST(SharedArray, ForgetsTheNumberOfWhatIsEditedInPlace) {
  Summing sum;
  SharedArray<std::uint64_t> array;
  append(5, array);
  EXPECT_EQ(sum.of(array), 6u);
  append(2, array);
  EXPECT_EQ(sum.of(array), 8u);
}

}  // namespace cycloid::solver
