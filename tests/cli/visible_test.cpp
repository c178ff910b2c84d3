#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/program.hpp"

namespace cycloid::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

/// Goal: no text of a scene, a log or a name of a file looks like a line of the program's own or
/// moves a cursor. Method: those that would.
TEST(Visible, TextFromOutsideStaysOnItsLine) {
  const Folder folder;
  nlohmann::json scene = nlohmann::json::parse(run_program({"scene", "export", "half-pipe"}).out);
  scene["name"] = "a\nticks 7\x1b[31m\xc2\x9bZ \xc3\xa9";
  const std::string shown = R"(a\x0aticks 7\x1b[31m\xc2\x9bZ )"
                            "\xc3\xa9";
  const std::string file = folder.file("s.json");
  const std::string log = folder.file("b\nad.cylog");
  write_text(file, scene.dump());
  ASSERT_EQ(run_program({"run", file, "--ticks", "9", "--log", log}).exit, 0);
  EXPECT_THAT(run_program({"info", log}).out, HasSubstr("scene " + shown + "\n"));
  EXPECT_THAT(run_program({"replay", log}).out, HasSubstr("9 ticks of " + shown + ", all"));
  EXPECT_THAT(run_program({"verify", folder.path()}).out, HasSubstr(R"(b\x0aad.cylog: good)"));
  EXPECT_EQ(run_program({"info", log, "--json"}).json()["scene"], scene["name"]);

  scene["bodies"][0]["x\ny\x1b"] = 1;
  write_text(file, scene.dump());
  const Ran wrong = run_program({"run", file});
  EXPECT_EQ(wrong.exit, 3);
  EXPECT_THAT(wrong.err, HasSubstr(R"(x\x0ay\x1b)"));
  EXPECT_THAT(wrong.err, Not(HasSubstr("\x1b")));
}

}  // namespace
}  // namespace cycloid::cli
