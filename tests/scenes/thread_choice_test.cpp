#include "scenes/thread_choice.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <utility>
#include <vector>

#include "scenes/catalogue.hpp"
#include "scenes/simulation.hpp"

namespace cycloid::scenes {
namespace {

/// What a step takes on one thread, and on all.
struct StepCost {
  std::uint64_t alone_ns;
  std::uint64_t together_ns;
};

/// How many of the next `steps` are taken by one thread.
int steps_alone(const StepCost& cost, int steps, ThreadChoice& choice) {
  int alone = 0;
  for (int step = 0; step < steps; ++step) {
    alone += choice.is_alone() ? 1 : 0;
    choice.took(choice.is_alone() ? cost.alone_ns : cost.together_ns);
  }
  return alone;
}

/// Until rounds are as long as they become.
constexpr int kWarm = 4 * ThreadChoice::kRoundMax;
constexpr int kTried = ThreadChoice::kTried;

TEST(ThreadChoices, TakeAllThreadsWhereThatIsFasterAndTryOneNowAndThen) {
  ThreadChoice choice;
  steps_alone({1000, 600}, kWarm, choice);
  EXPECT_EQ(steps_alone({1000, 600}, 10 * ThreadChoice::kRoundMax, choice), 10 * kTried);
}

TEST(ThreadChoices, TakeOneThreadWhereThatIsFasterAndTryAllNowAndThen) {
  ThreadChoice choice;
  steps_alone({1000, 1300}, kWarm, choice);
  EXPECT_EQ(steps_alone({1000, 1300}, 10 * ThreadChoice::kRoundMax, choice),
            10 * (ThreadChoice::kRoundMax - kTried));
}

// The cores that a host lends change, and so does the world: at most a round goes by the old
// answer, and after the change both are tried again soon.
TEST(ThreadChoices, ChangeWithinARoundAndAskAgainSoon) {
  ThreadChoice choice;
  steps_alone({1000, 600}, kWarm, choice);
  EXPECT_GT(steps_alone({1000, 1300}, ThreadChoice::kRoundMax, choice), kTried);
  steps_alone({1000, 1300}, kWarm, choice);
  EXPECT_GE(steps_alone({1000, 1300}, kWarm, choice), kWarm - 5 * kTried);
}

TEST(ThreadChoices, BeginWithShortRounds) {
  ThreadChoice choice;
  EXPECT_EQ(steps_alone({1000, 600}, 2 * kTried, choice), kTried);
  // As a world that falls first, and lies in a heap then.
  EXPECT_EQ(steps_alone({1000, 1300}, ThreadChoice::kRoundMin - 2 * kTried, choice), 0);
  EXPECT_EQ(steps_alone({1000, 1300}, ThreadChoice::kRoundMin, choice),
            ThreadChoice::kRoundMin - kTried);
}

// Threads that have rested come late to the first steps, and now and then the system has something
// else to do.
TEST(ThreadChoices, OverlookTheFirstStepsOfATryAndSingleSlowOnes) {
  for (int slow = 0; slow < 2 * kTried; ++slow) {
    ThreadChoice choice;
    for (int step = 0; step < 2 * kTried; ++step) {
      const bool is_slow = step % kTried < 2 || step == slow;
      choice.took(is_slow ? 900'000 : choice.is_alone() ? 1000 : 600);
    }
    EXPECT_FALSE(choice.is_alone()) << slow;
  }
}

/// How often the clock was read, which is its time as well.
std::uint64_t choice_reads = 0;
std::uint64_t choice_clock() {
  return ++choice_reads;
}

// Both kinds of step, in turn with one another, and a clock that is read twice a step.
TEST(ThreadChoices, ChangeNoBitOfAStep) {
  for (const char* name : {"room-200", "ragdolls", "pyramid-20", "ball-pit-3d", "cloth"}) {
    const Scene scene = *find(name).scene;
    Simulation one = std::move(Simulation::create(scene).value());
    Simulation chosen = std::move(Simulation::create(scene).value());
    ASSERT_TRUE(chosen.set_workers_at_most(3, &choice_clock).ok());
    const std::uint64_t reads_before = choice_reads;
    const std::vector<SeatInput> inputs(static_cast<std::size_t>(one.seats()));
    constexpr std::uint64_t kSteps = 3 * kTried;
    for (std::uint64_t tick = 1; tick <= kSteps; ++tick) {
      ASSERT_TRUE(one.step(inputs).ok());
      ASSERT_TRUE(chosen.step(inputs).ok());
      ASSERT_EQ(one.digest(), chosen.digest()) << name << " tick " << tick;
    }
    EXPECT_EQ(choice_reads - reads_before, 2 * kSteps);
  }
}

TEST(ThreadChoices, AreNotMadeOfOneThreadNorOfWorkersThatAreSet) {
  const Scene scene = *find("stack-10").scene;
  Simulation simulation = std::move(Simulation::create(scene).value());
  const std::vector<SeatInput> inputs(static_cast<std::size_t>(simulation.seats()));
  const std::uint64_t reads_before = choice_reads;
  ASSERT_TRUE(simulation.set_workers_at_most(1, &choice_clock).ok());
  ASSERT_TRUE(simulation.step(inputs).ok());
  ASSERT_TRUE(simulation.set_workers_at_most(2, &choice_clock).ok());
  ASSERT_TRUE(simulation.set_workers(2).ok());
  ASSERT_TRUE(simulation.step(inputs).ok());
  EXPECT_EQ(choice_reads, reads_before);
}

TEST(ThreadChoices, StayWhereWorkersAreRefused) {
  Simulation simulation = std::move(Simulation::create(*find("stack-10").scene).value());
  const std::vector<SeatInput> inputs(static_cast<std::size_t>(simulation.seats()));
  ASSERT_TRUE(simulation.set_workers_at_most(2, &choice_clock).ok());
  EXPECT_STREQ(simulation.set_workers_at_most(65, &choice_clock).field, "workers");
  EXPECT_STREQ(simulation.set_workers(0).field, "workers");
  const std::uint64_t reads_before = choice_reads;
  ASSERT_TRUE(simulation.step(inputs).ok());
  EXPECT_EQ(choice_reads, reads_before + 2);
}

}  // namespace
}  // namespace cycloid::scenes
