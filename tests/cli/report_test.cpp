#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/cli/logs.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/xml.hpp"

namespace cycloid::cli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

/// A folder with a good log, one that diverges and one that is no log.
class VerifyReport : public testing::Test {
 protected:
  VerifyReport() {
    run_program({"run", "half-pipe", "--ticks", "20", "--log", file("good.cylog")});
    rewrite_log(file("good.cylog"), file("diverged.cylog"),
                [](protocol::Log& log) { log.ticks[6].digest ^= 1; });
    write_text(file("corrupt.cylog"), "no log");
  }
  std::string file(const std::string& name) const { return folder_.file(name); }
  Ran verify(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {"verify"});
    return run_program(arguments);
  }
  XmlElement junit() const { return XmlReader::read(read_text(file("report.xml"))); }

  Folder folder_;
};

TEST_F(VerifyReport, JunitHasATestCaseForEveryLogAndTheRightCounts) {
  const Ran ran = verify({folder_.path(), "--junit", file("report.xml")});
  EXPECT_EQ(ran.exit, 3) << "the worst of 0, 1 and 3";
  EXPECT_EQ(ran.out, verify({folder_.path()}).out);
  const XmlElement root = junit();
  EXPECT_EQ(root.name, "testsuites");
  ASSERT_EQ(root.children.size(), 1u);
  const XmlElement& suite = root.children[0];
  EXPECT_EQ(suite.name, "testsuite");
  for (const XmlElement* element : {&root, &suite}) {
    EXPECT_EQ(element->attributes.at("tests"), "3");
    EXPECT_EQ(element->attributes.at("failures"), "2");
    EXPECT_EQ(element->attributes.at("errors"), "0");
    EXPECT_GT(std::stod(element->attributes.at("time")), 0.0);
  }
  ASSERT_EQ(suite.children.size(), 3u);
  std::vector<std::string> names;
  for (const XmlElement& test : suite.children) {
    EXPECT_EQ(test.name, "testcase");
    EXPECT_EQ(test.attributes.at("classname"), "cycloid verify");
    EXPECT_GE(std::stod(test.attributes.at("time")), 0.0);
    names.push_back(test.attributes.at("name"));
  }
  EXPECT_THAT(names,
              ElementsAre(file("corrupt.cylog"), file("diverged.cylog"), file("good.cylog")));
  EXPECT_EQ(suite.children[2].children.size(), 0u);
  const XmlElement& failure = suite.children[1].children.at(0);
  EXPECT_EQ(failure.name, "failure");
  EXPECT_EQ(failure.attributes.at("type"), "diverged");
  EXPECT_THAT(failure.attributes.at("message"), StartsWith("diverged at tick 7: recorded "));
  EXPECT_THAT(failure.text, HasSubstr(file("diverged.cylog") + ": diverged at tick 7"));
  EXPECT_EQ(suite.children[0].children.at(0).attributes.at("type"), "corrupt");
}

TEST_F(VerifyReport, GithubHasAnErrorForEveryBadLogAndOneNotice) {
  const Ran ran = verify({folder_.path(), "--github"});
  EXPECT_EQ(ran.exit, 3);
  EXPECT_THAT(ran.out, HasSubstr("\n::error file=" + file("corrupt.cylog") +
                                 ",title=cycloid verify%3A corrupt::" + file("corrupt.cylog")));
  EXPECT_THAT(ran.out, HasSubstr("\n::error file=" + file("diverged.cylog") +
                                 ",title=cycloid verify%3A diverged::" + file("diverged.cylog") +
                                 ": diverged at tick 7: recorded "));
  EXPECT_THAT(ran.out, Not(HasSubstr("::error file=" + file("good.cylog"))));
  EXPECT_THAT(ran.out, HasSubstr("\n::notice title=cycloid verify::1 of 3 logs good, 26 ticks"));
}

TEST_F(VerifyReport, JsonStaysOneObjectBesideGithub) {
  const Ran ran = verify({folder_.path(), "--github", "--json"});
  EXPECT_EQ(ran.json()["exit"], 3);
  EXPECT_EQ(ran.json()["bad"], 2);
  EXPECT_THAT(ran.err, HasSubstr("::error file="));
}

TEST_F(VerifyReport, LogsSideBySideAreReportedInTheirOrder) {
  for (int i = 10; i < 30; ++i)
    std::filesystem::copy_file(file("good.cylog"), file(std::to_string(i) + ".cylog"));
  const Ran one = verify({folder_.path()});
  EXPECT_THAT(one.out, HasSubstr("21 of 23 logs good"));
  for (const char* jobs : {"2", "5", "64"}) {
    const Ran more = verify({folder_.path(), "--jobs", jobs});
    EXPECT_EQ(more.exit, one.exit) << jobs;
    EXPECT_EQ(more.out, one.out) << jobs;
  }
}

TEST_F(VerifyReport, NamesOfAnyBytesAreEscaped) {
  const std::string name = "50%,a:b<&>\"'\n\r\x01\x7f\xff\xc3\xa9\xed\xa0\x80.cylog";
  const Ran ran = verify({file(name), "--junit", file("report.xml"), "--github"});
  EXPECT_EQ(ran.exit, 5);
  const XmlElement test = junit().children.at(0).children.at(0);
  EXPECT_EQ(test.attributes.at("name"),
            file("50%,a:b<&>\"'\n\r\\x01\\x7f\\xff\xc3\xa9\\xed\\xa0\\x80.cylog"));
  EXPECT_THAT(ran.out,
              HasSubstr("::error file=" +
                        file("50%25%2Ca%3Ab<&>\"'%0A%0D\x01\x7f\xff"
                             "\xc3\xa9\xed\xa0\x80.cylog") +
                        ",title=cycloid verify%3A input/output::" + file("50%25,a:b<&>\"'%0A%0D")));
}

TEST_F(VerifyReport, AnEmptySetOfLogsIsAFailedTestCase) {
  const std::string empty = file("empty");
  std::filesystem::create_directory(empty);
  const Ran ran = verify({empty, "--junit", file("report.xml"), "--github"});
  EXPECT_EQ(ran.exit, 5);
  EXPECT_THAT(ran.err, HasSubstr(empty + ": no log (*.cylog) found"));
  EXPECT_THAT(ran.out, StartsWith("::error file=" + empty + ","));
  const XmlElement root = junit();
  EXPECT_EQ(root.attributes.at("tests"), "1");
  EXPECT_EQ(root.attributes.at("failures"), "1");
  const XmlElement failure = root.children.at(0).children.at(0).children.at(0);
  EXPECT_EQ(failure.attributes.at("message"), "no log (*.cylog) found");
}

TEST_F(VerifyReport, AJunitFileThatCannotBeWrittenIsAnInputOutputError) {
  const Ran ran = verify({file("good.cylog"), "--junit", "/nowhere/report.xml"});
  EXPECT_EQ(ran.exit, 5);
  EXPECT_THAT(ran.err, HasSubstr("/nowhere/report.xml"));
  const Ran both = verify({folder_.file("none"), "--junit", "/nowhere/report.xml"});
  EXPECT_EQ(both.exit, 5);
}

TEST(XmlReader, RefusesWhatIsNotWellFormed) {
  const std::string head = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  EXPECT_EQ(XmlReader::read(head + "<a b=\"1\">x<c/>y&#60;</a>\n").text, "xy<");
  const char* const kBad[] = {"<a>",
                              "<a></b>",
                              "<a/><b/>",
                              "<a b=\"1\" b=\"2\"/>",
                              "<a b=\"<\"/>",
                              "<a>&</a>",
                              "<a>&#1;</a>",
                              "<a>\x01</a>",
                              "<a b=1/>",
                              "<a b=\"\n\"/>",
                              "<a>\xff</a>",
                              "<a b=\"1\"c=\"2\"/>",
                              "",
                              "<a>x",
                              "<a>&#60</a>"};
  for (const char* bad : kBad) EXPECT_THROW(XmlReader::read(head + bad), std::runtime_error) << bad;
}

}  // namespace
}  // namespace cycloid::cli
