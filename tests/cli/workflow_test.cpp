#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <regex>
#include <sstream>

#include "tests/cli/program.hpp"
#include "tests/cli/xml.hpp"
#include "tests/places.hpp"

namespace cycloid::cli {
namespace {

using testing::HasSubstr;

std::string read_source(const std::string& path) {
  return read_text(places::source(path));
}

/// What follows `run: ` where that is a call of the program.
std::vector<std::string> program_calls(const std::string& workflow) {
  static const std::regex kRun(R"(^ +run: (cycloid .*)$)");
  std::vector<std::string> calls;
  std::istringstream stream(workflow);
  std::smatch match;
  for (std::string line; std::getline(stream, line);)
    if (std::regex_match(line, match, kRun)) calls.push_back(match[1]);
  return calls;
}

/// The text between the fences of the shell blocks of a page.
std::vector<std::string> shell_blocks(const std::string& page) {
  static const std::string kOpen = "\n```sh\n";
  std::vector<std::string> blocks;
  for (std::size_t at = page.find(kOpen); at != page.npos; at = page.find(kOpen, at + 1)) {
    const std::size_t start = at + kOpen.size();
    blocks.push_back(page.substr(start, page.find("```\n", start) - start));
  }
  return blocks;
}

/// A user's repository with a scene of their own, and the built program on the path.
class Workflow : public testing::Test {
 protected:
  Workflow() {
    std::filesystem::create_directory(folder_.file("scenes"));
    nlohmann::json scene = nlohmann::json::parse(run_program({"scene", "export", "half-pipe"}).out);
    scene["name"] = "arena";
    scene["gravity"] = {0, -7.5};
    write_text(folder_.file("scenes/arena.json"), scene.dump());
  }
  Ran shell(const std::string& script) const {
    const std::string bin = std::filesystem::path(places::program()).parent_path().string();
    write_text(folder_.file("script.sh"), "set -e\nPATH=\"" + bin + ":$PATH\"\ncd \"" +
                                              folder_.path() + "\"\n" + script + "\n");
    const int status = std::system(("sh \"" + folder_.file("script.sh") + "\" >\"" +
                                    folder_.file("out") + "\" 2>\"" + folder_.file("err") + "\"")
                                       .c_str());
    return {WEXITSTATUS(status), read_text(folder_.file("out")), read_text(folder_.file("err"))};
  }

  const std::vector<std::string> calls_ = program_calls(read_source("docs/ci/determinism.yml"));
  const std::vector<std::string> blocks_ = shell_blocks(read_source("docs/ci.md"));
  Folder folder_;
};

TEST_F(Workflow, CommandsDoWhatTheGuideSays) {
  ASSERT_EQ(calls_.size(), 2u);
  ASSERT_EQ(blocks_.size(), 2u);
  const Ran begin = shell(blocks_[0]);
  ASSERT_EQ(begin.exit, 0) << begin.out << begin.err;
  for (const std::string& call : calls_) {
    EXPECT_THAT(blocks_[1], HasSubstr(call + "\n")) << "the guide shows another command";
    const Ran ran = shell(call);
    EXPECT_EQ(ran.exit, 0) << call << ran.out << ran.err;
    EXPECT_THAT(ran.out, HasSubstr("\n::notice "));
  }
  for (const char* report : {"goldens.xml", "logs.xml"}) {
    const XmlElement root = XmlReader::read(read_text(folder_.file(report)));
    EXPECT_EQ(root.attributes.at("tests"), "1") << report;
    EXPECT_EQ(root.attributes.at("failures"), "0") << report;
    EXPECT_THAT(read_source("docs/ci/determinism.yml"),
                HasSubstr("            " + std::string(report) + "\n"));
  }

  const std::string goldens = folder_.file("determinism/goldens.txt");
  std::string text = read_text(goldens);
  const std::size_t digest = text.rfind(" 100 ") + 5;
  text[digest] = text[digest] == '0' ? '1' : '0';
  write_text(goldens, text);
  const Ran bad = shell(calls_[0]);
  EXPECT_EQ(bad.exit, 1) << bad.out << bad.err;
  EXPECT_THAT(bad.out, HasSubstr("::error file=determinism/goldens.txt,line=6,title="));
  EXPECT_EQ(XmlReader::read(read_text(folder_.file("goldens.xml"))).attributes.at("failures"), "1");
}

TEST_F(Workflow, FailsWhereNothingIsToCheck) {
  ASSERT_EQ(calls_.size(), 2u);
  std::filesystem::create_directories(folder_.file("determinism/logs"));
  write_text(folder_.file("determinism/goldens.txt"), "");
  EXPECT_EQ(shell(calls_[0]).exit, 3);
  EXPECT_EQ(shell(calls_[1]).exit, 5);
  for (const char* report : {"goldens.xml", "logs.xml"}) {
    const XmlElement root = XmlReader::read(read_text(folder_.file(report)));
    EXPECT_EQ(root.attributes.at("failures"), "1") << report;
  }
}

}  // namespace
}  // namespace cycloid::cli
