#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <ostream>

#include "bench/trials/expected.hpp"
#include "bench/trials/judges.hpp"
#include "bench/trials/methods.hpp"
#include "scenes/catalogue.hpp"
#include "tests/places.hpp"

namespace cycloid::scenes {

/// What a failure shows of its parameter.
static void PrintTo(const Trial& trial, std::ostream* out) {
  *out << trial.name;
}

}  // namespace cycloid::scenes

namespace cycloid::trials {

static const ExpectedTable& expected() {
  static const ExpectedTable kTable = [] {
    std::ifstream stream(places::source("bench/trials/expected.txt"));
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    ExpectedTable table;
    std::string mistake;
    EXPECT_TRUE(read_expected(text, table, mistake)) << mistake;
    return table;
  }();
  return kTable;
}

class EveryTrial : public testing::TestWithParam<scenes::Trial> {};

// A cell that changes is a change of what a method does: explain it in the commit that writes the
// table anew (`cycloid trials --write bench/trials/expected.txt`, then docs/stability.md).
TEST_P(EveryTrial, ComesToWhatTheTableSays) {
  for (const Method& method : methods()) {
    const auto found = expected().find({GetParam().name, method.name});
    ASSERT_NE(found, expected().end()) << method.name;
    EXPECT_EQ(outcome_text(judge(GetParam(), method.tuning)), found->second) << method.name;
  }
}

TEST_P(EveryTrial, IsAGoodSceneThatIsFoundByItsName) {
  const scenes::Scene scene = GetParam().make();
  EXPECT_EQ(scene.name, GetParam().name);
  EXPECT_FALSE(scene.summary.empty());
  EXPECT_TRUE(scenes::check(scene).empty());
  EXPECT_TRUE(scenes::find(GetParam().name).scene.has_value());
}

static std::string trial_test_name(const testing::TestParamInfo<scenes::Trial>& trial) {
  std::string name = trial.param.name;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, EveryTrial,
                         testing::ValuesIn(scenes::trials().begin(), scenes::trials().end()),
                         trial_test_name);

TEST(Trials, CoverEveryRowOfTheList) {
  int row = 0;
  for (const scenes::Trial& trial : scenes::trials()) {
    EXPECT_TRUE(trial.row == row || trial.row == row + 1) << trial.name;
    row = trial.row;
  }
  EXPECT_EQ(row, 35);
}

TEST(Trials, TheTableSaysNothingOfOthers) {
  std::size_t known = 0;
  for (const scenes::Trial& trial : scenes::trials())
    for (const Method& method : methods()) known += expected().count({trial.name, method.name});
  EXPECT_EQ(known, expected().size());
}

TEST(Trials, ATableThatIsNoneIsRefusedByLine) {
  ExpectedTable table;
  std::string mistake;
  EXPECT_TRUE(read_expected("# a\ntrial-a soft-step sags 0.1\n", table, mistake));
  EXPECT_EQ(table.size(), 1u);
  EXPECT_FALSE(read_expected("trial-a soft-step\n", table, mistake));
  EXPECT_EQ(mistake, "line 1: not of the form 'trial method outcome'");
  EXPECT_FALSE(read_expected("a b fails\na b stands 1\n", table, mistake));
  EXPECT_EQ(mistake, "line 2: said twice");
  EXPECT_FALSE(read_expected("a b 20 0 0 0.1 0.2\n", table, mistake)) << "a row of shares";
  EXPECT_EQ(mistake, "line 1: not of the form 'trial method outcome'");
  EXPECT_EQ(table.size(), 1u) << "a refused table changes nothing";
}

}  // namespace cycloid::trials
