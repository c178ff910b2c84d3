#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/program.hpp"

namespace cycloid::cli {
namespace {

using testing::HasSubstr;

/// Goal: the profile is of the scene's own steps, and leaves no time out. Method: the digest of the
/// run of the same ticks, and the sum of the parts.
TEST(ProfileCommand, AddsUpAndEndsWhereARunEnds) {
  const Ran ran = run_program(
      {"profile", "half-pipe", "--warm", "10", "--ticks", "20", "--rounds", "2", "--json"});
  ASSERT_EQ(ran.exit, 0) << ran.err;
  const nlohmann::json object = ran.json();
  EXPECT_EQ(object["steps"], 20);
  std::uint64_t sum_ns = object["after_ns"];
  for (const nlohmann::json& stage : object["stages"]) {
    sum_ns += stage["time_ns"].get<std::uint64_t>();
    EXPECT_EQ(stage["calls"].get<int>() % 20, 0) << stage;
  }
  EXPECT_EQ(object["total_ns"], sum_ns);
  EXPECT_GT(object["plain_ns"], 0);
  const Ran trace = run_program({"trace", "half-pipe", "--tick", "30", "--json"});
  ASSERT_EQ(trace.exit, 0) << trace.err;
  EXPECT_EQ(object["digest"], trace.json()["digest"]);
}

TEST(ProfileCommand, PrintsALineForEachStage) {
  const Ran ran = run_program({"profile", "stack-10", "--warm", "0", "--ticks", "2"});
  ASSERT_EQ(ran.exit, 0) << ran.err;
  for (const char* word : {"collide", "sweep", "after", "whole", "without the clock"})
    EXPECT_THAT(ran.out, HasSubstr(word));
}

TEST(ProfileCommand, RefusesWhatDoesNotExist) {
  EXPECT_EQ(run_program({"profile"}).exit, 2);
  EXPECT_EQ(run_program({"profile", "no-such-scene"}).exit, 2);
  EXPECT_EQ(run_program({"profile", "stack-10", "--ticks", "0"}).exit, 2);
  EXPECT_EQ(run_program({"profile", "stack-10", "--lanes", "3"}).exit, 2);
}

}  // namespace
}  // namespace cycloid::cli
