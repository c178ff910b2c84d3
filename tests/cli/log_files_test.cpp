#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/cli/program.hpp"

namespace cycloid::cli {
namespace {

using testing::HasSubstr;

/// Some of them have no end, and none holds a log.
TEST(LogFiles, AreNoDevices) {
  for (const char* command : {"verify", "info", "replay", "export"}) {
    const Ran ran = run_program({command, "/dev/null"});
    EXPECT_EQ(ran.exit, 5) << command;
    EXPECT_THAT(ran.out + ran.err, HasSubstr("/dev/null: is a device, not a file")) << command;
  }
}

/// One of them must not hide the verdict on the others.
TEST(LogFiles, OfAFolderThatCannotBeOpenedAreBadEachByItself) {
  const Folder folder;
  const std::string good = folder.file("match.cylog");
  const std::string circle = folder.file("circle.cylog");
  const std::string gone = folder.file("gone.cylog");
  run_program({"run", "half-pipe", "--ticks", "3", "--log", good});
  std::filesystem::create_symlink(circle, circle);
  std::filesystem::create_symlink(folder.file("nothing"), gone);
  const Ran ran = run_program({"verify", folder.path()});
  EXPECT_EQ(ran.exit, 5);
  EXPECT_THAT(ran.out, HasSubstr(good + ": good, 3 ticks\n"));
  EXPECT_THAT(ran.out, HasSubstr(circle + ": cannot be opened: "));
  EXPECT_THAT(ran.out, HasSubstr(gone + ": cannot be opened: "));
  EXPECT_THAT(ran.out, HasSubstr("1 of 3 logs good"));
}

}  // namespace
}  // namespace cycloid::cli
