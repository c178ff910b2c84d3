#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/cli/program.hpp"
#include "tests/places.hpp"

namespace cycloid::cli {
namespace {

TEST(Arithmetic, ProgramWithALibraryThatFlushesSaysSoAndStops) {
  // A sanitizer of the program wants to be the first library; it need not be.
  ::setenv("ASAN_OPTIONS", "verify_asan_link_order=0:detect_leaks=0", 1);
  ::setenv("LD_PRELOAD", places::flushing_library().c_str(), 1);
  const Ran ran = run_program({"run", "half-pipe", "--ticks", "10"});
  ::unsetenv("LD_PRELOAD");
  EXPECT_EQ(ran.exit, 4);
  EXPECT_EQ(ran.out, "");
  EXPECT_THAT(ran.err, testing::StartsWith("cycloid: floating_point_mode is not IEEE: "));
  EXPECT_THAT(ran.err, testing::HasSubstr("flushes subnormal numbers"));
  EXPECT_THAT(ran.err, testing::HasSubstr("-ffast-math"));
}

}  // namespace
}  // namespace cycloid::cli
