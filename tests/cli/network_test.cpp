#ifdef CYCLOID_NETWORK

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <cstdlib>
#include <filesystem>

#include "tests/cli/program.hpp"
#include "tests/places.hpp"

namespace cycloid::cli {
namespace {

using testing::HasSubstr;

TEST(Demo, ServerClientsAndReplayAgree) {
  const Folder folder;
  const std::string log = folder.file("demo.cylog");
  const Ran ran = run_program({"demo", "half-pipe", "--seconds", "1.5", "--log", log, "--json"});
  ASSERT_EQ(ran.exit, 0) << ran.err << ran.out;
  const nlohmann::json report = ran.json();
  EXPECT_EQ(report["equal"], true);
  ASSERT_EQ(report["parts"].size(), 5u);
  for (const nlohmann::json& part : report["parts"]) {
    EXPECT_EQ(part["tick"], report["ticks"]) << part;
    EXPECT_EQ(part["digest"], report["parts"][0]["digest"]) << part;
  }
  EXPECT_EQ(run_program({"verify", log}).exit, 0);
}

// Meshes, hulls, joints and characters of space cross the wire and the log like any other state.
TEST(Demo, OfScenesOfSpaceAgreesToo) {
  const Folder folder;
  for (const char* scene : {"vehicle-3d", "character-course-3d"}) {
    const std::string log = folder.file(std::string(scene) + ".cylog");
    const Ran ran = run_program({"demo", scene, "--seconds", "2", "--log", log, "--json"});
    ASSERT_EQ(ran.exit, 0) << scene << ": " << ran.err;
    EXPECT_EQ(run_program({"verify", log}).exit, 0) << scene;
  }
}

TEST(Demo, ReplacesAnOlderLogAndNothingElse) {
  const Folder folder;
  const std::string file = folder.file("demo.cylog");
  run_program({"run", "half-pipe", "--ticks", "1", "--log", file});
  const Ran text = run_program({"demo", "half-pipe", "--seconds", "2", "--log", file});
  EXPECT_EQ(text.exit, 0) << text.err << text.out;
  EXPECT_THAT(text.out, HasSubstr("all equal\n"));
  write_text(file, "a letter");
  EXPECT_EQ(run_program({"demo", "half-pipe", "--seconds", "0.5", "--log", file}).exit, 2);
  EXPECT_EQ(read_text(file), "a letter");
}

/// A pipe that nobody writes to would never say what it is, nor a device where it ends.
TEST(Demo, TakesNoPipeAndNoDeviceForAnOlderLog) {
  const Folder folder;
  const std::string pipe = folder.file("pipe.cylog");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  for (const std::string& file : {pipe, std::string("/dev/null")}) {
    const Ran ran = run_program({"demo", "half-pipe", "--seconds", "0.5", "--log", file});
    EXPECT_EQ(ran.exit, 2) << file;
    EXPECT_THAT(ran.err, HasSubstr("--log: " + file + " is there and is no log"));
  }
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
}

TEST(Demo, SaysWhichPartFailed) {
  const Ran ran = run_program({"demo", "half-pipe", "--seconds", "0.5", "--log", "/nowhere/x"});
  EXPECT_EQ(ran.exit, 5) << ran.out;
  EXPECT_THAT(ran.err, HasSubstr("server ended with 5"));
}

TEST(Demo, ForeverEndsByASignalWithAllInAgreement) {
  const Folder folder;
  Background demo({"demo", "half-pipe", "--forever", "--log", folder.file("a.cylog"), "--json"});
  const std::string address = demo.wait_for("serving half-pipe on ");
  ASSERT_NE(address, "");
  const Ran visit =
      run_program({"join", address, "half-pipe", "--seat", "spectator", "--ticks", "40", "--json"});
  EXPECT_EQ(visit.exit, 0) << visit.err;
  demo.ask_to_stop();
  const Ran ran = demo.wait();
  EXPECT_EQ(ran.exit, 0) << ran.err << ran.out;
  EXPECT_EQ(ran.json()["equal"], true);
}

/// A server beside the test.
class Serve : public testing::Test {
 protected:
  Serve() : server_({"serve", "half-pipe", "--port", "0", "--json"}) {
    address_ = server_.wait_for("listening on ");
  }
  Background server_;
  std::string address_;
};

TEST_F(Serve, DrainsByASignalAndReports) {
  ASSERT_NE(address_, "");
  const Ran visit = run_program({"join", address_, "half-pipe", "--ticks", "30", "--json"});
  EXPECT_EQ(visit.exit, 0) << visit.err;
  EXPECT_EQ(visit.json()["end"], "ticks");
  EXPECT_GE(visit.json()["frames"], 30);
  server_.ask_to_stop();
  const Ran ran = server_.wait();
  EXPECT_EQ(ran.exit, 0) << ran.err;
  EXPECT_EQ(ran.json()["end"], "drained");
  EXPECT_EQ(ran.json()["clients"], 1);
}

TEST_F(Serve, AnotherSceneIsIncompatible) {
  const Ran ran = run_program({"join", address_, "stack-10"});
  EXPECT_EQ(ran.exit, 4) << ran.err;
}

TEST_F(Serve, NoSuchSeatIsUsage) {
  const Ran ran = run_program({"join", address_, "half-pipe", "--seat", "200"});
  EXPECT_EQ(ran.exit, 2) << ran.err;
}

TEST_F(Serve, PortThatIsTakenIsAnInputOutputError) {
  const std::string port = address_.substr(address_.rfind(':') + 1);
  const Ran ran = run_program({"serve", "half-pipe", "--port", port});
  EXPECT_EQ(ran.exit, 5);
  EXPECT_NE(ran.err, "");
}

/// How large a file may become that this process and its children write, while it lives.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;
  ~FileSizeLimit() { setrlimit(RLIMIT_FSIZE, &before_); }

 private:
  rlimit before_{};
};

TEST(ServeArguments, ATickRateThatWouldRoundToTheScenesIsUsage) {
  const Ran ran =
      run_program({"serve", "half-pipe", "--port", "0", "--ticks", "1", "--tick-rate", "0.0001"});
  EXPECT_EQ(ran.exit, 2);
  EXPECT_THAT(ran.err, HasSubstr("--tick-rate"));
}

/// Pipes into which nobody writes: whoever opens one to read it waits for ever.
TEST(ServeArguments, APipeInThePlaceOfAFileIsNotWaitedFor) {
  const Folder folder;
  const std::string pipe = folder.file("pipe");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const Ran itself = run_program({"serve", "--config", pipe, "--check-config"});
  EXPECT_EQ(itself.exit, 2);
  EXPECT_THAT(itself.err, HasSubstr(pipe + ": the file cannot be read"));
  write_text(folder.file("a.toml"),
             "[template.a]\nscene = \"" + pipe + "\"\n[[room]]\nname = \"a\"\ntemplate = \"a\"\n");
  const Ran scene = run_program({"serve", "--config", folder.file("a.toml"), "--check-config"});
  EXPECT_EQ(scene.exit, 2);
  EXPECT_THAT(scene.err, HasSubstr("a.toml:2: template.a.scene: "));
  EXPECT_THAT(scene.err, HasSubstr("it is no regular file"));
}

TEST(ServePipe, ThatNobodyReadsEndsNoMatch) {
  const Folder folder;
  const std::string command = "{ '" + places::program() +
                              "' serve half-pipe --port 0 --ticks 60; echo $? > '" +
                              folder.file("exit") + "'; } 2>&1 | true";
  EXPECT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(read_text(folder.file("exit")), "5\n") << "it could not print its report";
}

TEST(FileSize, OverItsLimitEndsTheLogAndNotTheMatch) {
  const Folder folder;
  const FileSizeLimit limit(16384);
  const Ran ran = run_program({"serve", "half-pipe", "--port", "0", "--ticks", "1000",
                               "--tick-rate", "1000", "--log", folder.file("a.cylog"), "--json"});
  EXPECT_EQ(ran.exit, 5) << ran.err;
  EXPECT_EQ(ran.json()["tick"], 1000);
  EXPECT_EQ(ran.json()["durable"], false);
  EXPECT_THAT(ran.err, HasSubstr("File too large"));
}

TEST(FileSize, OverItsLimitIsAnInputOutputErrorOfOtherCommandsToo) {
  const Folder folder;
  const FileSizeLimit limit(16384);
  EXPECT_EQ(
      run_program({"run", "half-pipe", "--ticks", "1000", "--log", folder.file("a.cylog")}).exit,
      5);
}

TEST(Join, BadArgumentsAreUsage) {
  EXPECT_EQ(run_program({"join", "nowhere", "half-pipe"}).exit, 2);
  EXPECT_EQ(run_program({"join", "127.0.0.1:0", "half-pipe"}).exit, 2);
  EXPECT_EQ(run_program({"join", "127.0.0.1:1", "half-pipe", "--seat", "first"}).exit, 2);
}

TEST(Join, NobodyThereIsAnInputOutputError) {
  const Ran ran = run_program({"join", "127.0.0.1:1", "half-pipe", "--json"});
  EXPECT_EQ(ran.exit, 5);
  EXPECT_EQ(ran.json()["end"], "disconnected");
}

}  // namespace
}  // namespace cycloid::cli

#endif  // CYCLOID_NETWORK
