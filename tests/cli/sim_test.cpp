#ifdef CYCLOID_NETWORK

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/cli/program.hpp"

namespace cycloid::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

/// Found early, while there are faults yet.
const std::vector<std::string> kPlanted = {"--plant", "room-repeats-frame"};

Ran simulated(std::vector<std::string> words) {
  words.insert(words.begin(), "sim");
  words.insert(words.end(), kPlanted.begin(), kPlanted.end());
  return run_program(words);
}

TEST(SimCommand, ARunThatFailsEarlySaysNotThatItCameToBeInSync) {
  const Ran text = simulated({"--seed", "1"});
  EXPECT_EQ(text.exit, 1) << text.out;
  EXPECT_THAT(text.out, Not(HasSubstr("in sync")));
  EXPECT_TRUE(simulated({"--seed", "1", "--json"}).json()["convergence_ms"].is_null());
  const Ran good = run_program({"sim", "--seed", "1", "--json"});
  EXPECT_EQ(good.exit, 0) << good.out;
  EXPECT_TRUE(good.json()["convergence_ms"].is_number());
}

TEST(SimCommand, TheLineThatRepeatsARunIsAsAShellTakesIt) {
  const Folder folder;
  const std::string scene = folder.file("my scene's.json");
  ASSERT_EQ(run_program({"scene", "export", "half-pipe", "-o", scene}).exit, 0);
  const Ran ran = simulated({"--seed", "1", "--scene", scene, "--ticks", "60", "--json"});
  ASSERT_EQ(ran.exit, 1) << ran.out << ran.err;
  const std::string line = ran.json()["violation"]["line"];
  EXPECT_EQ(line, "cycloid sim --seed 1 --ticks 60 --scene '" + folder.file("my scene'\\''s.json") +
                      "' --plant room-repeats-frame");
}

TEST(SimCommand, FailedRunsStandInTheOrderOfTheirSeeds) {
  const Ran ran = simulated({"--seeds", "12", "--jobs", "4", "--json"});
  EXPECT_EQ(ran.exit, 1);
  const nlohmann::json failed = ran.json()["failed"];
  ASSERT_GT(failed.size(), 4u);
  for (std::size_t i = 1; i < failed.size(); ++i)
    EXPECT_GT(failed[i]["seed"].get<int>(), failed[i - 1]["seed"].get<int>());
}

TEST(SimCommand, WhatHappensIsSaidBesideJsonToo) {
  const Ran ran = run_program({"sim", "--seed", "1", "--ticks", "60", "--json", "-v"});
  EXPECT_EQ(ran.exit, 0) << ran.err;
  EXPECT_TRUE(ran.json()["passed"].get<bool>());
  EXPECT_THAT(ran.err, HasSubstr("the faults are over"));
}

}  // namespace
}  // namespace cycloid::cli

#endif
