#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "protocol/log_format.hpp"
#include "tests/cli/program.hpp"
#include "tests/places.hpp"

namespace cycloid::cli {
namespace {

/// Logs of released versions: each verifies here as long as the version that wrote it is one of
/// the bit-compatible ones, and none lies here that is not.
TEST(LogCorpus, EveryLogStillVerifies) {
  const std::string folder = places::source("tests/determinism/logs");
  const Ran ran = run_program({"verify", folder, "--json"});
  ASSERT_EQ(ran.exit, 0) << ran.out << ran.err;
  const nlohmann::json verified = ran.json();
  ASSERT_GE(verified["logs"].size(), 3u);
  for (const auto& log : verified["logs"]) {
    const Ran ran_info = run_program({"info", log["log"].get<std::string>(), "--json"});
    const nlohmann::json info = ran_info.json();
    const auto version = info["solver_version"].get<std::uint32_t>();
    EXPECT_EQ(std::ranges::count(protocol::kBitCompatibleSolverVersions, version), 1) << log;
    EXPECT_GT(info["keyframes"].size(), 0u) << "a state of that version, too";
  }
}

}  // namespace
}  // namespace cycloid::cli
