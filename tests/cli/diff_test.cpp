#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/logs.hpp"
#include "tests/cli/program.hpp"

namespace cycloid::cli {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::StartsWith;

TEST(Diff, EqualScenesAreEqual) {
  const Ran ran = run_program({"diff", "half-pipe", "half-pipe", "--ticks", "30"});
  EXPECT_EQ(ran.exit, 0) << ran.err;
  EXPECT_EQ(ran.out, "equal for 30 ticks\n");
}

/// The first number found under a key of that name, to be changed.
nlohmann::json* find_number(nlohmann::json& value, const std::string& key) {
  for (auto& [name, child] : value.items()) {
    if (value.is_object() && name == key && child.is_array() && child[0].is_number()) {
      return &child[0];
    }
    if (!child.is_structured()) continue;
    if (nlohmann::json* found = find_number(child, key)) return found;
  }
  return nullptr;
}

TEST(Diff, NamesTickBodyFieldAndBothValuesOfAChangedScene) {
  const Folder folder;
  nlohmann::json scene = nlohmann::json::parse(run_program({"scene", "export", "half-pipe"}).out);
  write_text(folder.file("a.json"), scene.dump());
  nlohmann::json* x = find_number(scene["bodies"], "position");
  ASSERT_NE(x, nullptr);
  *x = x->get<double>() + 0.25;
  write_text(folder.file("b.json"), scene.dump());
  const Ran ran = run_program({"diff", folder.file("a.json"), folder.file("b.json")});
  EXPECT_EQ(ran.exit, 1) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("states first differ at tick 0\n"));
  EXPECT_THAT(ran.out, ContainsRegex("  body [0-9]+: position\\[0\\]: .* \\(0x[0-9a-f]{8}\\) "
                                     "against .* \\(0x[0-9a-f]{8}\\)\n"));
}

/// Two logs of one scene, where seat 0 says something else from tick 12 on in the second.
class DiffLogs : public testing::Test {
 protected:
  DiffLogs() : a_(folder_.file("a.cylog")), b_(folder_.file("b.cylog")) {
    run_program({"run", "half-pipe", "--ticks", "40", "--log", a_});
  }
  Folder folder_;
  std::string a_;
  std::string b_;
};

TEST_F(DiffLogs, NamesTheSeatWhoseInputDiffersFirstAndThenTheState) {
  rewrite_log(a_, b_, [](protocol::Log& log) {
    for (std::size_t i = 11; i < log.ticks.size(); ++i) {
      scenes::SeatInput& input = log.ticks[i].frame.seats[0].input;
      for (std::int16_t& axis : input.axes) axis = axis > 0 ? -32767 : 32767;
    }
  });
  const Ran ran = run_program({"diff", a_, b_});
  EXPECT_EQ(ran.exit, 1);
  EXPECT_THAT(ran.out, StartsWith("inputs first differ at tick 12: seat 0: axes[0]: "));
  EXPECT_THAT(ran.out, HasSubstr("states first differ at tick 12\n"));
  const Ran json = run_program({"diff", a_, b_, "--json"});
  EXPECT_EQ(json.json()["input_tick"], 12);
  EXPECT_EQ(json.json()["state_tick"], 12);
  EXPECT_GE(json.json()["fields"].size(), 1u);
}

TEST_F(DiffLogs, LogEqualsItsSceneAndAnotherLengthIsADifference) {
  EXPECT_EQ(run_program({"diff", a_, "half-pipe"}).out, "equal for 40 ticks\n");
  run_program({"run", "half-pipe", "--ticks", "20", "--log", b_});
  const Ran ran = run_program({"diff", a_, b_});
  EXPECT_EQ(ran.exit, 1);
  EXPECT_THAT(ran.out, HasSubstr("has 40 ticks"));
}

/// That both are bad in the same way is no reason to call them equal, nor to look no further.
TEST_F(DiffLogs, ThatBothStopSteppingIsSaidWithWhatDiffersBehind) {
  rewrite_log(a_, a_, [](protocol::Log& log) { add_seat(9, log); });
  const Ran same = run_program({"diff", a_, a_});
  EXPECT_EQ(same.exit, 1);
  EXPECT_EQ(same.out, "neither steps to tick 9: invalid inputs\n");
  EXPECT_EQ(run_program({"diff", a_, a_, "--json"}).json()["ticks"], 8);
  rewrite_log(a_, b_, [](protocol::Log& log) {
    log.ticks.resize(30);
    log.ticks[19].digest = 0xabc;
    log.ticks[24].frame.seats[0].input.buttons ^= 1;
    log.footer->ticks = 30;
    log.footer->digest = log.ticks.back().digest;
  });
  const Ran other = run_program({"diff", a_, b_});
  EXPECT_EQ(other.exit, 1);
  EXPECT_THAT(other.out, StartsWith("inputs first differ at tick 25: seat 0: buttons: "));
  EXPECT_THAT(other.out, HasSubstr("neither steps to tick 9: "));
  EXPECT_THAT(other.out, HasSubstr("; recorded digests differ at tick 20: "));
  EXPECT_THAT(other.out, HasSubstr(" has 40 ticks, " + b_ + " has 30"));
}

TEST_F(DiffLogs, UnlikeRecordedDigestsOfLikeFramesAreADifference) {
  rewrite_log(a_, b_, [](protocol::Log& log) { log.ticks[4].digest = 0xabc; });
  const Ran ran = run_program({"diff", a_, b_});
  EXPECT_EQ(ran.exit, 1);
  EXPECT_THAT(ran.out, HasSubstr("recorded digests differ at tick 5"));
  EXPECT_THAT(ran.out, HasSubstr("0000000000000abc"));
}

}  // namespace
}  // namespace cycloid::cli
