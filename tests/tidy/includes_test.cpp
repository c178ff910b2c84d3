#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>

#include "tests/tidy/sources.hpp"

namespace cycloid::tidy {

/// What a folder may include besides standard headers, as prefixes of the name between the quotes
/// or brackets. Folders that are not named here (tests) may include everything.
static const std::map<std::string, std::vector<std::string>> kAllowed = {
    {"solver", {"solver/", "Eigen/", "xxhash.h"}},
    {"scenes",
     {"solver/", "scenes/", "nlohmann/", "flatbuffers/", "xxhash.h", "scene_generated.h"}},
    {"protocol", {"solver/", "scenes/", "protocol/", "flatbuffers/"}},
    {"server",
     {"solver/", "scenes/", "protocol/", "server/", "asio", "openssl/", "sodium.h", "spdlog/",
      "nlohmann/", "prometheus/", "civetweb.h", "toml++/", "netinet/", "fcntl.h", "unistd.h",
      "sys/", "signal.h", "sched.h", "poll.h"}},
    {"client", {"solver/", "scenes/", "protocol/", "client/", "asio", "openssl/"}},
    {"protocol/transport", {"protocol/transport/", "asio", "openssl/"}},
    {"cli",
     {"solver/", "scenes/", "protocol/", "server/", "client/", "bench/", "cli/", "asio", "spdlog/",
      "CLI/", "nlohmann/", "fcntl.h", "unistd.h", "sys/", "signal.h", "poll.h", "spawn.h",
      "dirent.h", "io.h"}},
    {"bench",
     {"solver/", "scenes/", "protocol/", "bench/", "Eigen/", "box2d/", "btBullet", "ode/",
      "malloc.h", "asio", "CLI/", "nlohmann/", "fcntl.h", "unistd.h", "sys/", "signal.h", "poll.h",
      "spawn.h"}},
};

/// All that the solver may take from the standard library. What is not here brings a clock, chance,
/// threads, libm, hidden order or the host into the state; a new header is added on purpose.
static const std::set<std::string> kStandardInSolver = {
    "algorithm",        "array",    "bit",         "cfenv",
    "cfloat",           "charconv", "climits",     "concepts",
    "cstddef",          "cstdint",  "cstring",     "functional",
    "initializer_list", "iterator", "limits",      "memory",
    "numeric",          "optional", "span",        "string",
    "string_view",      "tuple",    "type_traits", "utility",
    "variant",          "vector"};
/// And what only solver/workers.* may, because it alone knows threads.
static const std::set<std::string> kStandardInWorkers = {"atomic", "condition_variable", "mutex",
                                                         "thread"};

/// And instructions by name, which only the one place that knows vectors may.
static bool is_of_lanes(const std::string& path, const std::string& included) {
  return path == "solver/lanes.hpp" &&
         (included == "immintrin.h" || included == "emmintrin.h" || included == "wasm_simd128.h");
}

/// And who runs where, which only the one place may ask that sends a thread elsewhere.
static bool is_of_processors(const std::string& path, const std::string& included) {
  return path == "solver/processors.cpp" && included == "sched.h";
}

static bool is_standard(const std::string& included) {
  static const std::regex kStandard(R"([a-z_]+)");
  static const std::set<std::string> kOfC = {"math.h",   "time.h",   "stdio.h",
                                             "stdlib.h", "stdint.h", "string.h"};
  return (std::regex_match(included, kStandard) && included != "asio") || kOfC.contains(included);
}

/// Why a file may not include this; "" where it may.
static std::string complaint(const std::string& path, const std::string& included) {
  // The one part of the protocol that knows sockets; server and client build their streams of it.
  const std::string folder = path.starts_with("protocol/transport/")
                                 ? "protocol/transport"
                                 : path.substr(0, path.find('/'));
  const auto allowed = kAllowed.find(folder);
  if (allowed == kAllowed.end() || is_of_lanes(path, included) || is_of_processors(path, included))
    return "";
  if (is_standard(included)) {
    if (folder != "solver" || kStandardInSolver.contains(included)) return "";
    if (path.starts_with("solver/workers.") && kStandardInWorkers.contains(included)) return "";
    return "the solver takes no clock, chance, threads, libm or host from the library; write "
           "solver/trig.hpp for trigonometry and sqrt of solver/lanes.hpp, solver/workers.hpp for "
           "threads, sorted vectors for hash tables; files and text belong to scenes/ or cli/";
  }
  // Generated headers of the protocol are named by their schema's path.
  if (folder == "protocol" && included.ends_with("_generated.h")) return "";
  for (const std::string& prefix : allowed->second)
    if (included.starts_with(prefix)) return "";
  return folder +
         "/ may not include it: dependencies run solver <- scenes <- protocol <- {server, client} "
         "<- cli, nothing needs tests/, and each outside library has its folders; move what is "
         "needed into the lower folder, or pass it in as a value";
}

static Complaints against_includes(const Source& source) {
  static const std::regex kInclude(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  Complaints complaints;
  for (std::size_t i = 0; i < source.lines.size(); ++i) {
    std::smatch match;
    if (!std::regex_search(source.lines[i], match, kInclude)) continue;
    const std::string why = complaint(source.path, match[1]);
    if (!why.empty()) complaints.push_back(source.at(i) + match[1].str() + ": " + why);
  }
  return complaints;
}

TEST(Includes, OfEveryFolderAreAllowed) {
  EXPECT_GT(sources().size(), 100u);
  for (const Source& source : sources()) EXPECT_THAT(against_includes(source), testing::IsEmpty());
}

TEST(Includes, WhatIsForbiddenIsSeen) {
  const std::pair<const char*, const char*> kBad[] = {
      {"solver/step.cpp", "<cmath>"},
      {"solver/step.cpp", "<sched.h>"},
      {"solver/step.cpp", "<math.h>"},
      {"solver/step.cpp", "<chrono>"},
      {"solver/step.cpp", "<unordered_map>"},
      {"solver/step.cpp", "<thread>"},
      {"solver/workers.cpp", "<random>"},
      {"solver/step.cpp", "\"scenes/scene.hpp\""},
      {"solver/step.cpp", "<immintrin.h>"},
      {"scenes/check.cpp", "<asio.hpp>"},
      {"scenes/check.cpp", "\"protocol/codec.hpp\""},
      {"protocol/codec.cpp", "<spdlog/spdlog.h>"},
      {"protocol/codec.cpp", "\"server/serve.hpp\""},
      {"server/room/room.cpp", "\"client/join.hpp\""},
      {"client/join.cpp", "\"server/serve.hpp\""},
      {"protocol/codec.cpp", "<sodium.h>"},
      {"protocol/transport/stream.hpp", "\"protocol/codec.hpp\""},
      {"cli/main.cpp", "\"tests/cli/program.hpp\""},
  };
  for (const auto& [path, included] : kBad) {
    const std::string text = std::string("#include ") + included + "\n";
    EXPECT_EQ(against_includes(make_source(path, text)).size(), 1u) << path << " " << included;
  }
}

TEST(Includes, WhatIsAllowedIsNotComplainedAbout) {
  EXPECT_EQ(complaint("solver/workers.hpp", "thread"), "");
  EXPECT_EQ(complaint("solver/digest.cpp", "xxhash.h"), "");
  EXPECT_EQ(complaint("solver/lanes.hpp", "immintrin.h"), "");
  EXPECT_EQ(complaint("protocol/codec.cpp", "protocol/schema/client_message_generated.h"), "");
  EXPECT_EQ(complaint("server/net/listener.hpp", "asio.hpp"), "");
  EXPECT_EQ(complaint("cli/main.cpp", "CLI/CLI.hpp"), "");
  EXPECT_EQ(complaint("tests/cli/run_test.cpp", "tests/cli/program.hpp"), "");
}

}  // namespace cycloid::tidy
