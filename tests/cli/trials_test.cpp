#ifdef CYCLOID_EXPERIMENTS
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/program.hpp"
#include "tests/places.hpp"

namespace cycloid::cli {
namespace {

using testing::HasSubstr;

const std::string kOutcomes = places::source("bench/trials/expected.txt");
const std::string kShares = places::source("bench/trials/shares.txt");

/// Five runs of a cheap trial under the default method, and more words.
Ran perturb(const std::vector<std::string>& more) {
  std::vector<std::string> words = {"trials",      "heavy-on-light-10", "--method",
                                    "soft-loaded", "--perturb",         "5"};
  words.insert(words.end(), more.begin(), more.end());
  return run_program(words);
}

TEST(PerturbedTrials, SayTheSameUnderOneSeedHoweverManyRunAtOnce) {
  const Ran one = perturb({});
  ASSERT_EQ(one.exit, 0) << one.err;
  EXPECT_THAT(one.out, HasSubstr("5 runs each, seed 1"));
  EXPECT_THAT(one.out, HasSubstr("1 trial-heavy-on-light-10: sunk, m\n"));
  EXPECT_EQ(perturb({"--jobs", "3"}).out, one.out);
  EXPECT_EQ(perturb({"--seed", "1"}).out, one.out);
  EXPECT_NE(perturb({"--seed", "2"}).out, one.out);
}

TEST(PerturbedTrials, CountEveryRun) {
  const Ran ran = perturb({"--json"});
  ASSERT_EQ(ran.exit, 0) << ran.err;
  EXPECT_EQ(ran.json()["runs"], 5);
  EXPECT_EQ(ran.json()["seed"], 1);
  ASSERT_EQ(ran.json()["shares"].size(), 1u);
  const nlohmann::json row = ran.json()["shares"][0];
  EXPECT_EQ(row["trial"], "trial-heavy-on-light-10");
  EXPECT_EQ(row["method"], "soft-loaded");
  EXPECT_EQ(row["stands"].get<int>() + row["sags"].get<int>() + row["fails"].get<int>(), 5);
  EXPECT_LE(row["median"].get<double>(), row["worst"].get<double>());
}

TEST(Trials, ShowATableOfTheMethodsThatRan) {
  const Ran ran =
      run_program({"trials", "heavy-on-light-10", "--method", "soft-loaded", "--markdown"});
  ASSERT_EQ(ran.exit, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("| row | trial | number | soft-loaded |\n|---|---|---|---|\n"));
  EXPECT_THAT(ran.out, HasSubstr("| 1 | heavy-on-light-10 | sunk, m | **"));
}

TEST(Trials, PrintATableOrAnObject) {
  const Ran ran = run_program({"trials", "heavy-on-light-10", "--json", "--markdown"});
  EXPECT_EQ(ran.exit, 2);
  EXPECT_THAT(ran.json()["error"].get<std::string>(), HasSubstr("--json and --markdown"));
}

TEST(PerturbedTrials, ShowATableOfTheMethodsThatRan) {
  const Ran ran = perturb({"--markdown"});
  ASSERT_EQ(ran.exit, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("| row | trial | number | soft-loaded |\n|---|---|---|---|\n"));
  EXPECT_THAT(ran.out, HasSubstr("| 1 | heavy-on-light-10 | sunk, m | **5 / 0 / 0** "));
}

TEST(PerturbedTrials, WriteSharesAndCompareWithThem) {
  const Folder folder;
  const std::string file = folder.file("shares.txt");
  ASSERT_EQ(perturb({"--write", file}).exit, 0);
  EXPECT_EQ(perturb({"--check", file}).exit, 0);
  std::string text = read_text(file);
  ASSERT_NE(text.find(" 5 0 0 "), std::string::npos) << text;
  text.replace(text.find(" 5 0 0 "), 7, " 4 1 0 ");
  write_text(file, text);
  const Ran ran = perturb({"--check", file});
  EXPECT_EQ(ran.exit, 1);
  EXPECT_THAT(ran.err, HasSubstr("trial-heavy-on-light-10 under soft-loaded: 5 0 0 "));
  EXPECT_THAT(ran.err, HasSubstr(", expected 4 1 0 "));
  ASSERT_EQ(perturb({"--write", file}).exit, 0);
  EXPECT_EQ(perturb({"--check", file}).exit, 0);
}

TEST(PerturbedTrials, RefuseWhatTheyCannotDo) {
  struct Case {
    std::vector<std::string> arguments;
    std::string words;
  };
  const Case cases[] = {
      {{"--perturb", "0"}, "--perturb"},
      {{"--perturb", "-3"}, "--perturb"},
      {{"--perturb", "100001"}, "--perturb"},
      {{"--perturb", "often"}, "--perturb"},
      {{"--perturb"}, "--perturb"},
      {{"--perturb", "5", "--seed", "-1"}, "--seed"},
      {{"--perturb", "5", "--seed", "x"}, "--seed"},
      {{"--perturb", "5", "--jobs", "0"}, "--jobs"},
      {{"--seed", "1"}, "--seed requires --perturb"},
      {{"--jobs", "2"}, "--jobs requires --perturb"},
      {{"--perturb", "5", "--method", "luck"}, "there is no method 'luck'"},
      {{"--perturb", "5", "no-such-trial"}, "there is no trial 'no-such-trial'"},
      {{"--perturb", "5", "--check", kOutcomes}, "is a table of single outcomes"},
      {{"--perturb", "5", "--write", kOutcomes}, "is a table of single outcomes"},
      {{"--check", kShares}, "--check: " + kShares + ": is a table"},
      {{"--write", kShares}, "is a table of shares; say --perturb 20"},
      {{"--perturb", "5", "--check", kShares}, "says --perturb 20 --seed 1"},
      {{"--perturb", "20", "--seed", "2", "--check", kShares}, "says --perturb 20 --seed 1"},
  };
  const std::string outcomes = read_text(kOutcomes);
  const std::string shares = read_text(kShares);
  for (const Case& wrong : cases) {
    std::vector<std::string> words = {"trials", "heavy-on-light-10"};
    words.insert(words.end(), wrong.arguments.begin(), wrong.arguments.end());
    const Ran ran = run_program(words);
    EXPECT_EQ(ran.exit, 2) << wrong.words << ran.err;
    EXPECT_THAT(ran.err, HasSubstr(wrong.words));
    EXPECT_EQ(ran.out, "") << wrong.words;
  }
  EXPECT_EQ(read_text(kOutcomes), outcomes) << "a refused --write leaves the file as it is";
  EXPECT_EQ(read_text(kShares), shares);
}

TEST(PerturbedTrials, NameTheLineThatIsWrong) {
  const Folder folder;
  const std::string file = folder.file("shares.txt");
  write_text(file, "runs 5 seed 1\na b 5 0 0 1 2\na b 3 1 0 1 2\n");
  const Ran ran = perturb({"--check", file});
  EXPECT_EQ(ran.exit, 2);
  EXPECT_THAT(ran.err, HasSubstr("--check: " + file + ": line 3: 4 runs, not 5"));
}

}  // namespace
}  // namespace cycloid::cli
#endif
