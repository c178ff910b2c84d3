#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace cycloid::cli
