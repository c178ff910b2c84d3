#include "solver/stages/by_color.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace cycloid::solver {
namespace {

/// Colours one behind the other, some of them empty, few or many, and an overflow.
struct SomeColors {
  std::vector<Range> colors;
  Range overflow;
};

SomeColors some_colors(std::mt19937& random) {
  SomeColors made;
  int end = 0;
  const auto next = [&](std::uint32_t most) {
    const Range range{end, end + static_cast<int>(random() % (most + 1))};
    end = range.end;
    return range;
  };
  const std::uint32_t count = random() % 8;
  for (std::uint32_t color = 0; color < count; ++color)
    made.colors.push_back(next(random() % 2 == 0 ? 3 * kFewOfColor : kFewOfColor));
  made.overflow = next(3);
  return made;
}

/// Calls act(workers, colours) for a few numbers of threads, as many colours each.
template <class Act>
void for_some_colors(unsigned seed, Act&& act) {
  std::mt19937 random(seed);
  for (const int threads : {1, 2, 3, 8}) {
    Workers workers(threads);
    for (int round = 0; round < 200; ++round) act(workers, some_colors(random));
  }
}

}  // namespace

// The numbers are plain, so a thread sanitizer sees where one is read that nobody has met over.
TEST(ByColor, ComesToAColorWhenThoseBeforeAreDone) {
  for_some_colors(7, [](Workers& workers, const SomeColors& of) {
    std::vector<int> times(static_cast<std::size_t>(of.overflow.end), 0);
    std::vector<int> early(times.size(), 0);
    for_each_range_by_color(of.colors, of.overflow, workers, [&](Range range) {
      int before = 0;  // Where the colour begins.
      for (const Range& color : of.colors)
        if (color.begin <= range.begin && range.begin < color.end) before = color.begin;
      if (range.begin >= of.overflow.begin) before = range.begin;
      for (int i = 0; i < before; ++i)
        if (times[static_cast<std::size_t>(i)] != 1)
          early[static_cast<std::size_t>(range.begin)] = 1;
      for (int i = range.begin; i < range.end; ++i) ++times[static_cast<std::size_t>(i)];
    });
    ASSERT_EQ(std::count(times.begin(), times.end(), 1), of.overflow.end);
    ASSERT_EQ(std::count(early.begin(), early.end(), 1), 0) << workers.count() << " threads";
  });
}

TEST(ByColor, RunsEveryPartOnceWhereNoOrderIsAskedFor) {
  for_some_colors(8, [](Workers& workers, const SomeColors& of) {
    std::vector<int> times(static_cast<std::size_t>(of.overflow.end), 0);
    for_each_part_of_colors(of.colors, of.overflow, workers, [&](Range range) {
      for (int i = range.begin; i < range.end; ++i) ++times[static_cast<std::size_t>(i)];
    });
    ASSERT_EQ(std::count(times.begin(), times.end(), 1), of.overflow.end);
  });
}

}  // namespace cycloid::solver
