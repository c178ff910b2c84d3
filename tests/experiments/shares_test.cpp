#include "bench/trials/shares.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <limits>

#include "bench/trials/perturb.hpp"
#include "tests/experiments/begin_trial.hpp"
#include "tests/places.hpp"

namespace cycloid::trials {

static constexpr Outcome kStand{Verdict::kStands, 0.01, true};
static constexpr Outcome kSag{Verdict::kSags, 0.2, true};
static constexpr Outcome kFail{Verdict::kFails, 3.0, true};
static constexpr Outcome kFault{Verdict::kFails, 0.0, false};

static std::string words_of(const std::vector<Outcome>& outcomes) {
  return shares_words(shares_of(outcomes));
}

TEST(Shares, CountEveryRunAndTakeTheMedianAndTheWorst) {
  EXPECT_EQ(words_of({kStand}), "1 0 0 0.01 0.01");
  EXPECT_EQ(words_of({kFail, kStand, kStand}), "2 0 1 0.01 3");
  EXPECT_EQ(words_of({kFail, kStand, kSag, kStand, kStand}), "3 1 1 0.01 3");
  EXPECT_EQ(words_of({kStand, kSag}), "1 1 0 0.2 0.2") << "of two in the middle the worse one";
}

TEST(Shares, AFaultHasNoNumberAndIsWorseThanAny) {
  EXPECT_EQ(words_of({kFault, kStand, kStand}), "2 0 1 0.01 -");
  EXPECT_EQ(words_of({kFault, kStand, kFault}), "1 0 2 - -");
  const Outcome endless{Verdict::kFails, std::numeric_limits<double>::quiet_NaN(), true};
  EXPECT_EQ(words_of({endless, kFail}), "0 0 2 - -");
}

static const char* const kTableText =
    "runs 4 seed 18446744073709551615\n"
    "trial-stack-10 soft-step 3 1 0 0.1 0.123\n"
    "trial-stack-10 soft-loaded 4 0 0 1.05e-05 2e-05\n"
    "trial-chain-50000 soft-step 0 0 4 - -\n";

TEST(ShareTables, AreReadAsTheyWereWritten) {
  ShareTable table;
  std::string mistake;
  ASSERT_TRUE(read_shares(kTableText, table, mistake)) << mistake;
  EXPECT_EQ(table.runs, 4u);
  EXPECT_EQ(table.seed, 18446744073709551615u);
  EXPECT_EQ(table.shares.size(), 3u);
  const std::string text = shares_text(table);
  EXPECT_EQ(text.substr(text.find("runs 4")), kTableText);
  ShareTable again;
  ASSERT_TRUE(read_shares(text, again, mistake)) << mistake;
  EXPECT_EQ(again.shares, table.shares);
}

TEST(ShareTables, ThatAreNoneAreRefusedByLine) {
  const std::string row = "not of the form 'trial method stands sags fails median worst'";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "line 1: ends without 'runs N seed S'"},
      {"# only this\n", "line 2: ends without 'runs N seed S'"},
      {"a b stands 0.1\n", "line 1: not of the form 'runs N seed S'"},
      {"runs 0 seed 1\n", "line 1: not of the form 'runs N seed S'"},
      {"runs -4 seed 1\n", "line 1: not of the form 'runs N seed S'"},
      {"runs 4 seed 1 more\n", "line 1: not of the form 'runs N seed S'"},
      {"runs 4 seed 1\n\na b 4 0 0 0.1\n", "line 3: " + row},
      {"runs 4 seed 1\na b 4 0 0 0.1 0.2 0.3\n", "line 2: " + row},
      {"runs 4 seed 1\na b 5 -1 0 0.1 0.2\n", "line 2: " + row},
      {"runs 4 seed 1\na b 4 0 0 0.1 much\n", "line 2: " + row},
      {"runs 4 seed 1\na b 3 0 0 0.1 0.2\n", "line 2: 3 runs, not 4"},
      {"runs 4 seed 1\na b 4294967295 5 0 1 2\n", "line 2: 4294967300 runs, not 4"},
      {"runs 4 seed 1\na b 4 0 0 1 2\na b 4 0 0 1 2\n", "line 3: said twice"},
  };
  for (const auto& [text, expected] : cases) {
    ShareTable table{7, 7, {}};
    std::string mistake;
    EXPECT_FALSE(read_shares(text, table, mistake)) << text;
    EXPECT_EQ(mistake, expected) << text;
    EXPECT_EQ(table.runs, 7u) << "a refused table changes nothing";
  }
}

TEST(ShareTables, ShowInBoldWhatStandsInAllRuns) {
  ShareTable table;
  std::string mistake;
  ASSERT_TRUE(read_shares(kTableText, table, mistake)) << mistake;
  EXPECT_EQ(shares_markdown(table),
            "| row | trial | number | soft-step | soft-loaded |\n"
            "|---|---|---|---|---|\n"
            "| 2 | stack-10 | sunk, m | 3 / 1 / 0 0.1, 0.123 | **4 / 0 / 0** 1.05e-05, 2e-05 |\n"
            "| 11 | chain-50000 | gap, m | 0 / 0 / 4 -, - |  |\n");
}

/// What the solver's source tree says of perturbed trials.
static const ShareTable& kept() {
  static const ShareTable kKept = [] {
    std::ifstream stream(places::source("bench/trials/shares.txt"));
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    ShareTable table;
    std::string mistake;
    EXPECT_TRUE(read_shares(text, table, mistake)) << mistake;
    return table;
  }();
  return kKept;
}

TEST(KeptShares, AreOfEveryTrialUnderThreeMethods) {
  std::size_t known = 0;
  for (const scenes::Trial& trial : scenes::trials())
    for (const char* method : {"soft-step", "soft-loaded", "soft-islands"}) {
      known += kept().shares.count({trial.name, method});
      EXPECT_EQ(kept().shares.count({trial.name, method}), 1u) << trial.name;
    }
  EXPECT_EQ(known, kept().shares.size());
}

TEST(KeptShares, StandInTheDocument) {
  std::ifstream stream(places::source("docs/stability.md"));
  const std::string page{std::istreambuf_iterator<char>(stream), {}};
  EXPECT_THAT(page, testing::HasSubstr("-->\n" + shares_markdown(kept()) + "<!-- end of shares"));
}

class CheapTrial : public testing::TestWithParam<const char*> {};

// A cell that changes is a change of what the method does: explain it in the commit that writes the
// table anew (`./dev trial-shares`).
TEST_P(CheapTrial, ComesToTheSharesThatTheTableSays) {
  const scenes::Trial& trial = trial_named(GetParam());
  for (const Method& method : methods()) {
    const auto found = kept().shares.find({trial.name, method.name});
    if (found == kept().shares.end()) continue;
    std::vector<Outcome> outcomes;
    for (std::uint32_t run = 0; run < kept().runs; ++run)
      outcomes.push_back(judge_from(trial, method.tuning, {kept().seed, run}));
    EXPECT_EQ(shares_words(shares_of(outcomes)), shares_words(found->second)) << method.name;
  }
}

// The rows whose runs come to different verdicts, and others, that take at most two seconds.
INSTANTIATE_TEST_SUITE_P(Some, CheapTrial,
                         testing::Values("trial-heavy-on-light-1000", "trial-stack-20",
                                         "trial-stack-30", "trial-card-house", "trial-arch",
                                         "trial-stretched-chain", "trial-warm-start-removal",
                                         "trial-sliding-rod-forwards", "trial-pebble",
                                         "trial-substeps-change", "trial-order"));

}  // namespace cycloid::trials
