#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <set>

#include "tests/cli/program.hpp"
#include "tests/cli/xml.hpp"

namespace cycloid::cli {
namespace {

using testing::HasSubstr;

using Variables = std::map<std::string, std::string>;

/// Runs the program with these variables, and without others of schedulers.
Ran run_with(const Variables& variables, const std::vector<std::string>& arguments) {
  for (const char* name :
       {"JOB_COMPLETION_INDEX", "JOB_COMPLETIONS", "CYCLOID_SHARDS", "SLURM_ARRAY_TASK_ID",
        "SLURM_ARRAY_TASK_MIN", "SLURM_ARRAY_TASK_COUNT", "SLURM_ARRAY_TASK_STEP", "PARALLEL_SEQ"})
    ::unsetenv(name);
  for (const auto& [name, value] : variables) ::setenv(name.c_str(), value.c_str(), 1);
  const Ran ran = run_program(arguments);
  for (const auto& [name, value] : variables) ::unsetenv(name.c_str());
  return ran;
}

/// Nine logs that are not the same.
class ShardedVerify : public testing::Test {
 protected:
  ShardedVerify() {
    for (int i = 1; i <= kLogs; ++i) {
      const std::string number = std::to_string(i);
      EXPECT_EQ(run_program({"run", "half-pipe", "--ticks", number, "--log",
                             folder_.file(number + ".cylog")})
                    .exit,
                0);
    }
  }

  std::set<std::string> logs_of(const Ran& ran) const {
    std::set<std::string> logs;
    const nlohmann::json json = ran.json();
    for (const auto& log : json["logs"]) logs.insert(log["log"].get<std::string>());
    return logs;
  }

  static constexpr int kLogs = 9;
  Folder folder_;
};

/// Every log in exactly one part, whatever the number of parts, and the verdicts of all parts are
/// those of the whole.
TEST_F(ShardedVerify, PartsAreTheSetExactly) {
  for (const int parts : {1, 2, 3, 20}) {
    std::set<std::string> seen;
    std::size_t in_all = 0;
    std::size_t cases = 0;
    for (int part = 1; part <= parts; ++part) {
      const std::string junit = folder_.file("junit.xml");
      const Ran ran = run_with({}, {"verify", folder_.path(), "--json", "--junit", junit, "--shard",
                                    std::to_string(part) + "/" + std::to_string(parts)});
      ASSERT_EQ(ran.exit, 0) << ran.out << ran.err;
      const std::set<std::string> logs = logs_of(ran);
      in_all += logs.size();
      seen.insert(logs.begin(), logs.end());
      cases += std::stoul(XmlReader::read(read_text(junit)).attributes.at("tests"));
    }
    EXPECT_EQ(in_all, std::size_t{kLogs}) << parts;
    EXPECT_EQ(seen.size(), std::size_t{kLogs}) << parts;
    EXPECT_EQ(cases, std::size_t{kLogs}) << parts;
  }
}

/// The bytes decide: names, folders and the order of arguments do not.
TEST_F(ShardedVerify, NamesDoNotMatter) {
  const Folder other;
  for (int i = 1; i <= kLogs; ++i)
    write_text(other.file("x" + std::to_string(kLogs - i) + ".cylog"),
               read_text(folder_.file(std::to_string(i) + ".cylog")));
  const auto ticks = [](const Ran& ran) { return ran.json()["ticks"].get<int>(); };
  for (const char* part : {"1/3", "2/3", "3/3"})
    EXPECT_EQ(ticks(run_with({}, {"verify", folder_.path(), "--json", "--shard", part})),
              ticks(run_with({}, {"verify", other.path(), "--json", "--shard", part})));
}

TEST_F(ShardedVerify, AutoIsWhatTheSchedulerSays) {
  const auto by_hand = [&](const char* part) {
    return logs_of(run_with({}, {"verify", folder_.path(), "--json", "--shard", part}));
  };
  const auto by = [&](const Variables& variables) {
    const Ran ran = run_with(variables, {"verify", folder_.path(), "--json", "--shard", "auto"});
    EXPECT_EQ(ran.exit, 0) << ran.err;
    return logs_of(ran);
  };
  EXPECT_EQ(by({{"JOB_COMPLETION_INDEX", "0"}, {"JOB_COMPLETIONS", "3"}}), by_hand("1/3"));
  EXPECT_EQ(by({{"JOB_COMPLETION_INDEX", "2"}, {"CYCLOID_SHARDS", "3"}}), by_hand("3/3"));
  EXPECT_EQ(by({{"SLURM_ARRAY_TASK_ID", "12"},
                {"SLURM_ARRAY_TASK_MIN", "10"},
                {"SLURM_ARRAY_TASK_STEP", "2"},
                {"SLURM_ARRAY_TASK_COUNT", "3"}}),
            by_hand("2/3"));
  EXPECT_EQ(by({{"SLURM_ARRAY_TASK_ID", "0"}, {"SLURM_ARRAY_TASK_COUNT", "3"}}), by_hand("1/3"));
  EXPECT_EQ(by({{"PARALLEL_SEQ", "3"}, {"CYCLOID_SHARDS", "3"}}), by_hand("3/3"));
}

TEST_F(ShardedVerify, WhatIsMissingOrWrongIsNamed) {
  struct Case {
    Variables variables;
    const char* shard;
    const char* named;
  };
  for (const Case& bad :
       {Case{{}, "auto", "JOB_COMPLETION_INDEX"},
        Case{{{"JOB_COMPLETION_INDEX", "1"}}, "auto", "CYCLOID_SHARDS"},
        Case{{{"JOB_COMPLETION_INDEX", "3"}, {"JOB_COMPLETIONS", "3"}}, "auto", "4 of 3"},
        Case{{{"PARALLEL_SEQ", "x"}, {"CYCLOID_SHARDS", "3"}},
             "auto",
             "PARALLEL_SEQ is no number: x"},
        Case{{{"PARALLEL_SEQ", "1"}, {"SLURM_ARRAY_TASK_ID", "1"}},
             "auto",
             "both SLURM_ARRAY_TASK_ID and PARALLEL_SEQ"},
        Case{{}, "0/3", "0 of 3"}, Case{{}, "4/3", "4 of 3"}, Case{{}, "3", "not '3'"}}) {
    const Ran ran = run_with(bad.variables, {"verify", folder_.path(), "--shard", bad.shard});
    EXPECT_EQ(ran.exit, 2) << bad.named;
    EXPECT_THAT(ran.err, HasSubstr(bad.named));
  }
  const Folder empty;
  EXPECT_EQ(run_with({}, {"verify", empty.path(), "--shard", "1/3"}).exit, 5);
}

}  // namespace
}  // namespace cycloid::cli
