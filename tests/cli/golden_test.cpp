#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/program.hpp"
#include "tests/cli/xml.hpp"

namespace cycloid::cli {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

/// Goldens of a catalogue scene and of a user's own, in a folder above it.
class GoldenCommand : public testing::Test {
 protected:
  GoldenCommand() {
    std::filesystem::create_directory(file("my scenes"));
    scene_ = nlohmann::json::parse(run_program({"scene", "export", "half-pipe"}).out);
    write_scene();
    const Ran made = run_program(
        {"golden", "make", file("my scenes/arena.json"), "top", "--at", "1,5,30", "-o", goldens()});
    EXPECT_EQ(made.exit, 0) << made.err;
    EXPECT_EQ(made.out, goldens() + ": 6 rows of 2 scenes\n");
  }
  std::string file(const std::string& name) const { return folder_.file(name); }
  std::string goldens() const { return file("goldens.txt"); }
  void write_scene() const { write_text(file("my scenes/arena.json"), scene_.dump()); }
  Ran check(std::vector<std::string> arguments = {}) const {
    arguments.insert(arguments.begin(), {"golden", "check", goldens()});
    return run_program(arguments);
  }
  /// Replaces a word of the row or line that begins so; words are numbered from 0.
  void change(const std::string& begin, std::size_t word, const std::string& to) const {
    std::string text = read_text(goldens());
    std::size_t at = text.find("\n" + begin);
    ASSERT_NE(at, std::string::npos) << begin;
    for (++at; word > 0; --word) at = text.find(' ', at) + 1;
    write_text(goldens(), text.replace(at, text.find_first_of(" \n", at) - at, to));
  }

  Folder folder_;
  nlohmann::json scene_;
};

TEST_F(GoldenCommand, MakesAFileOfTheDocumentedFormThatChecks) {
  EXPECT_THAT(read_text(goldens()),
              ContainsRegex("^cycloid-golden 1\nsolver-version [0-9]+\n"
                            "scene my%20scenes/arena.json 30 [0-9a-f]+ [0-9a-f]+\n"
                            "scene top 30 [0-9a-f]+ [0-9a-f]+\n"
                            "my%20scenes/arena.json 1 [0-9a-f]+ [0-9]+ [0-9a-f]+\n"
                            "my%20scenes/arena.json 5 [0-9a-f]+ [0-9]+ [0-9a-f]+\n"
                            "my%20scenes/arena.json 30 [0-9a-f]+ [0-9]+ [0-9a-f]+\n"
                            "top 1 [0-9a-f]+ [0-9]+ [0-9a-f]+\n"));
  const Ran ran = check();
  EXPECT_EQ(ran.exit, 0) << ran.err;
  EXPECT_EQ(ran.out,
            "my scenes/arena.json: good, 30 ticks\ntop: good, 30 ticks\n"
            "2 of 2 scenes good, 60 ticks replayed\n");
}

TEST_F(GoldenCommand, RowsHaveTheDigestsThatRunPrints) {
  const Ran ran = run_program({"run", "top", "--ticks", "30"});
  EXPECT_THAT(read_text(goldens()), HasSubstr("\ntop " + ran.out.substr(0, ran.out.size() - 1)));
}

TEST_F(GoldenCommand, IsTheSameForAnySettingsAndFromStdout) {
  const std::string expected = read_text(goldens());
  const Ran made =
      run_program({"golden", "make", file("my scenes/arena.json"), "top", "--at", "30,5,1",
                   "--workers", "3", "--lanes", "8", "--jobs", "2", "-o", file("again.txt")});
  EXPECT_EQ(made.exit, 0) << made.err;
  EXPECT_EQ(read_text(file("again.txt")), expected);
  for (const char* lanes : {"1", "16"}) {
    EXPECT_EQ(check({"--lanes", lanes, "--workers", "2", "--jobs", "2"}).out, check().out);
  }
  const Ran printed = run_program({"golden", "make", "top", "--ticks", "10"});
  EXPECT_THAT(printed.out, HasSubstr("\ntop 1 "));
  EXPECT_THAT(printed.out, HasSubstr("\ntop 10 "));
  EXPECT_THAT(printed.out, HasSubstr("\nscene top 10 "));
  EXPECT_EQ(
      run_program({"golden", "make", "top", "--ticks", "12", "--at", "1,10"}).out.find("\ntop 10 "),
      printed.out.find("\ntop 10 "));
}

TEST_F(GoldenCommand, MoveWithTheirScenes) {
  std::filesystem::create_directory(file("moved"));
  std::filesystem::rename(goldens(), file("moved/goldens.txt"));
  EXPECT_EQ(run_program({"golden", "check", file("moved/goldens.txt")}).exit, 5);
  std::filesystem::rename(file("my scenes"), file("moved/my scenes"));
  EXPECT_EQ(run_program({"golden", "check", file("moved/goldens.txt")}).exit, 0);
}

TEST_F(GoldenCommand, AMismatchIsNamedByEveryChangedNumberOfARow) {
  struct Case {
    std::size_t word;
    const char* to;
    const char* words;
  };
  const std::string good = read_text(goldens());
  for (const Case& wrong :
       {Case{2, "0000000000001234", "expected digest 0000000000001234, found "},
        Case{3, "7", "expected 7 encoded bytes, found "},
        Case{4, "0000000000001234", "expected chain 0000000000001234, found "}}) {
    change("top 30 ", wrong.word, wrong.to);
    const Ran ran = check();
    EXPECT_EQ(ran.exit, 1) << ran.out;
    EXPECT_THAT(ran.out, StartsWith("my scenes/arena.json: good, 30 ticks\ntop: tick 30: "));
    EXPECT_THAT(ran.out, HasSubstr(wrong.words));
    EXPECT_THAT(ran.out, HasSubstr("the first difference is in ticks 6 to 30, 5 ticks\n"));
    EXPECT_THAT(ran.out, HasSubstr("1 of 2 scenes good"));
    EXPECT_EQ(check({"--scene", "my scenes/arena.json"}).exit, 0);
    EXPECT_EQ(check({"--ticks", "29"}).exit, 0) << "the row of tick 30 is behind";
    write_text(goldens(), good);
  }
}

TEST_F(GoldenCommand, OnlyRowsUpToATickAreCompared) {
  const Ran ran = check({"--ticks", "5", "--json"});
  EXPECT_EQ(ran.exit, 0);
  EXPECT_EQ(ran.json()["ticks"], 10);
  EXPECT_EQ(ran.json()["good"], 2);
}

TEST_F(GoldenCommand, NothingToCompareIsAFailure) {
  const Ran made = run_program({"golden", "make", "top", "--at", "5", "-o", goldens()});
  ASSERT_EQ(made.exit, 0);
  const Ran ran = check({"--ticks", "4"});
  EXPECT_EQ(ran.exit, 5) << ran.out;
  EXPECT_THAT(ran.out, HasSubstr("top: no row to compare: the first is of tick 5"));
}

TEST_F(GoldenCommand, AnotherSolverVersionIsRefusedWithBoth) {
  change("solver-version ", 1, "4000000000");
  const Ran ran = check({"--github", "--junit", file("report.xml")});
  EXPECT_EQ(ran.exit, 4);
  EXPECT_THAT(ran.err, ContainsRegex("solver version 4000000000, this program is of [0-9]+\n"));
  EXPECT_THAT(ran.out, StartsWith("::error file=" + goldens() +
                                  ",line=2,title=cycloid golden check%3A incompatible::"));
  EXPECT_EQ(XmlReader::read(read_text(file("report.xml"))).attributes.at("failures"), "1");
}

TEST_F(GoldenCommand, AChangedSceneIsRefusedWithBothDigests) {
  scene_["gravity"] = {0, -5};
  write_scene();
  const Ran ran = check();
  EXPECT_EQ(ran.exit, 4) << ran.out;
  EXPECT_THAT(ran.out, ContainsRegex("arena.json: the scene has changed: its digest is [0-9a-f]+, "
                                     "the goldens are of [0-9a-f]+, 0 ticks\n"));
  EXPECT_THAT(ran.out, HasSubstr("top: good, 30 ticks"));
}

// The script is no part of the scene's digest, and other inputs are no divergence.
TEST_F(GoldenCommand, AChangedScriptIsRefusedWithBothDigests) {
  scene_["seats"][0]["script"].push_back({{"from", 30}, {"buttons", 1}});
  write_scene();
  const Ran ran = check();
  EXPECT_EQ(ran.exit, 4) << ran.out;
  EXPECT_THAT(ran.out, HasSubstr("arena.json: the scene's script has changed: its digest is "));
  scene_["seats"][0]["script"].back()["from"] = 31;
  write_scene();
  EXPECT_EQ(check().exit, 0) << "what the script says later changes nothing";
}

TEST_F(GoldenCommand, AMissingOrBrokenSceneIsNamedAndDoesNotHideTheOthers) {
  std::filesystem::remove(file("my scenes/arena.json"));
  const Ran missing = check();
  EXPECT_EQ(missing.exit, 5) << missing.out;
  EXPECT_THAT(missing.out, HasSubstr(file("my scenes/arena.json") + ": cannot be opened"));
  EXPECT_THAT(missing.out, HasSubstr("top: good"));
  write_text(file("my scenes/arena.json"), "{");
  EXPECT_EQ(check().exit, 3);
  write_scene();
  change("scene top ", 1, "pot");
  change("top 1 ", 0, "pot");
  change("top 5 ", 0, "pot");
  change("top 30 ", 0, "pot");
  const Ran unknown = check();
  EXPECT_EQ(unknown.exit, 4) << unknown.out;
  EXPECT_THAT(unknown.out, HasSubstr("pot: this program has no scene of this name"));
}

TEST_F(GoldenCommand, AMalformedFileIsNamedByLine) {
  change("top 5 ", 2, "12");
  const Ran ran = check({"--github"});
  EXPECT_EQ(ran.exit, 3);
  EXPECT_THAT(ran.err, HasSubstr(goldens() + ":9: a row must be"));
  EXPECT_THAT(ran.out, StartsWith("::error file=" + goldens() +
                                  ",line=9,title=cycloid golden check%3A corrupt::" + goldens() +
                                  ": a row must be"));
  write_text(goldens(), "");
  EXPECT_EQ(check().exit, 3);
  EXPECT_THAT(check().err, HasSubstr(goldens() + ":1: is no golden file"));
  write_text(goldens(), "cycloid-golden 1\nsolver-version 1\n");
  EXPECT_THAT(check().err, HasSubstr(goldens() + ":3: there is no scene"));
  write_text(goldens(), "cycloid-golden 2\n");
  EXPECT_EQ(check().exit, 4);
  std::filesystem::remove(goldens());
  EXPECT_EQ(check().exit, 5);
}

TEST_F(GoldenCommand, ReportsNameTheRowAndTheScene) {
  change("top 5 ", 2, "0000000000001234");
  const Ran ran = check({"--github", "--junit", file("report.xml")});
  EXPECT_EQ(ran.exit, 1);
  EXPECT_THAT(ran.out, HasSubstr("\n::error file=" + goldens() +
                                 ",line=9,title=cycloid golden check%3A diverged::top: tick 5: "));
  EXPECT_THAT(ran.out, HasSubstr("\n::notice title=cycloid golden check::1 of 2 scenes good, 31 "));
  EXPECT_THAT(ran.out, Not(HasSubstr("::arena")));
  const XmlElement suite = XmlReader::read(read_text(file("report.xml"))).children.at(0);
  EXPECT_EQ(suite.attributes.at("tests"), "2");
  EXPECT_EQ(suite.attributes.at("failures"), "1");
  EXPECT_EQ(suite.children.at(0).attributes.at("name"), "my scenes/arena.json");
  EXPECT_EQ(suite.children.at(1).children.at(0).attributes.at("type"), "diverged");
}

TEST_F(GoldenCommand, BadCommandLinesAreNamed) {
  const std::string arena = file("my scenes/arena.json");
  const std::pair<std::vector<std::string>, const char*> cases[] = {
      {{"golden"}, "subcommand"},
      {{"golden", "make"}, "SCENE"},
      {{"golden", "make", "no-such-scene"}, "no-such-scene"},
      {{"golden", "make", "top", "top"}, "top is named twice"},
      {{"golden", "make", "--catalogue", "top"}, "top is named twice"},
      {{"golden", "make", arena, file("./my scenes/arena.json")}, "is named twice"},
      {{"golden", "make", "top", "--at", "0"}, "--at"},
      {{"golden", "make", "top", "--at", "10", "--ticks", "9"}, "--at: 10 is behind --ticks"},
      {{"golden", "make", "top", "--json"}, "-o"},
      {{"golden", "check"}, "FILE"},
      {{"golden", "check", goldens(), "--scene", "pot"}, "has no scene 'pot'"},
      {{"golden", "check", goldens(), "--lanes", "3"}, "--lanes"},
  };
  for (const auto& [arguments, words] : cases) {
    const Ran ran = run_program(arguments);
    EXPECT_EQ(ran.exit, 2) << words << ran.out << ran.err;
    EXPECT_THAT(ran.err, HasSubstr(words));
  }
}

}  // namespace
}  // namespace cycloid::cli
