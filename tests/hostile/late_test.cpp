#include <gtest/gtest.h>

#include <chrono>

#include "cli/replaying.hpp"
#include "tests/hostile/matches.hpp"

namespace cycloid::hostile {
namespace {

/// A log of 80 ticks with a state after the 40th, for two threads whose time is over: each looks at
/// the clock after 16 ticks.
class HostileLateLog : public testing::Test {
 protected:
  cli::Replayed replayed() const {
    cli::ReplayOptions options;
    options.deadline = std::chrono::steady_clock::time_point::min();
    return cli::replay_in_parts(cli::parse_log("log", match_.log), options, 2);
  }

  Match match_ = played("vehicle", 80, 40);
};

TEST_F(HostileLateLog, IsOutOfTimeWhereItsFirstPartIs) {
  const cli::Replayed late = replayed();
  EXPECT_TRUE(late.timed_out);
  EXPECT_EQ(late.tick(), 16u);
  EXPECT_FALSE(late.divergence);
}

TEST_F(HostileLateLog, DivergesThoughAnEarlierPartWasNotDone) {
  const std::size_t tick_42 = match_.ends[42];  // The state is a record, too.
  const std::size_t digest = tick_42 + protocol::kChunkHeadBytes;
  match_.log[digest] ^= std::byte{1};
  refit_checks(match_.checks, match_.log);
  const cli::Replayed late = replayed();
  ASSERT_TRUE(late.divergence);
  EXPECT_EQ(late.divergence->tick, 42u);
}

}  // namespace
}  // namespace cycloid::hostile
