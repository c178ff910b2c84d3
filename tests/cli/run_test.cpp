#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/logs.hpp"
#include "tests/cli/program.hpp"

namespace cycloid::cli {
namespace {

using testing::HasSubstr;
using testing::MatchesRegex;
using testing::StartsWith;

TEST(Run, PrintsTickAndDigestTheSameEveryTimeForAnyWorkerCount) {
  const Ran first = run_program({"run", "half-pipe", "--ticks", "30", "--digest-every", "10"});
  ASSERT_EQ(first.exit, 0) << first.err;
  EXPECT_THAT(first.out, MatchesRegex("10 [0-9a-f]+\n20 [0-9a-f]+\n30 [0-9a-f]+\n"));
  EXPECT_EQ(first.out.size(), 3u * 20u);
  EXPECT_EQ(first.err, "");
  const Ran second =
      run_program({"run", "half-pipe", "--ticks", "30", "--digest-every", "10", "--workers", "3"});
  EXPECT_EQ(second.out, first.out);
}

TEST(Run, ReplayAndVerifyTakeAnyLaneWidthAndNoOther) {
  const Folder folder;
  const std::string log = folder.file("a.cylog");
  const Ran first = run_program({"run", "pyramid-3d", "--ticks", "9", "--log", log});
  ASSERT_EQ(first.exit, 0) << first.err;
  for (const char* lanes : {"1", "8", "16"}) {
    EXPECT_EQ(run_program({"run", "pyramid-3d", "--ticks", "9", "--lanes", lanes}).out, first.out);
    EXPECT_EQ(run_program({"replay", log, "--lanes", lanes}).exit, 0);
    EXPECT_EQ(run_program({"verify", log, "--lanes", lanes}).exit, 0);
  }
  for (const char* command : {"run", "replay", "verify"}) {
    const Ran bad = run_program({command, log, "--lanes", "3"});
    EXPECT_EQ(bad.exit, 2);
    EXPECT_THAT(bad.err, HasSubstr("--lanes"));
  }
}

TEST(Run, JsonHasTheSameDigests) {
  const Ran text = run_program({"run", "half-pipe", "--ticks", "20", "--digest-every", "10"});
  const Ran json =
      run_program({"run", "half-pipe", "--ticks", "20", "--digest-every", "10", "--json"});
  ASSERT_EQ(json.exit, 0) << json.err;
  const nlohmann::json object = json.json();
  EXPECT_EQ(object["exit"], 0);
  EXPECT_EQ(object["ticks"], 20);
  ASSERT_EQ(object["digests"].size(), 2u);
  EXPECT_THAT(text.out, HasSubstr("20 " + object["digest"].get<std::string>() + "\n"));
}

TEST(Run, LogReplaysAndVerifies) {
  const Folder folder;
  const std::string log = folder.file("a.cylog");
  const Ran run = run_program({"run", "half-pipe", "--ticks", "60", "--log", log, "--json"});
  ASSERT_EQ(run.exit, 0) << run.err;
  const Ran replay = run_program({"replay", log, "--json"});
  EXPECT_EQ(replay.exit, 0) << replay.err;
  EXPECT_EQ(replay.json()["digest"], run.json()["digest"]);
  EXPECT_EQ(replay.json()["ticks"], 60);
  const Ran part = run_program({"replay", log, "--to", "7", "--json"});
  EXPECT_EQ(part.json()["ticks"], 7);

  const Ran file = run_program({"verify", log});
  EXPECT_EQ(file.exit, 0) << file.out;
  const Ran whole = run_program({"verify", folder.path()});
  EXPECT_EQ(whole.exit, 0) << whole.out;
  EXPECT_EQ(whole.out, log + ": good, 60 ticks\n1 of 1 logs good, 60 ticks replayed\n");
}

TEST(Run, ReplacesALogThatIsThereAndSaysSoInItsHelp) {
  const Folder folder;
  write_text(folder.file("a.cylog"), std::string(100'000, 'x'));
  ASSERT_EQ(run_program({"run", "beads", "--ticks", "9", "--log", folder.file("a.cylog")}).exit, 0);
  EXPECT_EQ(run_program({"verify", folder.file("a.cylog")}).exit, 0);
  EXPECT_THAT(run_program({"run", "--help"}).out, HasSubstr("one that is there is replaced"));
}

TEST(Run, WritesTheSameLogEveryTime) {
  const Folder folder;
  for (const char* name : {"a.cylog", "b.cylog"}) {
    ASSERT_EQ(run_program({"run", "half-pipe", "--ticks", "9", "--log", folder.file(name)}).exit,
              0);
  }
  EXPECT_EQ(read_text(folder.file("a.cylog")), read_text(folder.file("b.cylog")));
}

/// A good log of 40 ticks to spoil.
class BadLog : public testing::Test {
 protected:
  BadLog() : good_(folder_.file("good.cylog")), bad_(folder_.file("bad.cylog")) {
    run_program({"run", "half-pipe", "--ticks", "40", "--log", good_});
  }
  void expect(int exit, const std::string& words) {
    for (const char* command : {"replay", "verify"}) {
      const Ran ran = run_program({command, bad_});
      EXPECT_EQ(ran.exit, exit) << command << ran.out << ran.err;
      EXPECT_THAT(ran.out + ran.err, HasSubstr(words)) << command;
      EXPECT_THAT(ran.out + ran.err, HasSubstr(bad_)) << command;
      const Ran json = run_program({command, bad_, "--json"});
      EXPECT_EQ(json.json()["exit"], exit) << command;
    }
  }

  Folder folder_;
  std::string good_;
  std::string bad_;
};

TEST_F(BadLog, AnyFlippedBitIsCorrupt) {
  const std::string bytes = read_text(good_);
  ASSERT_GT(bytes.size(), 100u);
  for (const std::size_t at :
       {std::size_t{0}, std::size_t{40}, bytes.size() / 2, bytes.size() - 3}) {
    std::string flipped = bytes;
    flipped[at] = static_cast<char>(flipped[at] ^ 4);
    write_text(bad_, flipped);
    const Ran ran = run_program({"verify", bad_});
    EXPECT_TRUE(ran.exit == 3 || (at < 16 && ran.exit == 4)) << at << ": " << ran.exit << ran.out;
  }
}

TEST_F(BadLog, FlippedBitInTheMiddleIsNamed) {
  std::string bytes = read_text(good_);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  write_text(bad_, bytes);
  expect(3, "corrupt");
}

TEST_F(BadLog, CutLogIsTorn) {
  const std::string bytes = read_text(good_);
  write_text(bad_, bytes.substr(0, bytes.size() - 5));
  expect(3, "torn");
}

TEST_F(BadLog, OpenLogReplaysAndVerifiesOnlyWhenAllowed) {
  rewrite_log(good_, bad_, [](protocol::Log& log) { log.footer.reset(); });
  EXPECT_EQ(run_program({"replay", bad_}).exit, 0);
  EXPECT_EQ(run_program({"verify", bad_}).exit, 3);
  EXPECT_EQ(run_program({"verify", "--allow-open", bad_}).exit, 0);
}

TEST_F(BadLog, OtherSolverVersionIsIncompatible) {
  rewrite_log(good_, bad_, [](protocol::Log& log) { log.header.solver_version += 1; });
  expect(4, "incompatible");
}

TEST_F(BadLog, DivergentDigestIsNamedByTickWithBothValues) {
  rewrite_log(good_, bad_, [](protocol::Log& log) { log.ticks[16].digest = 0x1234; });
  expect(1, "diverged at tick 17: recorded 0000000000001234, replayed ");
}

TEST_F(BadLog, ChangedInputDiverges) {
  rewrite_log(good_, bad_, [](protocol::Log& log) {
    for (protocol::LogTick& tick : log.ticks) {
      for (protocol::SeatFrame& seat : tick.frame.seats) seat.input.axes.fill(-32767);
    }
  });
  expect(1, "diverged at tick ");
}

TEST_F(BadLog, OneBadLogDoesNotHideTheOthers) {
  rewrite_log(good_, bad_, [](protocol::Log& log) { log.ticks[0].digest ^= 1; });
  const Ran ran = run_program({"verify", folder_.path()});
  EXPECT_EQ(ran.exit, 1);
  EXPECT_THAT(ran.out, StartsWith(bad_ + ": diverged at tick 1"));
  EXPECT_THAT(ran.out, HasSubstr(good_ + ": good, 40 ticks\n1 of 2 logs good"));
}

TEST(Missing, FileIsAnInputOutputError) {
  for (const char* command : {"replay", "verify"}) {
    const Ran ran = run_program({command, "/nowhere/a.cylog"});
    EXPECT_EQ(ran.exit, 5) << command;
    EXPECT_THAT(ran.out + ran.err, HasSubstr("/nowhere/a.cylog")) << command;
  }
  EXPECT_EQ(run_program({"run", "half-pipe", "--ticks", "1", "--log", "/nowhere/x"}).exit, 5);
}

TEST(Missing, FolderWithoutALogFailsVerify) {
  const Folder folder;
  const Ran ran = run_program({"verify", folder.path()});
  EXPECT_EQ(ran.exit, 5);
  EXPECT_THAT(ran.err, HasSubstr("no log"));
}

}  // namespace
}  // namespace cycloid::cli
