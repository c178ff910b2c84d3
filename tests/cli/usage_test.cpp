#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/program.hpp"

namespace cycloid::cli {
namespace {

using testing::HasSubstr;

TEST(Usage, BadCommandLinesExitWithTwoAndNameTheWord) {
  struct Case {
    std::vector<std::string> arguments;
    const char* words;
  };
  const Case cases[] = {
      {{}, "subcommand"},
      {{"dance"}, "dance"},
      {{"run"}, "SCENE"},
      {{"run", "half-pipe", "--ticks", "many"}, "--ticks"},
      {{"run", "half-pipe", "--ticks", "0"}, "--ticks"},
      {{"run", "half-pipe", "--workers", "65"}, "--workers"},
      {{"run", "no-such-scene"}, "no-such-scene"},
      {{"replay"}, "LOG"},
      {{"verify"}, "LOG"},
      {{"diff", "half-pipe"}, "B"},
      {{"scene"}, "subcommand"},
      {{"scene", "check"}, "FILE"},
      {{"scene", "export", "no-such-scene"}, "no-such-scene"},
  };
  for (const Case& wrong : cases) {
    const Ran ran = run_program(wrong.arguments);
    EXPECT_EQ(ran.exit, 2) << wrong.words << ran.err;
    EXPECT_THAT(ran.err, HasSubstr(wrong.words));
    EXPECT_EQ(ran.out, "") << wrong.words;
  }
}

TEST(Usage, NumbersThatAnOptionCannotHoldAreRefused) {
  struct Case {
    std::vector<std::string> arguments;
    std::string words;
  };
  const std::vector<Case> cases = {
      {{"run", "half-pipe", "--ticks", "-1"}, "--ticks: '-1' is no whole number"},
      {{"run", "half-pipe", "--ticks", "0"}, "--ticks: '0' is not above 0"},
      {{"run", "half-pipe", "--ticks", "99999999999999999999"}, "is too large"},
      {{"run", "half-pipe", "--ticks", "1.5"}, "--ticks: '1.5' is no whole number"},
      {{"run", "half-pipe", "--digest-every", "-1"}, "--digest-every: '-1' is"},
      {{"run", "half-pipe", "--keyframe-every", " -1"}, "--keyframe-every: ' -1' is"},
      {{"run", "half-pipe", "--workers", "99"}, "--workers: Value 99 not in range 1 to 64"},
      {{"run", "half-pipe", "--lanes", "99999999999"}, "'99999999999' not in {0,1,4,8,16}"},
      {{"diff", "half-pipe", "half-pipe", "--ticks", "-1"}, "--ticks: '-1' is"},
      {{"trace", "half-pipe", "--tick", "-1"}, "--tick: '-1' is"},
      {{"cut", "a.cylog", "-o", "b.cylog", "--from", "-1"}, "--from: '-1' is"},
      {{"golden", "make", "half-pipe", "--at", "1,-2"}, "--at: '-2' is"},
      {{"verify", "a.cylog", "--timeout", "nan"}, "--timeout: 'nan' is no number"},
      {{"verify", "a.cylog", "--timeout", "-1"}, "--timeout: '-1' is not above 0"},
      {{"verify", "a.cylog", "--timeout", "inf"}, "--timeout: 'inf' is no number"},
#ifdef CYCLOID_NETWORK
      {{"serve", "half-pipe", "--port", "99999"}, "--port: Value 99999 not in range 0 to 65535"},
      {{"join", "a:1", "half-pipe", "--reconnect", "4294967296"}, "not in range 0 to 4294967295"},
      {{"token", "make", "--seat", "99999999999"},
       "--seat: Value 99999999999 not in range -1 to 255"},
      {{"serve", "half-pipe", "--address", "foo"}, "--address: \"foo\" is no IP address"},
      {{"serve", "half-pipe", "--config", ""}, "--config: is no name of a file"},
      {{"serve", "half-pipe", "--tick-rate", "nan"}, "--tick-rate: 'nan' is no number"},
      {{"serve", "half-pipe", "--port", "0", "--ticks", "1", "--input-delay", "61"},
       "--input-delay: Value 61 not in range 1 to 60"},
      {{"serve", "half-pipe", "--drain", "nan"}, "--drain: 'nan' is no number"},
      {{"demo", "half-pipe", "--seconds", "nan"}, "--seconds: 'nan' is no number"},
      {{"sim", "--seed", "-1"}, "--seed: '-1' is"},
#endif
#ifdef CYCLOID_EXPERIMENTS
      {{"tune", "stack-10", "--budget-us", "nan"}, "--budget-us: 'nan' is no number"},
      {{"chart", "stack-10", "--out", "x", "--moved-max", "nan"}, "--moved-max: 'nan' is"},
      {{"chart", "stack-10", "--out", "x", "--moved-max", "-2"}, "--moved-max: '-2' is below 0"},
#endif
  };
  for (const Case& wrong : cases) {
    const Ran ran = run_program(wrong.arguments);
    EXPECT_EQ(ran.exit, 2) << wrong.words;
    EXPECT_THAT(ran.err, HasSubstr(wrong.words));
    EXPECT_EQ(ran.out, "") << wrong.words;
  }
}

TEST(Usage, HelpNamesTheExitCodes) {
  const std::vector<std::vector<std::string>> commands = {{},
                                                          {"run"},
                                                          {"replay"},
                                                          {"verify"},
                                                          {"diff"},
                                                          {"scene"},
                                                          {"scene", "check"},
                                                          {"golden"},
                                                          {"golden", "make"},
                                                          {"golden", "check"},
                                                          {"version"}};
  for (std::vector<std::string> arguments : commands) {
    arguments.push_back("--help");
    const Ran ran = run_program(arguments);
    EXPECT_EQ(ran.exit, 0);
    EXPECT_THAT(ran.out, HasSubstr("Exit codes: 0 good, 1 diverged, 2 usage"));
  }
}

TEST(Usage, JsonFailureIsAnObjectToo) {
  const Ran ran = run_program({"run", "no-such-scene", "--json"});
  EXPECT_EQ(ran.exit, 2);
  EXPECT_EQ(ran.json()["exit"], 2);
  EXPECT_THAT(ran.json()["error"].get<std::string>(), HasSubstr("no-such-scene"));
}

TEST(Version, NamesWhatTwoSidesMustShare) {
  const Ran ran = run_program({"version", "--json"});
  EXPECT_EQ(ran.exit, 0);
  EXPECT_GE(ran.json()["solver_version"], 1);
  EXPECT_GE(ran.json()["protocol_version"], 1);
  EXPECT_THAT(run_program({"version"}).out, HasSubstr("solver "));
}

TEST(SceneCommand, ListsTheCatalogue) {
  const Ran text = run_program({"scene", "list"});
  EXPECT_EQ(text.exit, 0);
  EXPECT_THAT(text.out, HasSubstr("half-pipe"));
  const Ran json = run_program({"scene", "list", "--json"});
  EXPECT_GT(json.json()["scenes"].size(), 3u);
}

TEST(SceneCommand, ExportedScenesRunTheSame) {
  const Folder folder;
  const Ran expected = run_program({"run", "half-pipe", "--ticks", "20"});
  const std::string text = folder.file("scene.json");
  const std::string binary = folder.file("scene.cyscene");
  ASSERT_EQ(run_program({"scene", "export", "half-pipe", "-o", text}).exit, 0);
  ASSERT_EQ(run_program({"scene", "export", "half-pipe", "--binary", "-o", binary}).exit, 0);
  EXPECT_EQ(run_program({"scene", "export", "half-pipe"}).out, read_text(text));
  for (const std::string& file : {text, binary}) {
    EXPECT_EQ(run_program({"run", file, "--ticks", "20"}).out, expected.out);
    const Ran check = run_program({"scene", "check", file});
    EXPECT_EQ(check.exit, 0);
    EXPECT_EQ(check.out, file + ": good\n");
  }
}

TEST(SceneCommand, CheckNamesEveryMistakeOfEveryFile) {
  const Folder folder;
  const std::string file = folder.file("bad.json");
  nlohmann::json scene = nlohmann::json::parse(run_program({"scene", "export", "half-pipe"}).out);
  ASSERT_GE(scene["bodies"].size(), 2u);
  scene["bodies"][0]["positon"] = {0, 0};
  scene["bodies"][1]["kind"] = "ghost";
  write_text(file, scene.dump());
  const Ran ran = run_program({"scene", "check", file});
  EXPECT_EQ(ran.exit, 3);
  EXPECT_THAT(ran.out, HasSubstr(file + ": /bodies/0"));
  EXPECT_THAT(ran.out, HasSubstr(file + ": /bodies/1/kind: "));
  const Ran json = run_program({"scene", "check", file, "--json"});
  EXPECT_EQ(json.exit, 3);
  EXPECT_GE(json.json()["files"][0]["mistakes"].size(), 2u);
}

TEST(SceneCommand, CheckOfAFileThatIsNotThereExitsWithFive) {
  const Ran ran = run_program({"scene", "check", "/nowhere/scene.json"});
  EXPECT_EQ(ran.exit, 5);
  EXPECT_THAT(ran.err, HasSubstr("/nowhere/scene.json"));
}

TEST(SceneCommand, WhatIsPlainlyAPathIsNoNameOfTheCatalogue) {
  for (const char* path : {"/nowhere/half-pipe", "no-such.json", "no-such.cyscene"}) {
    const Ran ran = run_program({"run", path, "--ticks", "1"});
    EXPECT_EQ(ran.exit, 5) << path;
    EXPECT_EQ(ran.err,
              std::string("cycloid: ") + path + ": cannot be opened: No such file or directory\n");
  }
#ifdef CYCLOID_NETWORK
  const Ran ran = run_program({"serve", "--config", "/nowhere/server.toml"});
  EXPECT_EQ(ran.exit, 5);
  EXPECT_THAT(ran.err, HasSubstr("/nowhere/server.toml: cannot be opened"));
#endif
}

TEST(SceneCommand, RunOfABadFileExitsWithThree) {
  const Folder folder;
  write_text(folder.file("bad.json"), "{\"bodies\": 7}");
  const Ran ran = run_program({"run", folder.file("bad.json"), "--ticks", "1"});
  EXPECT_EQ(ran.exit, 3);
  EXPECT_THAT(ran.err, HasSubstr(folder.file("bad.json")));
}

}  // namespace
}  // namespace cycloid::cli
