#ifdef CYCLOID_EXPERIMENTS
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>

#include "tests/cli/program.hpp"

namespace cycloid::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

/// What of a chart.csv does not depend on the machine: all before the column of times.
std::string without_times(const std::string& csv) {
  const std::size_t columns = [&] {
    const std::string names = csv.substr(0, csv.find(",ns_per_tick"));
    return static_cast<std::size_t>(std::count(names.begin(), names.end(), ','));
  }();
  std::string kept;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    std::size_t end = 0;
    for (std::size_t i = 0; i <= columns; ++i) end = line.find(',', end) + 1;
    kept += line.substr(0, end) + '\n';
  }
  return kept;
}

/// Goal: all but times is the same every time. Method: two runs of the program.
TEST(ChartCommand, WritesTheSameNumbersTwice) {
  const Folder folder;
  std::string texts[2];
  for (int i = 0; i < 2; ++i) {
    const std::string out = folder.file("chart" + std::to_string(i));
    const Ran ran =
        run_program({"chart", "heavy-on-light-10", "duplicate-points", "--out", out, "--methods",
                     "soft-step,ngs-block", "--quick", "--commit", "abc", "--json"});
    ASSERT_EQ(ran.exit, 0) << ran.err;
    EXPECT_EQ(ran.json()["charts"][0]["scene"], "trial-heavy-on-light-10");
    EXPECT_EQ(ran.json()["charts"][0]["settings"], 8);
    EXPECT_EQ(ran.json()["files"].size(), 3u + 2u * 2u);
    for (const std::string name : ran.json()["files"])
      EXPECT_FALSE(read_text(out + "/" + name).empty()) << name;
    texts[i] = read_text(out + "/chart.csv");
    EXPECT_THAT(texts[i], HasSubstr("\"abc\""));
    EXPECT_THAT(read_text(out + "/chart.html"), Not(HasSubstr("src=\"http")));
  }
  EXPECT_THAT(without_times(texts[0]),
              HasSubstr("\"trial-heavy-on-light-10\",600,soft-step,4,1,1,"));
  EXPECT_EQ(without_times(texts[0]), without_times(texts[1]));
}

/// Goal: a scene is what `cycloid run` calls a scene. Method: a file of a catalogue scene gives the
/// numbers of its name.
TEST(ChartCommand, TakesNamesAndFiles) {
  const Folder folder;
  const std::string file = folder.file("pile.json");
  ASSERT_EQ(run_program({"scene", "export", "stack-10", "-o", file}).exit, 0);
  std::string texts[2];
  for (const std::string& scene : {std::string("stack-10"), file}) {
    const Ran ran =
        run_program({"chart", scene, "--out", folder.file("out"), "--methods", "pgs", "--substeps",
                     "1,2", "--sweeps", "3", "--ticks", "30", "--repeats", "0"});
    ASSERT_EQ(ran.exit, 0) << ran.err;
    EXPECT_THAT(ran.out, HasSubstr("stack-10: 2 settings"));
    texts[scene == file ? 1 : 0] = read_text(folder.file("out/chart.csv"));
  }
  EXPECT_EQ(texts[0], texts[1]) << "nothing is timed, so all is the same";
}

TEST(ChartCommand, CallsScenesWithoutANameAsTheirFilesAndDrawsEachErrorOnce) {
  const Folder folder;
  nlohmann::json scene = nlohmann::json::parse(run_program({"scene", "export", "stack-10"}).out);
  scene["name"] = "";
  for (const char* name : {"one.json", "two.json"}) write_text(folder.file(name), scene.dump());
  const Ran ran =
      run_program({"chart", folder.file("one.json"), folder.file("two.json"), "--out",
                   folder.file("out"), "--methods", "pgs", "--substeps", "1", "--sweeps", "1",
                   "--error", "worst,worst", "--ticks", "5", "--repeats", "0", "--json"});
  ASSERT_EQ(ran.exit, 0) << ran.err;
  EXPECT_EQ(ran.err, "") << "gnuplot has nothing to warn of";
  EXPECT_THAT(ran.json()["files"], testing::ElementsAre("chart.csv", "chart.html", "fronts.md",
                                                        "one-worst.svg", "two-worst.svg"));
}

/// Goal: what a scene calls itself is text and nothing else. Method: a name that would be a command
/// of gnuplot's, a tag of the page and the end of a cell.
TEST(ChartCommand, NamesOfScenesAreTextAlone) {
  const Folder folder;
  nlohmann::json scene = nlohmann::json::parse(run_program({"scene", "export", "stack-10"}).out);
  scene["name"] = "a\n!touch '" + folder.file("touched") + "'\n<b>|";
  write_text(folder.file("scene.json"), scene.dump());
  const Ran ran = run_program({"chart", folder.file("scene.json"), "--out", folder.file("out"),
                               "--methods", "pgs", "--substeps", "1", "--sweeps", "1", "--error",
                               "worst", "--ticks", "5", "--repeats", "0"});
  ASSERT_EQ(ran.exit, 0) << ran.err;
  EXPECT_FALSE(std::filesystem::exists(folder.file("touched")));
  EXPECT_THAT(read_text(folder.file("out/chart.html")), Not(HasSubstr("<b>")));
  EXPECT_THAT(read_text(folder.file("out/fronts.md")), HasSubstr("' <b>\\| |"));
}

TEST(ChartCommand, DrawsScenesOfNearlyOneNameIntoFilesOfTheirOwn) {
  const Folder folder;
  nlohmann::json scene = nlohmann::json::parse(run_program({"scene", "export", "stack-10"}).out);
  for (const char* name : {" ", "."}) {
    scene["name"] = std::string(300, 'x').replace(1, 1, name);
    write_text(folder.file(std::string("of") + name + "json"), scene.dump());
  }
  const Ran ran =
      run_program({"chart", folder.file("of json"), folder.file("of.json"), "--out",
                   folder.file("out"), "--methods", "pgs", "--substeps", "1", "--sweeps", "1",
                   "--error", "worst", "--ticks", "5", "--repeats", "0"});
  ASSERT_EQ(ran.exit, 0) << ran.err;
  const std::string stem = folder.file("out/") + std::string(100, 'x').replace(1, 1, "-");
  EXPECT_TRUE(std::filesystem::exists(stem + "-worst.svg"));
  EXPECT_TRUE(std::filesystem::exists(stem + "-2-worst.svg"));
}

/// Goal: numbers that took a run are not lost for a figure. Method: a folder where the figure would
/// be; and no gnuplot to draw it.
TEST(ChartCommand, KeepsItsNumbersWhereAFigureCannotBeWritten) {
  const Folder folder;
  const std::vector<std::string> arguments = {
      "chart", "stack-10", "--methods", "pgs",       "--substeps", "1",     "--sweeps",
      "1",     "--ticks",  "5",         "--repeats", "0",          "--out", folder.file("out")};
  std::filesystem::create_directories(folder.file("out/stack-10-position.svg"));
  const Ran ran = run_program(arguments);
  EXPECT_EQ(ran.exit, 5);
  EXPECT_THAT(ran.err, HasSubstr("stack-10-position.svg"));
  EXPECT_THAT(read_text(folder.file("out/chart.csv")), HasSubstr("\"stack-10\",5,pgs,1,1,"));
  EXPECT_THAT(read_text(folder.file("out/fronts.md")), HasSubstr("| pgs 1x1 |"));
  std::vector<std::string> again = arguments;
  again.back() = folder.file("other");
  const std::string programs = std::getenv("PATH");
  ::setenv("PATH", folder.path().c_str(), 1);
  const Ran refused = run_program(again);
  ::setenv("PATH", programs.c_str(), 1);
  EXPECT_EQ(refused.exit, 5);
  EXPECT_THAT(refused.err, HasSubstr("gnuplot-nox"));
  EXPECT_FALSE(std::filesystem::exists(folder.file("other"))) << "said before the run";
}

TEST(ChartCommand, RefusesBadValuesAndNamesTheOption) {
  const Folder folder;
  struct Case {
    std::vector<std::string> more;
    const char* words;
  };
  const Case cases[] = {
      {{"stack-10", "--methods", "sor"}, "--methods: there is no method 'sor'"},
      {{"stack-10", "--substeps", "1,0"}, "--substeps"},
      {{"stack-10", "--substeps", "65"}, "--substeps"},
      {{"stack-10", "--sweeps", "many"}, "--sweeps"},
      {{"stack-10", "--methods", "pgs,soft-step", "--substeps", "1,64", "--sweeps", "1,128"},
       "--substeps, --sweeps, --relax: 'soft-step 64x128+1' makes 8256 sweeps in a tick"},
      {{"stack-10", "--relax", "-1"}, "--relax"},
      {{"stack-10", "--ticks", "-1"}, "--ticks"},
      {{"stack-10", "--repeats", "x"}, "--repeats"},
      {{"stack-10", "--moved-max", "-2"}, "--moved-max"},
      {{"stack-10", "--error", "beauty"}, "--error: there is no error 'beauty'"},
      {{"stack-10", "stack-10"}, "SCENE"},
      {{"no-such-scene"}, "no-such-scene"},
      {{}, "SCENE"},
  };
  for (const Case& wrong : cases) {
    std::vector<std::string> arguments = {"chart", "--out", folder.file("out")};
    arguments.insert(arguments.end(), wrong.more.begin(), wrong.more.end());
    const Ran ran = run_program(arguments);
    EXPECT_EQ(ran.exit, 2) << wrong.words;
    EXPECT_THAT(ran.err, HasSubstr(wrong.words));
  }
  EXPECT_FALSE(std::filesystem::exists(folder.file("out"))) << "nothing has been made";
  EXPECT_EQ(run_program({"chart", "stack-10"}).exit, 2) << "--out is needed";
  write_text(folder.file("file"), "");
  const Ran ran = run_program(
      {"chart", "heavy-on-light-10", "--methods", "pgs", "--quick", "--out", folder.file("file")});
  EXPECT_EQ(ran.exit, 5) << ran.err;
  EXPECT_THAT(ran.err, HasSubstr("--out"));
}

}  // namespace
}  // namespace cycloid::cli
#endif
