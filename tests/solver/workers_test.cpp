#include "solver/workers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace cycloid::solver {

// Threads begin with shares of their own and take from the others': every index is run once all the
// same, in the ranges that the size and the grain alone make.
TEST(Workers, RunEveryIndexOnceInRangesOfTheGrain) {
  for (const int threads : {1, 2, 3, 8}) {
    Workers workers(threads);
    for (const int size : {0, 1, 15, 16, 17, 33, 257}) {
      for (const int grain : {1, 7, 16}) {
        for (int round = 0; round < 20; ++round) {
          std::vector<int> times(static_cast<std::size_t>(size), 0);
          std::vector<int> wrong(static_cast<std::size_t>(size), 0);
          workers.parallel_for(size, grain, [&](Range range) {
            const int end = std::min(range.begin + grain, size);
            if (range.begin % grain != 0 || range.end != end)
              wrong[static_cast<std::size_t>(range.begin)] = 1;
            for (int i = range.begin; i < range.end; ++i) ++times[static_cast<std::size_t>(i)];
          });
          ASSERT_EQ(std::count(times.begin(), times.end(), 1), size);
          ASSERT_EQ(std::count(wrong.begin(), wrong.end(), 1), 0);
        }
      }
    }
  }
}

}  // namespace cycloid::solver
