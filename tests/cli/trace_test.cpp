#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/program.hpp"

namespace cycloid::cli {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;

TEST(TraceCommand, WithoutATickPrintsTheDigestsOfRun) {
  const Ran ran = run_program({"trace", "card-house", "--ticks", "5"});
  EXPECT_EQ(ran.exit, 0) << ran.err;
  const Ran run = run_program({"run", "card-house", "--ticks", "5", "--digest-every", "1"});
  EXPECT_EQ(ran.out.substr(ran.out.find('\n') + 1), run.out);
  EXPECT_EQ(ran.out.substr(0, 2), "0 ");
}

TEST(TraceCommand, OfALogIsThatOfItsScene) {
  const Folder folder;
  run_program({"run", "wall", "--ticks", "20", "--log", folder.file("a.cylog")});
  EXPECT_EQ(run_program({"trace", folder.file("a.cylog"), "--tick", "20"}).out,
            run_program({"trace", "wall", "--tick", "20"}).out);
  EXPECT_EQ(run_program({"trace", folder.file("a.cylog"), "--tick", "21"}).exit, 2);
}

TEST(TraceCommand, ListsPhasesInTheOrderOfTheStepAndEndsWithTheDigestOfRun) {
  const Ran ran = run_program({"trace", "wall", "--tick", "10", "--json"});
  EXPECT_EQ(ran.exit, 0) << ran.err;
  const nlohmann::json trace = ran.json();
  std::vector<std::string> names;
  for (const nlohmann::json& phase : trace["phases"])
    if (names.empty() || names.back() != phase["phase"]) names.push_back(phase["phase"]);
  const std::vector<std::string> begin = {"forces", "pairs",   "collide",  "islands",
                                          "colors", "prepare", "evaluate", "velocities",
                                          "bounce", "warm",    "sweep",    "positions"};
  ASSERT_GT(names.size(), begin.size());
  EXPECT_EQ(std::vector<std::string>(names.begin(), names.begin() + 12), begin);
  EXPECT_EQ(std::vector<std::string>(names.end() - 4, names.end()),
            (std::vector<std::string>{"store", "stop", "finalize", "rest"}));
  const Ran run = run_program({"run", "wall", "--ticks", "10", "--json"});
  EXPECT_EQ(trace["digest"], run.json()["digest"]);
}

TEST(TraceCommand, NamesObjectsAndFieldsOfThePhasesAskedFor) {
  const Ran ran = run_program(
      {"trace", "wall", "--tick", "10", "--phase", "sweep", "--object", "contact 7", "--objects"});
  EXPECT_EQ(ran.exit, 0) << ran.err;
  EXPECT_THAT(ran.out, ContainsRegex("^sweep, substep 0, sweep 0 +[0-9a-f]{16}\n"));
  EXPECT_THAT(ran.out, ContainsRegex("\n  contact 7 +[0-9a-f]{16}\n"));
  EXPECT_THAT(ran.out, ContainsRegex("\n    contact 7: points\\[0\\]\\.normal_impulse: "
                                     "[0-9.e-]+ \\(0x[0-9a-f]{8}\\)\n"));
  EXPECT_THAT(ran.out, testing::Not(HasSubstr("prepare")));
}

TEST(TraceCommand, IsTheSameAtEveryLaneWidthAndWorkerCount) {
  const std::vector<std::string> command = {"trace",     "ragdolls-3d", "--tick",   "40",
                                            "--objects", "--object",    "contact 3"};
  const auto with = [&](const char* lanes, const char* workers) {
    std::vector<std::string> words = command;
    words.insert(words.end(), {"--lanes", lanes, "--workers", workers});
    return run_program(words).out;
  };
  const std::string expected = run_program(command).out;
  EXPECT_THAT(expected, HasSubstr("contact 3: "));
  EXPECT_EQ(with("1", "1"), expected);
  EXPECT_EQ(with("16", "3"), expected);
  EXPECT_EQ(with("0", "1"), expected) << "0 is what it takes by itself";
}

TEST(TraceCommand, RefusesWhatIsNotThere) {
  EXPECT_EQ(run_program({"trace", "wall", "--tick", "3", "--phase", "nap"}).exit, 2);
  EXPECT_EQ(run_program({"trace", "wall", "--tick", "3", "--object", "contact 99999"}).exit, 2);
  EXPECT_EQ(run_program({"trace", "wall", "--objects"}).exit, 2);
  EXPECT_EQ(run_program({"trace", "wall", "--tick", "3", "--lanes", "5"}).exit, 2);
}

}  // namespace
}  // namespace cycloid::cli
