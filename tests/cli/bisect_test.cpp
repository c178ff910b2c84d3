#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/cli/logs.hpp"
#include "tests/cli/program.hpp"
#include "tests/places.hpp"

namespace cycloid::cli {
namespace {

using testing::AnyOf;
using testing::ContainsRegex;
using testing::Each;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr const char* kAValueAgainstAnother =
    "-?[0-9.e-]+ \\(0x[0-9a-f]{8}\\) against -?[0-9.e-]+ \\(0x[0-9a-f]{8}\\)\n";

class TwoLogs : public testing::Test {
 protected:
  TwoLogs() : a_(folder_.file("a.cylog")), b_(folder_.file("b.cylog")) {
    run_program({"run", "half-pipe", "--ticks", "40", "--log", a_});
  }
  Folder folder_;
  std::string a_;
  std::string b_;
};

TEST_F(TwoLogs, OfTheSameMatchAreEqual) {
  run_program({"run", "half-pipe", "--ticks", "40", "--log", b_});
  const Ran ran = run_program({"bisect", a_, b_});
  EXPECT_EQ(ran.exit, 0) << ran.err;
  EXPECT_EQ(ran.out, "equal for 40 ticks\n");
}

TEST_F(TwoLogs, OfOtherInputsPartWhereTheInputsActFirst) {
  rewrite_log(a_, b_, [](protocol::Log& log) {
    for (std::size_t i = 11; i < log.ticks.size(); ++i) {
      scenes::SeatInput& input = log.ticks[i].frame.seats[0].input;
      for (std::int16_t& axis : input.axes) axis = axis > 0 ? -32767 : 32767;
    }
  });
  const Ran ran = run_program({"bisect", a_, b_});
  EXPECT_EQ(ran.exit, 1) << ran.err;
  EXPECT_THAT(ran.out, StartsWith("inputs first differ at tick 12: seat 0: axes[0]: "));
  EXPECT_THAT(ran.out, HasSubstr("first tick that differs: 12\n"));
  EXPECT_THAT(ran.out, HasSubstr("first phase that differs: forces (after 0 equal ones)\n"));
  EXPECT_THAT(ran.out, ContainsRegex(std::string("  (body|joint) [0-9]+: [a-z_]+(\\[[0-9]\\])?: ") +
                                     kAValueAgainstAnother));
  const Ran json = run_program({"bisect", a_, b_, "--json"});
  EXPECT_EQ(json.exit, 1);
  EXPECT_EQ(json.json()["input_tick"], 12);
  EXPECT_EQ(json.json()["blame"]["tick"], 12);
  EXPECT_EQ(json.json()["blame"]["phase"], "forces");
  // And diff says the same of the same logs.
  EXPECT_THAT(run_program({"diff", a_, b_}).out, HasSubstr("phases first differ in forces: "));
}

TEST_F(TwoLogs, OfWhichOneWasRecordedElsewhereAskForTheBuildThatWroteIt) {
  rewrite_log(a_, b_, [](protocol::Log& log) { log.ticks[4].digest = 0xabc; });
  const Ran ran = run_program({"bisect", a_, b_});
  EXPECT_EQ(ran.exit, 1);
  EXPECT_THAT(ran.out, StartsWith(b_ + " was recorded by another build, or is damaged: at tick 5 "
                                       "it says 0000000000000abc"));
  EXPECT_THAT(ran.out, HasSubstr("cycloid bisect " + b_ + " --against PROGRAM"));
}

TEST_F(TwoLogs, ThatStopSteppingAreNotEqualAndNoDigestIsMadeUp) {
  rewrite_log(a_, a_, [](protocol::Log& log) { add_seat(9, log); });
  const Ran ran = run_program({"bisect", a_, a_});
  EXPECT_EQ(ran.exit, 1);
  EXPECT_THAT(ran.out, StartsWith("neither steps to tick 9: invalid inputs\n"));
  EXPECT_THAT(ran.out, HasSubstr(", this program cannot make it: invalid inputs; "));
  EXPECT_THAT(ran.out, Not(HasSubstr("this program makes")));
  const Ran builds = run_program({"bisect", a_, "--against", places::program(), "--json"});
  EXPECT_EQ(builds.exit, 1);
  EXPECT_EQ(builds.json()["ticks"], 8);
  EXPECT_THAT(builds.json()["notes"][0].get<std::string>(), StartsWith("neither steps to tick 9"));
}

TEST_F(TwoLogs, OfOtherLengthsAreNotEqual) {
  run_program({"run", "half-pipe", "--ticks", "20", "--log", b_});
  const Ran ran = run_program({"bisect", a_, b_});
  EXPECT_EQ(ran.exit, 1);
  EXPECT_THAT(ran.out, HasSubstr("has 40 ticks"));
}

TEST(Bisect, OfABuildAgainstItselfIsEqual) {
  const Ran ran =
      run_program({"bisect", "card-house", "--against", places::program(), "--ticks", "30"});
  EXPECT_EQ(ran.exit, 0) << ran.err;
  EXPECT_EQ(ran.out, "equal for 30 ticks\n");
}

/// A log is longer than what a scene is stepped to, and all of it is asked about.
TEST(Bisect, OfALogGoesToItsEnd) {
  const Folder folder;
  const std::string log = folder.file("long.cylog");
  run_program({"run", "half-pipe", "--ticks", "620", "--log", log});
  const std::vector<std::string> command = {"bisect", log, "--against", places::program()};
  EXPECT_EQ(run_program(command).out, "equal for 620 ticks\n");
  std::vector<std::string> with_ticks = command;
  with_ticks.insert(with_ticks.end(), {"--ticks", "18446744073709551615"});
  EXPECT_EQ(run_program(with_ticks).out, "equal for 620 ticks\n");
  with_ticks.back() = "5";
  EXPECT_EQ(run_program(with_ticks).out, "equal for 5 ticks\n");
  const std::string trace = run_program({"trace", log}).out;
  EXPECT_EQ(std::ranges::count(trace, '\n'), 621);
}

/// So many ticks after its beginning are more than there are numbers.
TEST(Bisect, OfACutGoesNoFurtherThanItsEndWhateverIsAskedFor) {
  const Folder folder;
  const std::string log = folder.file("match.cylog");
  const std::string cut = folder.file("cut.cylog");
  run_program({"run", "half-pipe", "--ticks", "9", "--log", log});
  ASSERT_EQ(run_program({"cut", log, "--from", "5", "-o", cut}).exit, 0);
  const Ran ran = run_program(
      {"bisect", cut, "--against", places::program(), "--ticks", "18446744073709551615"});
  EXPECT_EQ(ran.out, "equal for 4 ticks\n") << ran.err;
}

TEST(Bisect, RunsTheOtherBuildByItsRunner) {
  const Ran ran = run_program({"bisect", "card-house", "--against", places::program(), "--runner",
                               "env CYCLOID_SOME_VARIABLE=1", "--ticks", "5"});
  EXPECT_EQ(ran.exit, 0) << ran.err;
}

TEST(Bisect, NeedsTwoSidesAndAProgramThatRuns) {
  EXPECT_EQ(run_program({"bisect", "card-house"}).exit, 2);
  EXPECT_EQ(run_program({"bisect", "card-house", "wall"}).exit, 2);
  const Ran gone = run_program({"bisect", "card-house", "--against", "/nowhere/cycloid"});
  EXPECT_EQ(gone.exit, 5);
  EXPECT_THAT(gone.err, HasSubstr("/nowhere/cycloid: trace card-house ended with 127"));
  const Ran silent = run_program({"bisect", "card-house", "--against", "true"});
  EXPECT_EQ(silent.exit, 5);
  EXPECT_THAT(silent.err, HasSubstr("true: trace: not lines of 'tick digest'"));
}

/// Builds with one fused multiply-add (tests/determinism/wrong_rounding), and scenes that reach it.
class WrongFriction : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Scenes, WrongFriction,
                         testing::Values("pyramid-20", "card-house", "stack-10-3d", "ragdolls-3d"),
                         [](const auto& scene) {
                           std::string name = scene.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST_P(WrongFriction, IsNamedByPhaseContactAndTangentImpulse) {
  const std::vector<std::string> command = {
      "bisect", GetParam(), "--against", places::wrong_friction_program(), "--ticks", "100"};
  const Ran ran = run_program(command);
  EXPECT_EQ(ran.exit, 1) << ran.err;
  EXPECT_THAT(ran.out, StartsWith("first tick that differs: "));
  EXPECT_THAT(ran.out,
              ContainsRegex("first phase that differs: (sweep|relax), substep [0-9]+, sweep "));
  EXPECT_THAT(ran.out, ContainsRegex("first object that differs: contact [0-9]+"));
  EXPECT_THAT(ran.out, ContainsRegex(std::string("  contact [0-9]+: points\\[[0-9]\\]\\.") +
                                     "tangent_impulse(\\[[01]\\])?: " + kAValueAgainstAnother));

  std::vector<std::string> with_json = command;
  with_json.push_back("--json");
  const nlohmann::json blame = run_program(with_json).json()["blame"];
  EXPECT_THAT(blame["phase"], AnyOf("sweep", "relax"));
  // The row's own impulse is named before what follows from it, and nothing that was there before.
  EXPECT_THAT(blame["fields"][0]["field"].get<std::string>(), HasSubstr("tangent_impulse"));
  EXPECT_THAT(blame["objects"].get<std::vector<std::string>>(),
              Each(AnyOf(StartsWith("contact "), StartsWith("body "))));
  // The tick before, both builds are the same.
  const std::string tick = std::to_string(blame["tick"].get<int>() - 1);
  EXPECT_EQ(run_program({"bisect", GetParam(), "--against", places::wrong_friction_program(),
                         "--ticks", tick})
                .exit,
            0);
}

/// The digest of a scene at a tick as a build makes it.
std::string digest_by(const std::string& program, const std::string& scene, int tick) {
  const Ran ran = run_other(
      program, {"run", scene, "--ticks", std::to_string(tick), "--digest-every", "0", "--json"});
  return ran.json()["digest"].get<std::string>();
}

TEST_P(WrongFriction, IsNoticedByTheGoldens) {
  const std::string goldens = read_text(places::source("tests/determinism/goldens.txt"));
  EXPECT_THAT(goldens, HasSubstr(digest_by(places::program(), GetParam(), 100)));
  EXPECT_THAT(goldens,
              Not(HasSubstr(digest_by(places::wrong_friction_program(), GetParam(), 100))));
}

TEST(WrongVelocity, IsNamedByPhaseAndBody) {
  const Ran ran = run_program({"bisect", "wall", "--against", places::wrong_velocity_program(),
                               "--ticks", "100", "--json"});
  EXPECT_EQ(ran.exit, 1) << ran.err;
  const nlohmann::json blame = ran.json()["blame"];
  EXPECT_EQ(blame["phase"], "velocities");
  EXPECT_THAT(blame["object"].get<std::string>(), StartsWith("body "));
  EXPECT_THAT(blame["fields"][0]["field"].get<std::string>(), StartsWith("velocity["));
  EXPECT_THAT(read_text(places::source("tests/determinism/goldens.txt")),
              Not(HasSubstr(digest_by(places::wrong_velocity_program(), "wall", 100))));
}

TEST(WrongFrictionLog, OfAnotherBuildIsBisectedByRunningThatBuild) {
  const Folder folder;
  const std::string log = folder.file("wrong.cylog");
  ASSERT_EQ(
      run_other(places::wrong_friction_program(), {"run", "wall", "--ticks", "100", "--log", log})
          .exit,
      0);
  EXPECT_EQ(run_program({"verify", log}).exit, 1);
  const Ran ran = run_program({"bisect", log, "--against", places::wrong_friction_program()});
  EXPECT_EQ(ran.exit, 1) << ran.err;
  EXPECT_THAT(ran.out, ContainsRegex("points\\[[0-9]\\]\\.tangent_impulse(\\[[0-9]\\])?: "));
  EXPECT_THAT(ran.out, HasSubstr(", as by " + places::wrong_friction_program()));
}

}  // namespace
}  // namespace cycloid::cli
