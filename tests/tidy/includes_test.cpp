#include <gtest/gtest.h>

#include <map>
#include <regex>

#include "tests/tidy/sources.hpp"

namespace cycloid::tidy {

/// What a folder may include, as prefixes of the name between the quotes or brackets. Standard
/// headers (no slash, no ".h") are allowed unless a pattern below forbids them.
static const std::map<std::string, std::vector<std::string>> kAllowed = {
    {"solver", {"solver/", "Eigen/", "xxhash.h"}},
    {"scenes", {"solver/", "scenes/", "nlohmann/", "xxhash.h", "scene_generated.h"}},
    {"protocol", {"solver/", "scenes/", "protocol/", "flatbuffers/"}},
    {"server",
     {"solver/", "scenes/", "protocol/", "server/", "asio", "spdlog/", "fcntl.h", "unistd.h",
      "sys/", "signal.h"}},
    {"client", {"solver/", "scenes/", "protocol/", "client/", "asio"}},
    {"cli",
     {"solver/", "scenes/", "protocol/", "server/", "client/", "cli/", "asio", "spdlog/", "CLI/",
      "nlohmann/", "fcntl.h", "unistd.h", "sys/", "signal.h", "poll.h", "spawn.h"}},
    {"bench", {"solver/", "scenes/", "protocol/", "benchmark/"}},
};

/// Standard headers that bring a clock, chance, hidden order or the host into the state.
static const std::vector<std::string> kForbiddenInSolver = {
    "chrono", "random", "iostream", "fstream",  "unordered_map", "unordered_set",
    "cmath",  "math.h", "ctime",    "time.h",   "thread",        "atomic",
    "mutex",  "future", "locale",   "execution"};

/// Why a folder may not include this; "" where it may.
static std::string complaint(const std::string& file, const std::string& included) {
  const std::string folder = file.substr(0, file.find('/'));
  const auto allowed = kAllowed.find(folder);
  if (allowed == kAllowed.end()) return "";
  if (folder == "solver" && !file.starts_with("solver/workers."))
    for (const std::string& header : kForbiddenInSolver)
      if (included == header)
        return "the solver has no clock, chance, threads or libm; <" + header +
               "> belongs elsewhere (trigonometry: solver/trig.hpp, threads: solver/workers.hpp)";
  const bool standard =
      included.find('/') == std::string::npos && included.find(".h") == std::string::npos;
  if (standard && included != "asio") return "";
  for (const std::string& prefix : allowed->second)
    if (included.starts_with(prefix)) return "";
  return folder +
         "/ may not include it: dependencies run solver <- scenes <- protocol <- "
         "{server, client} <- cli, and outside libraries have one folder each";
}

static std::string included_by(const std::string& text) {
  static const std::regex kInclude(R"(^\s*#include\s*[<"]([^>"]+)[>"])");
  std::smatch match;
  return std::regex_search(text, match, kInclude) ? match[1].str() : "";
}

TEST(Includes, OfEveryFolderAreAllowed) {
  int seen = 0;
  for (const std::string& file : files_with({".cpp", ".hpp"}))
    for (const Line& line : read_lines(file)) {
      const std::string included = included_by(line.text);
      if (included.empty()) continue;
      ++seen;
      // Generated headers of the protocol are named by their schema's path.
      if (file.starts_with("protocol/") && included.ends_with("_generated.h")) continue;
      EXPECT_EQ(complaint(file, included), "") << file << ":" << line.number << " " << included;
    }
  EXPECT_GT(seen, 300);
}

TEST(Includes, TheRuleSeesWhatIsForbidden) {
  EXPECT_NE(complaint("solver/step.cpp", "cmath"), "");
  EXPECT_NE(complaint("solver/step.cpp", "thread"), "");
  EXPECT_EQ(complaint("solver/workers.hpp", "thread"), "");
  EXPECT_NE(complaint("solver/step.cpp", "scenes/scene.hpp"), "");
  EXPECT_NE(complaint("server/room/room.cpp", "client/join.hpp"), "");
  EXPECT_NE(complaint("client/join.cpp", "server/serve.hpp"), "");
  EXPECT_NE(complaint("scenes/check.cpp", "asio.hpp"), "");
  EXPECT_NE(complaint("protocol/codec.cpp", "spdlog/spdlog.h"), "");
  EXPECT_EQ(complaint("cli/main.cpp", "CLI/CLI.hpp"), "");
  EXPECT_EQ(included_by("  #include <asio.hpp>"), "asio.hpp");
}

}  // namespace cycloid::tidy
