#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <random>
#include <sstream>
#include <thread>

#include "protocol/log/records.hpp"
#include "tests/cli/logs.hpp"
#include "tests/cli/program.hpp"
#include "tests/places.hpp"

namespace cycloid::cli {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

protocol::LogSummary summary_of(const std::string& file) {
  const std::string text = read_text(file);
  return protocol::scan_log(std::as_bytes(std::span(text)));
}

/// Seats and state, as bytes; none of a log that does not begin with them.
std::string first_keyframe_of(const std::string& file) {
  const std::string text = read_text(file);
  const protocol::LogSummary log = summary_of(file);
  if (log.header.branch_tick == 0) return "";
  protocol::LogCursor cursor(std::as_bytes(std::span(text)), log.start);
  EXPECT_EQ(cursor.next(), protocol::LogCursor::Step::kKeyframe);
  EXPECT_FALSE(cursor.keyframe().seats.empty());
  protocol::Bytes bytes;
  protocol::append_keyframe(cursor.keyframe(), bytes);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// A log of 120 ticks with a state after every 20th, and the digests of all ticks.
class LogCommand : public testing::Test {
 protected:
  LogCommand() : log_(folder_.file("match.cylog")) {
    const Ran ran = run_program({"run", "half-pipe", "--ticks", "120", "--digest-every", "1",
                                 "--keyframe-every", "20", "--log", log_, "--json"});
    EXPECT_EQ(ran.exit, 0) << ran.err;
    const nlohmann::json json = ran.json();
    for (const auto& line : json["digests"]) digests_.push_back(line["digest"]);
  }
  const std::string& digest(std::uint64_t tick) const { return digests_.at(tick - 1); }
  /// Damage in the block of ticks, with good ones behind.
  void damage() {
    std::string bytes = read_text(log_);
    const protocol::LogSummary log = summary_of(log_);
    bytes[static_cast<std::size_t>(log.keyframes[2].at) + 100] ^= 1;
    write_text(log_, bytes);
  }

  Folder folder_;
  std::string log_;
  std::vector<std::string> digests_;
};

TEST_F(LogCommand, ReplayToATickIsTheSameFromAKeyframeAndFromTheStart) {
  ASSERT_EQ(summary_of(log_).keyframes.size(), 6u);
  std::mt19937_64 random(5);
  std::vector<std::uint64_t> ticks = {1, 19, 20, 21, 119, 120};
  for (int i = 0; i < 10; ++i) ticks.push_back(1 + random() % 120);
  for (const std::uint64_t tick : ticks) {
    const std::string to = std::to_string(tick);
    const Ran seek = run_program({"replay", log_, "--to", to, "--json"});
    ASSERT_EQ(seek.exit, 0) << seek.err;
    EXPECT_EQ(seek.json()["digest"], digest(tick)) << tick;
    EXPECT_EQ(seek.json()["from"], tick / 20 * 20);
    EXPECT_EQ(seek.json()["ticks"], tick % 20);
    const Ran whole = run_program({"replay", log_, "--to", to, "--from-start", "--json"});
    EXPECT_EQ(whole.json()["digest"], digest(tick)) << tick;
    EXPECT_EQ(whole.json()["ticks"], tick);
  }
  EXPECT_EQ(run_program({"replay", log_, "--to", "121"}).exit, 2);
}

TEST_F(LogCommand, ACutIsALogOfItsOwn) {
  const std::string cut = folder_.file("cut.cylog");
  struct Bounds {
    std::uint64_t from;
    std::uint64_t to;
  };
  for (const auto& [from, to] :
       {Bounds{0, 30}, Bounds{47, 63}, Bounds{60, 61}, Bounds{119, 120}, Bounds{80, 80}}) {
    const Ran ran = run_program(
        {"cut", log_, "--from", std::to_string(from), "--to", std::to_string(to), "-o", cut});
    ASSERT_EQ(ran.exit, 0) << ran.err;
    EXPECT_THAT(ran.out, HasSubstr("cycloid replay " + cut));
    const protocol::LogSummary log = summary_of(cut);
    EXPECT_EQ(log.state, protocol::LogState::kComplete) << log.reason;
    EXPECT_EQ(log.header.branch_tick, from);
    EXPECT_EQ(log.header.parent_log_id, summary_of(log_).header.log_id);
    const Ran replay = run_program({"replay", cut, "--json"});
    EXPECT_EQ(replay.exit, 0) << replay.err;
    EXPECT_EQ(replay.json()["ticks"], to - from);
    EXPECT_EQ(replay.json()["digest"], digest(to));
    EXPECT_EQ(run_program({"verify", cut}).exit, 0);
    const std::string again = folder_.file("again.cylog");
    EXPECT_EQ(run_program({"cut", cut, "-o", again}).exit, 0) << "from where it begins";
    EXPECT_EQ(summary_of(again).header.branch_tick, from);
    EXPECT_EQ(first_keyframe_of(again), first_keyframe_of(cut));
  }
  EXPECT_EQ(run_program({"cut", log_, "--from", "9", "--to", "8", "-o", cut}).exit, 2);
  const Ran nothing = run_program({"cut", log_, "--from", "120", "-o", cut});
  EXPECT_EQ(nothing.exit, 2);
  EXPECT_THAT(nothing.err, HasSubstr("--from 120: " + log_ + " has no tick behind it"));
  EXPECT_EQ(run_program({"cut", log_, "--to", "121", "-o", cut}).exit, 2);
}

/// What cannot be cut from the state is found again in the cut: the minimal case of a divergence.
TEST_F(LogCommand, ACutAroundADivergenceDivergesThere) {
  rewrite_log(log_, log_, [](protocol::Log& log) { log.ticks[69].digest = 0x1234; });
  const std::string cut = folder_.file("cut.cylog");
  ASSERT_EQ(run_program({"cut", log_, "--from", "69", "--to", "70", "-o", cut}).exit, 0);
  const Ran verify = run_program({"verify", cut});
  EXPECT_EQ(verify.exit, 1);
  EXPECT_THAT(verify.out, HasSubstr("diverged at tick 70: recorded 0000000000001234"));
  EXPECT_EQ(run_program({"cut", log_, "--from", "70", "-o", cut}).exit, 1);
}

TEST_F(LogCommand, CutsAreTracedComparedAndBisectedByTheirOwnTicks) {
  const std::string a = folder_.file("a.cylog");
  const std::string b = folder_.file("b.cylog");
  ASSERT_EQ(run_program({"cut", log_, "--from", "50", "--to", "70", "-o", a}).exit, 0);
  ASSERT_EQ(run_program({"cut", log_, "--from", "50", "--to", "70", "-o", b}).exit, 0);
  EXPECT_EQ(read_text(a), read_text(b));
  const Ran trace = run_program({"trace", a});
  EXPECT_EQ(trace.exit, 0) << trace.err;
  EXPECT_THAT(trace.out, StartsWith("50 " + digest(50) + "\n51 " + digest(51) + "\n"));
  EXPECT_THAT(run_program({"trace", a, "--tick", "60"}).out, HasSubstr("tick 60: " + digest(60)));
  EXPECT_EQ(run_program({"trace", a, "--tick", "49"}).exit, 2);
  EXPECT_EQ(run_program({"diff", a, b}).out, "equal for 20 ticks\n");
  EXPECT_EQ(run_program({"bisect", a, b}).out, "equal for 20 ticks\n");
  EXPECT_EQ(run_program({"bisect", a, "--against", places::program()}).out, "equal for 20 ticks\n");
  EXPECT_EQ(run_program({"bisect", a, "--against", places::program(), "--ticks", "10"}).out,
            "equal for 10 ticks\n");
  EXPECT_EQ(run_program({"bisect", a, log_}).exit, 2);
  EXPECT_THAT(run_program({"diff", a, log_}).out, HasSubstr("begins after tick 50"));
}

TEST_F(LogCommand, InfoSaysWhatALogIs) {
  const Ran text = run_program({"info", log_});
  EXPECT_EQ(text.exit, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("state complete\n"));
  EXPECT_THAT(text.out, HasSubstr("\nlast_tick 120\n"));
  EXPECT_THAT(text.out, HasSubstr("\nkeyframes 6\n"));
  const nlohmann::json json = run_program({"info", log_, "--json"}).json();
  EXPECT_EQ(json["scene"], "half-pipe");
  EXPECT_EQ(json["ticks"], 120);
  EXPECT_EQ(json["digest"], digest(120));
  EXPECT_EQ(json["keyframes"].size(), 6u);
  EXPECT_EQ(json["lost_bytes"], 0);
  EXPECT_EQ(json["parent_log_id"], nullptr);
  write_text(log_, read_text(log_).substr(0, read_text(log_).size() - 5));
  const Ran torn = run_program({"info", log_, "--json"});
  EXPECT_EQ(torn.exit, 3);
  EXPECT_EQ(torn.json()["state"], "torn");
}

TEST_F(LogCommand, ExportHoldsEveryTick) {
  const nlohmann::json json = run_program({"export", log_}).json();
  ASSERT_EQ(json["ticks"].size(), 120u);
  for (std::uint64_t tick = 1; tick <= 120; ++tick) {
    EXPECT_EQ(json["ticks"][tick - 1]["tick"], tick);
    EXPECT_EQ(json["ticks"][tick - 1]["digest"], digest(tick));
  }
  const std::size_t seats = json["ticks"][0]["seats"].size();
  ASSERT_GT(seats, 0u);
  const std::string file = folder_.file("match.csv");
  ASSERT_EQ(run_program({"export", log_, "--format", "csv", "-o", file}).exit, 0);
  std::istringstream lines(read_text(file));
  std::size_t rows = 0;
  std::string line;
  while (std::getline(lines, line)) {
    EXPECT_EQ(std::ranges::count(line, ','), 9) << line;
    ++rows;
  }
  EXPECT_GE(rows, 1 + 120 * seats);
  EXPECT_EQ(run_program({"export", log_, "-o", "/nowhere/x"}).exit, 5);
  EXPECT_EQ(run_program({"export", log_, "--format", "xml"}).exit, 2);
}

/// Damage in the middle is refused everywhere, and taken up to there where that is asked for.
TEST_F(LogCommand, SalvageKeepsThePrefixAndSaysWhatIsLost) {
  damage();
  const std::string out = folder_.file("out.cylog");
  const std::vector<std::vector<std::string>> commands = {
      {"replay", log_}, {"verify", log_},     {"info", log_},         {"export", log_},
      {"trace", log_},  {"diff", log_, log_}, {"bisect", log_, log_}, {"cut", log_, "-o", out}};
  for (std::vector<std::string> command : commands) {
    const Ran refused = run_program(command);
    EXPECT_EQ(refused.exit, 3) << command[0];
    EXPECT_THAT(refused.out + refused.err, HasSubstr("--salvage takes the 60 good ticks"));
    command.push_back("--salvage");
    const Ran taken = run_program(command);
    EXPECT_EQ(taken.exit, 0) << command[0] << taken.out << taken.err;
    EXPECT_THAT(taken.out + taken.err, HasSubstr("salvaged after 60 good ticks")) << command[0];
  }
  const Ran against = run_program({"bisect", log_, "--against", places::program(), "--salvage"});
  EXPECT_EQ(against.out, "equal for 60 ticks\n") << against.err;
  const Ran verify = run_program({"verify", log_, "--salvage"});
  EXPECT_THAT(verify.out, HasSubstr("salvaged after 60 good ticks: a damaged record at byte "));
  EXPECT_THAT(verify.out, HasSubstr(" are lost"));
  EXPECT_EQ(run_program({"verify", out}).exit, 0) << "the cut of what is good is whole again";
  EXPECT_EQ(summary_of(out).last_tick, 60u);
}

TEST_F(LogCommand, ATornTailIsDroppedWithItsBytesNamed) {
  const std::string bytes = read_text(log_);
  const protocol::LogSummary whole = summary_of(log_);
  write_text(log_, bytes.substr(0, static_cast<std::size_t>(whole.keyframes[3].at) + 50));
  const Ran ran = run_program({"verify", log_});
  EXPECT_EQ(ran.exit, 3);
  EXPECT_THAT(ran.out, HasSubstr("torn after 80 good ticks"));
  EXPECT_THAT(ran.out, HasSubstr("the 50 bytes behind byte " +
                                 std::to_string(whole.keyframes[3].at) + " are lost"));
  EXPECT_EQ(run_program({"verify", log_, "--salvage"}).exit, 0);
  const std::string out = folder_.file("out.cylog");
  for (const auto& command : std::vector<std::vector<std::string>>{
           {"replay", log_}, {"info", log_}, {"export", log_}, {"cut", log_, "-o", out}}) {
    EXPECT_EQ(run_program(command).exit, 3) << command[0];
  }
  for (const auto& command :
       std::vector<std::vector<std::string>>{{"trace", log_},
                                             {"trace", log_, "--tick", "80"},
                                             {"diff", log_, log_},
                                             {"bisect", log_, log_},
                                             {"bisect", log_, "--against", places::program()}}) {
    const Ran stepped = run_program(command);
    EXPECT_EQ(stepped.exit, 3) << command[0];
    EXPECT_THAT(stepped.err, HasSubstr(log_ + ": torn after 80 good ticks")) << command[0];
  }
  EXPECT_EQ(run_program({"verify", out}).exit, 0) << "and all that is good was written";
}

/// What is asked for is to take a damaged log, not one whose writer was killed.
TEST_F(LogCommand, SalvageSaysNothingOfALogThatIsOpen) {
  rewrite_log(log_, log_, [](protocol::Log& log) { log.footer.reset(); });
  EXPECT_EQ(run_program({"verify", log_, "--salvage"}).exit, 3);
  EXPECT_EQ(run_program({"verify", log_, "--allow-open"}).exit, 0);
}

/// The state that it goes on from is lost: another world would be stepped, and nothing be found.
TEST_F(LogCommand, ABranchWithoutItsStateIsNoMatch) {
  const std::string cut = folder_.file("cut.cylog");
  ASSERT_EQ(run_program({"cut", log_, "--from", "47", "--to", "63", "-o", cut}).exit, 0);
  const protocol::LogSummary log = summary_of(cut);
  write_text(cut, read_text(cut).substr(0, log.start.header_bytes));
  const std::string out = folder_.file("out.cylog");
  const std::vector<std::vector<std::string>> commands = {
      {"replay", cut}, {"trace", cut}, {"diff", cut, cut}, {"cut", cut, "-o", out}};
  for (std::vector<std::string> command : commands) {
    for (const char* salvage : {"", "--salvage"}) {
      if (*salvage != '\0') command.push_back(salvage);
      const Ran ran = run_program(command);
      EXPECT_EQ(ran.exit, 3) << command[0] << salvage;
      EXPECT_THAT(ran.err, HasSubstr("no keyframe of tick 47")) << command[0];
    }
  }
  EXPECT_EQ(run_program({"verify", cut, "--allow-open"}).exit, 3);
  EXPECT_EQ(run_program({"info", cut}).exit, 3);
}

/// A header of 200 bytes must not have memory, nor time, in proportion to what it claims.
TEST_F(LogCommand, ATickThatNoMatchComesToIsRefused) {
  std::string text = read_text(log_);
  protocol::LogHeader header = protocol::scan_log(std::as_bytes(std::span(text))).header;
  for (const std::uint64_t tick : {std::uint64_t{1} << 40, ~std::uint64_t{0}}) {
    header.branch_tick = tick;
    protocol::Bytes bytes;
    protocol::append_log_header(header, bytes);
    write_text(log_, std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
    for (const char* command : {"trace", "export", "replay", "info"}) {
      const Ran ran = run_program({command, log_});
      EXPECT_EQ(ran.exit, 3) << command << ' ' << tick;
      EXPECT_LT(ran.out.size(), 2000u) << command;
    }
  }
}

TEST_F(LogCommand, AKeyframeThatIsNotTheStateIsADivergence) {
  std::string text = read_text(log_);
  protocol::Bytes bytes;
  const protocol::Log log = protocol::read_log(std::as_bytes(std::span(text)));
  protocol::LogEncoder encoder(log.header, bytes);
  for (const protocol::LogTick& tick : log.ticks) {
    encoder.tick(tick, bytes);
    if (tick.frame.tick == 30) encoder.keyframe(tick.digest, protocol::Bytes(50), bytes);
  }
  write_bytes(log_, bytes);
  const Ran verify = run_program({"verify", log_, "--allow-open"});
  EXPECT_EQ(verify.exit, 1);
  EXPECT_THAT(verify.out, HasSubstr("diverged at tick 30: the keyframe"));
  const Ran seek = run_program({"replay", log_, "--to", "35"});
  EXPECT_EQ(seek.exit, 3);
  EXPECT_THAT(seek.err, HasSubstr("the keyframe of tick 30 holds no state"));
}

/// Header and first bytes of a log as the first format had them.
TEST_F(LogCommand, TheFirstFormatIsRefusedWithBothNumbers) {
  std::string bytes = read_text(log_);
  bytes[8] = 1;
  write_text(log_, bytes);
  for (const char* command : {"replay", "verify", "info", "trace"}) {
    const Ran ran = run_program({command, log_});
    EXPECT_EQ(ran.exit, 4) << command;
    EXPECT_THAT(ran.out + ran.err, HasSubstr("log format 1, here 2")) << command;
  }
}

TEST_F(LogCommand, OutOfTimeIsItsOwnExitCode) {
  const std::string junit = folder_.file("logs.xml");
  const Ran ran =
      run_program({"verify", log_, "--timeout", "0.000000001", "--junit", junit, "--json"});
  EXPECT_EQ(ran.exit, 124) << ran.out;
  EXPECT_THAT(ran.out, HasSubstr("out of time"));
  EXPECT_THAT(read_text(junit), HasSubstr("failure type=\"timeout\""));
}

/// One log diverges at once; the other is a pipe that says nothing until the time is over.
TEST_F(LogCommand, ADivergenceIsWorseThanRunningOutOfTime) {
  const std::string good = read_text(log_);
  rewrite_log(log_, log_, [](protocol::Log& log) { log.ticks[0].digest ^= 1; });
  const std::string pipe = folder_.file("slow.cylog");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  Background verify({"verify", log_, pipe, "--timeout", "3", "--json"});
  int reader_is_there = -1;  // Once the verdict on the first is made.
  for (int wait = 0; wait < 1000 && reader_is_there < 0; ++wait) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    reader_is_there = ::open(pipe.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC);
  }
  ASSERT_GE(reader_is_there, 0);
  std::this_thread::sleep_for(std::chrono::seconds(3));
  write_text(pipe, good);
  ::close(reader_is_there);
  const Ran ran = verify.wait();
  EXPECT_EQ(ran.exit, 1) << ran.out;
  EXPECT_THAT(ran.out, HasSubstr("out of time at tick 16 of 120"));
}

}  // namespace
}  // namespace cycloid::cli
