#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>

#include "tests/cli/program.hpp"
#include "tests/places.hpp"

namespace cycloid::cli {
namespace {

using testing::HasSubstr;

/// A folder with a scene, a log, goldens and something old to be replaced.
class OutputFiles : public testing::Test {
 protected:
  OutputFiles() {
    run_program({"scene", "export", "half-pipe", "-o", file("s.json")});
    run_program({"run", "half-pipe", "--ticks", "40", "--log", file("a.cylog")});
    run_program({"golden", "make", file("s.json"), "--at", "1", "-o", file("g.txt")});
    write_text(file("old"), "old\n");
  }
  std::string file(const std::string& name) const { return folder_.file(name); }
  std::size_t files() const {
    const std::filesystem::directory_iterator entries(folder_.path());
    return static_cast<std::size_t>(std::distance(begin(entries), end(entries)));
  }

  Folder folder_;
};

TEST_F(OutputFiles, StayAsTheyWereWhenTheNewOnesCannotBeWritten) {
  const std::size_t before = files();
  for (const std::string& command :
       {"export " + file("a.cylog") + " -o ", "cut " + file("a.cylog") + " -o ",
        std::string("scene export half-pipe -o "),
        std::string("run half-pipe --ticks 9 --poses ")}) {
    const Ran ran = run_other("/bin/sh", {"-c", "ulimit -f 1; trap '' XFSZ; " + places::program() +
                                                    " " + command + file("old")});
    EXPECT_EQ(ran.exit, 5) << command << ran.out;
    EXPECT_THAT(ran.err, HasSubstr(file("old") + ": cannot be written: File too large")) << command;
    EXPECT_EQ(read_text(file("old")), "old\n") << command;
  }
  EXPECT_EQ(files(), before) << "nothing half-written is left";
}

TEST_F(OutputFiles, KeepModesAndLinks) {
  chmod(file("old").c_str(), 0640);
  std::filesystem::create_symlink("old", file("link"));
  write_text(file("link.new"), "mine");
  ASSERT_EQ(run_program({"scene", "export", "half-pipe", "-o", file("link")}).exit, 0);
  EXPECT_TRUE(std::filesystem::is_symlink(file("link")));
  EXPECT_EQ(read_text(file("old")), read_text(file("s.json")));
  struct stat status {};
  ASSERT_EQ(stat(file("old").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0640u);

  std::filesystem::create_symlink(file("new"), file("dangling"));
  ASSERT_EQ(run_program({"scene", "export", "half-pipe", "-o", file("dangling")}).exit, 0);
  EXPECT_EQ(read_text(file("new")), read_text(file("s.json")));
  EXPECT_EQ(read_text(file("link.new")), "mine");
}

TEST_F(OutputFiles, AreWrittenInPlaceWhereTheyAreNoRegularFiles) {
  const Ran out = run_program({"scene", "export", "half-pipe", "-o", "/dev/stdout"});
  EXPECT_EQ(out.exit, 0) << out.err;
  EXPECT_EQ(out.out, read_text(file("s.json")));
  EXPECT_EQ(run_program(
                {"run", "half-pipe", "--ticks", "9", "--log", "/dev/null", "--poses", "/dev/null"})
                .exit,
            0);
  const Ran full = run_program({"export", file("a.cylog"), "-o", "/dev/full"});
  EXPECT_EQ(full.exit, 5);
  EXPECT_THAT(full.err, HasSubstr("/dev/full: cannot be written"));
}

TEST_F(OutputFiles, ThatCannotBeMadeAreFoundOutBeforeTheWork) {
  for (const std::string& bad : {folder_.path(), file("none/out"), file("old/out")}) {
    const Ran ran = run_program({"golden", "check", file("g.txt"), "--json", "--junit", bad});
    EXPECT_EQ(ran.exit, 5) << bad;
    EXPECT_EQ(std::count(ran.out.begin(), ran.out.end(), '\n'), 1) << "one object";
    EXPECT_THAT(ran.json()["error"].get<std::string>(), HasSubstr(bad + ": "));
  }
#ifdef CYCLOID_EXPERIMENTS
  const Ran tuned = run_program({"tune", "stack-10", "--error", "1mm", "-o", folder_.path()});
  EXPECT_EQ(tuned.exit, 5);
  EXPECT_EQ(tuned.out, "");
#endif
}

TEST_F(OutputFiles, ReportThatCannotBeWrittenInTheEndIsOneObjectToo) {
  const Ran ran = run_program({"verify", file("a.cylog"), "--json", "--junit", "/dev/full"});
  EXPECT_EQ(ran.exit, 5);
  EXPECT_EQ(ran.json()["exit"], 5);
  EXPECT_EQ(ran.err.find("cannot be written"), ran.err.rfind("cannot be written"));
}

TEST_F(OutputFiles, AreNoFilesThatACommandReadsOrWritesElsewhere) {
  std::filesystem::create_symlink(file("a.cylog"), file("link.cylog"));
  struct Case {
    std::vector<std::string> arguments;
    std::vector<std::string> options;
  };
  const Case cases[] = {
      {{"export", file("a.cylog"), "-o", file("a.cylog")}, {"--out", "LOG"}},
      {{"export", file("link.cylog"), "-o", file("a.cylog")}, {"--out", "LOG"}},
      {{"cut", file("a.cylog"), "--to", "9", "-o", file("link.cylog")}, {"--out", "LOG"}},
      {{"golden", "make", file("s.json"), "-o", file("s.json")}, {"-o", "SCENE"}},
      {{"golden", "check", file("g.txt"), "--junit", file("g.txt")}, {"--junit", "FILE"}},
      {{"golden", "check", file("g.txt"), "--junit", file("s.json")}, {"--junit", "FILE"}},
      {{"verify", file("a.cylog"), "--junit", file("a.cylog")}, {"--junit", "LOG"}},
      {{"verify", folder_.path(), "--junit", file("a.cylog")}, {"--junit", "LOG"}},
      {{"scene", "export", file("s.json"), "-o", file("s.json")}, {"-o", "NAME"}},
      {{"run", file("s.json"), "--log", file("s.json")}, {"--log", "SCENE"}},
      {{"run", file("s.json"), "--poses", file("s.json")}, {"--poses", "SCENE"}},
      {{"run", "half-pipe", "--log", file("x"), "--poses", file("./x")}, {"--log", "--poses"}},
  };
  const std::string scene = read_text(file("s.json"));
  const std::string log = read_text(file("a.cylog"));
  const std::string goldens = read_text(file("g.txt"));
  for (const Case& wrong : cases) {
    const Ran ran = run_program(wrong.arguments);
    EXPECT_EQ(ran.exit, 2) << wrong.arguments[0] << ran.err;
    for (const std::string& option : wrong.options) EXPECT_THAT(ran.err, HasSubstr(option));
    EXPECT_EQ(ran.out, "");
  }
  EXPECT_TRUE(read_text(file("s.json")) == scene);
  EXPECT_TRUE(read_text(file("a.cylog")) == log);
  EXPECT_TRUE(read_text(file("g.txt")) == goldens);
  EXPECT_FALSE(std::filesystem::exists(file("x")));
}

TEST_F(OutputFiles, HaveNames) {
  for (const char* option : {"--log", "--poses"}) {
    const Ran ran = run_program({"run", "half-pipe", "--ticks", "1", option, ""});
    EXPECT_EQ(ran.exit, 2);
    EXPECT_THAT(ran.err, HasSubstr(option));
  }
}

}  // namespace
}  // namespace cycloid::cli
