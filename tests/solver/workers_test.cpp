#include "solver/workers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
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

// Each works in its seat as if it were alone there: what is no atomic number would else lose
// counts, and a thread sanitizer say so.
TEST(Seats, AreLentToOneThreadAtATimeAndAreAsFewAsTheThreads) {
  constexpr int kThreads = 4;
  constexpr int kJobs = 4000;
  Workers workers(kThreads);
  Seats seats;
  std::vector<int> jobs_in(64, 0);
  workers.parallel_for(kJobs, 1, [&](Range) {
    const int seat = seats.take();
    ++jobs_in[static_cast<std::size_t>(seat)];
    seats.give_back(seat);
  });
  EXPECT_EQ(std::accumulate(jobs_in.begin(), jobs_in.begin() + kThreads, 0), kJobs);
  EXPECT_EQ(std::count(jobs_in.begin() + kThreads, jobs_in.end(), 0), 64 - kThreads);
}

TEST(Seats, OfOneThreadAreTheFirst) {
  Seats seats;
  for (int seat = 0; seat < 64; ++seat) EXPECT_EQ(seats.take(), seat);
  seats.give_back(17);
  seats.give_back(5);
  EXPECT_EQ(seats.take(), 5);
}

}  // namespace cycloid::solver
