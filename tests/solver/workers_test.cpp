#include "solver/workers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <numeric>
#include <thread>
#include <utility>
#include <vector>

#include "solver/processors.hpp"

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

// They are not ended, and whoever asks how many there are hears of the one that is left.
TEST(Workers, RestWhileTheCallingThreadRunsAll) {
  Workers workers(3);
  const std::thread::id caller = std::this_thread::get_id();
  for (const bool rests : {true, false, true, false}) {
    workers.rest(rests);
    EXPECT_EQ(workers.count(), rests ? 1 : 3);
    std::atomic<int> members{0};
    workers.together([&](Member& member) {
      members.fetch_add(1);
      member.meet();
    });
    EXPECT_EQ(members.load(), rests ? 1 : 3);
    std::atomic<int> elsewhere{0};
    workers.parallel_for(300, 1, [&](Range) {
      if (std::this_thread::get_id() != caller) elsewhere.fetch_add(1);
    });
    if (!rests) continue;  // Then it may be that the others come too late for any.
    EXPECT_EQ(elsewhere.load(), 0);
  }
}

// The one of the two that is woken is often put where the one that wakes it is, and waits there.
TEST(Workers, OfAsManyAsProcessorsRunNowhereTheCallerDoes) {
  if (Processors().count() < 2) return;  // Then there is nowhere else.
  Workers workers(2);
  int looked_at = 0;
  for (int round = 0; round < 200 || looked_at == 0; ++round) {
    if (round % 10 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(10));  // It sleeps.
    const int before = processor_now();
    int on[2] = {-1, -1};
    workers.together([&](Member& member) { on[member.leads() ? 1 : 0] = processor_now(); });
    // The caller may be moved at any time.
    if (on[1] != before || processor_now() != before) continue;
    ++looked_at;
    EXPECT_NE(on[0], before) << "round " << round;
  }
}

TEST(Processors, AreLeftAtOnce) {
  const Processors all;
  if (all.count() < 2) return;  // Then there is nowhere to go.
  std::thread([&] {
    for (int round = 0; round < 20; ++round) {
      const int here = processor_now();
      all.leave(here);
      EXPECT_NE(processor_now(), here);
      EXPECT_EQ(Processors().count(), all.count() - 1);
    }
  }).join();
}

// Every part is some member's, and no more than one's, whatever the range and the threads.
TEST(Members, SharePartsThatMakeUpTheRange) {
  for (const int threads : {1, 2, 3, 8}) {
    Workers workers(threads);
    for (int size = 0; size < 70; ++size) {
      const Range whole{1000, 1000 + size};
      std::vector<Range> parts(static_cast<std::size_t>(threads));
      std::atomic<int> next{0};
      std::atomic<int> leaders{0};
      workers.together([&](Member& member) {
        if (member.leads()) leaders.fetch_add(1);
        parts[static_cast<std::size_t>(next.fetch_add(1))] = member.share_of(whole);
      });
      ASSERT_EQ(next.load(), threads);
      ASSERT_EQ(leaders.load(), 1);
      // Total order: ranges that compare equal are the same.
      std::sort(parts.begin(), parts.end(), [](const Range& a, const Range& b) {
        return std::pair(a.begin, a.end) < std::pair(b.begin, b.end);
      });
      int end = whole.begin;
      for (const Range& part : parts) {
        ASSERT_EQ(part.begin, end);
        ASSERT_GE(part.end, part.begin);
        ASSERT_TRUE((part.begin - whole.begin) % 2 == 0 || part.begin == whole.end);
        end = part.end;
      }
      ASSERT_EQ(end, whole.end);
    }
  }
}

// What each has written before they meet, all read behind it: plain numbers, so that a thread
// sanitizer sees a meeting that does not hold. More threads than processors have to come, too.
TEST(Members, SeeBehindAMeetingWhatAllHaveWrittenBeforeIt) {
  for (const int threads : {1, 2, 3, 8}) {
    Workers workers(threads);
    constexpr int kNumbers = 64;
    constexpr int kMeetings = 50;
    for (int job = 0; job < 20; ++job) {
      std::vector<std::int64_t> now(kNumbers, 1);
      std::vector<std::int64_t> next(kNumbers, 0);
      workers.together([&](Member& member) {
        for (int round = 0; round < kMeetings; ++round) {
          auto& from = round % 2 == 0 ? now : next;
          auto& to = round % 2 == 0 ? next : now;
          const Range part = member.share_of({0, kNumbers});
          for (int i = part.begin; i < part.end; ++i) {
            const int other = (i + kNumbers / 2 + round) % kNumbers;
            to[static_cast<std::size_t>(i)] =
                (from[static_cast<std::size_t>(i)] + from[static_cast<std::size_t>(other)] + i) %
                1000003;
          }
          member.meet();
        }
      });
      std::vector<std::int64_t> expected(kNumbers, 1);
      for (int round = 0; round < kMeetings; ++round) {
        const std::vector<std::int64_t> from = expected;
        for (int i = 0; i < kNumbers; ++i)
          expected[static_cast<std::size_t>(i)] =
              (from[static_cast<std::size_t>(i)] +
               from[static_cast<std::size_t>((i + kNumbers / 2 + round) % kNumbers)] + i) %
              1000003;
      }
      ASSERT_EQ(now, expected) << threads << " threads, job " << job;
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
