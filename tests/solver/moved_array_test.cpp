#include "solver/moved_array.hpp"

#include <gtest/gtest.h>

namespace cycloid::solver {

namespace {

struct Place {
  std::uint64_t at = 0;
};
struct Worth {
  std::uint64_t worth = 0;
};
struct Coin : Worth, Place {
  using Kept = Worth;
  using Moved = Place;
};

/// The worth of all as their kept number, and how often it was made.
struct Counting {
  int made = 0;

  std::uint64_t of(const MovedArray<Coin>& coins) {
    return coins.kept_number([&] {
      ++made;
      std::uint64_t sum = 1;
      for (const Coin& coin : coins) sum += coin.worth;
      return sum;
    });
  }
};

void add(std::uint64_t worth, MovedArray<Coin>& coins) {
  coins.edit([&](std::vector<Coin>& all) { all.push_back({{worth}, {0}}); });
}

/// A coin worth 5, counted once.
class MovedArrayTest : public testing::Test {
 protected:
  MovedArrayTest() {
    add(5, coins);
    EXPECT_EQ(count.of(coins), 6u);
  }

  Counting count;
  MovedArray<Coin> coins;
};

TEST_F(MovedArrayTest, MakesItsNumberOnceWhateverMoves) {
  coins.moved(0).at = 9;
  EXPECT_EQ(coins[0].at, 9u);
  EXPECT_EQ(count.of(coins), 6u);
  EXPECT_EQ(count.made, 1);
}

TEST_F(MovedArrayTest, ForgetsItsNumberWithEveryEdit) {
  add(2, coins);
  EXPECT_EQ(count.of(coins), 8u);
  coins.edit_one(0, [](Coin& coin) { coin.worth = 1; });
  EXPECT_EQ(count.of(coins), 4u);
}

TEST_F(MovedArrayTest, GivesItsNumberToCopiesWhichThenForgetByThemselves) {
  MovedArray<Coin> copy = coins;
  MovedArray<Coin> assigned;
  add(70, assigned);
  EXPECT_EQ(count.of(assigned), 71u);
  assigned = coins;
  count.made = 0;
  EXPECT_EQ(count.of(copy), 6u);
  EXPECT_EQ(count.of(assigned), 6u);
  EXPECT_EQ(count.made, 0);
  add(2, copy);
  EXPECT_EQ(count.of(copy), 8u);
  EXPECT_EQ(count.of(coins), 6u);
}

TEST_F(MovedArrayTest, LeavesNoNumberWhereItWasMovedFrom) {
  MovedArray<Coin> other = std::move(coins);
  EXPECT_EQ(count.of(other), 6u);
  coins.edit([](std::vector<Coin>& all) { all.clear(); });
  EXPECT_EQ(count.of(coins), 1u);
  add(2, coins);
  EXPECT_EQ(count.of(coins), 3u);
  other = std::move(coins);
  EXPECT_EQ(count.of(other), 3u);
  EXPECT_EQ(count.of(coins), 1u);
}

}  // namespace

}  // namespace cycloid::solver
