#include <gtest/gtest.h>

#include <regex>

#include "tests/tidy/sources.hpp"

namespace cycloid::tidy {

/// A pattern that may not stand in the code of some files, and what to write instead.
struct Rule {
  const char* under;    ///< Prefix of the files it is for; "" for all.
  const char* pattern;  ///< Searched in code without comments and quoted text.
  const char* instead;
  const char* bad;  ///< A line that breaks it, so that the rule itself is tested.
};

static const Rule kRules[] = {
    {"solver/",
     R"(\b(std::)?(sinf?|cosf?|tanf?|asinf?|acosf?|atanf?|expf?|logf?|powf?|hypotf?|cbrtf?)\s*\()",
     "libm rounds differently on every platform: solver/trig.hpp", "x = std::cos(a);"},
    {"solver/", R"(std::(hash|reduce|shuffle|fma|unordered_\w+)\b|\bfmaf?\()",
     "unspecified order or rounding: ordered containers, plain sums, a * b + c",
     "std::hash<int>{}(3)"},
    {"solver/", R"(_mm\w*_(rcp|rsqrt|f[n]?madd|fmsub)|\brsqrt|\brecip)",
     "estimates and fused operations differ between processors: 1 / x, sqrt, Lanes<W>",
     "_mm_rcp_ps(x)"},
    {"solver/", R"(\b(double|long double|volatile|rand|clock|time)\b\s*[\(<*& ]\s*\w*)",
     "float state, no clock and no chance in the solver", "double x = 1;"},
    {"solver/", R"(reinterpret_cast|std::uintptr_t)",
     "the order of everything is by id, never by address: std::bit_cast, memcpy, ids",
     "reinterpret_cast<std::uintptr_t>(p)"},
    {"solver/", R"(\b(throw|try|catch)\b)", "errors are values: Result<T>, Error", "throw 1;"},
    {"", R"(\t)", "spaces", "\tint x;"},
};

/// Whether a D of 2 or 3 is asked for; only dim.hpp knows the difference.
static const std::regex kDimension(R"(\bD\s*==\s*[23])");
static const std::regex kUnfinished(
    "\\b(TO"
    "DO|FIX"
    "ME|XX"
    "X)\\b");
// A path of somebody's machine.
static const std::regex kMachinePath(R"((^|[^\w.])/(work|root|home)/\w)");

TEST(Rules, HoldInEverySourceFile) {
  for (const std::string& file : files_with({".cpp", ".hpp"}))
    for (const Line& line : read_lines(file)) {
      const std::string code = code_of(line.text);
      for (const Rule& rule : kRules) {
        const bool broken =
            file.starts_with(rule.under) && std::regex_search(code, std::regex(rule.pattern));
        EXPECT_FALSE(broken) << file << ":" << line.number << ": " << line.text << "\n  write "
                             << rule.instead;
      }
      const bool knows_dimension = file.starts_with("solver/") && file != "solver/dim.hpp" &&
                                   std::regex_search(code, kDimension);
      EXPECT_FALSE(knows_dimension)
          << file << ":" << line.number << ": what differs between 2 and 3 lives in dim.hpp";
    }
}

TEST(Rules, EachSeesALineThatBreaksIt) {
  for (const Rule& rule : kRules)
    EXPECT_TRUE(std::regex_search(code_of(rule.bad), std::regex(rule.pattern))) << rule.bad;
  EXPECT_TRUE(std::regex_search("if constexpr (D == 3)", kDimension));
  EXPECT_TRUE(
      std::regex_search("// TO"
                        "DO: later",
                        kUnfinished));
  EXPECT_TRUE(
      std::regex_search("path = /ho"
                        "me/me/x",
                        kMachinePath));
  EXPECT_EQ(code_of("a = \"std::cos(\"; // std::sin("), "a = ; ");
}

TEST(Sorts, InTheSolverNameTheirTotalOrder) {
  int sorts = 0;
  for (const std::string& file : files_with({".cpp", ".hpp"})) {
    if (!file.starts_with("solver/")) continue;
    const std::vector<Line> lines = read_lines(file);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      if (code_of(lines[i].text).find("std::sort") == std::string::npos) continue;
      ++sorts;
      const std::string near = (i > 0 ? lines[i - 1].text : "") + lines[i].text;
      EXPECT_NE(near.find("otal order"), std::string::npos)
          << file << ":" << i + 1 << ": equal elements end up in any order; say in a comment why "
          << "the order is total";
    }
  }
  EXPECT_GT(sorts, 0);
}

TEST(Files, AreShortAndNarrowAndFinished) {
  for (const std::string& file : files_with({".cpp", ".hpp"})) {
    const std::vector<Line> lines = read_lines(file);
    EXPECT_LE(lines.size(), 400u) << file << ": one idea a file; split it";
    const bool guarded = !file.ends_with(".hpp") || lines.at(0).text == "#pragma once";
    EXPECT_TRUE(guarded) << file << " has to begin with #pragma once";
    for (const Line& line : lines) {
      const std::string where = file + ":" + std::to_string(line.number);
      // Bytes are counted; a letter beyond ASCII takes two.
      EXPECT_LE(line.text.size(), 102u) << where << " is wider than 100 columns";
      EXPECT_FALSE(std::regex_search(line.text, kUnfinished)) << where << " is not finished";
    }
  }
}

TEST(Files, NameNoMachine) {
  for (const std::string& file :
       files_with({".cpp", ".hpp", ".md", ".txt", ".cmake", ".json", ".fbs", ".py", ".sh", "dev"}))
    for (const Line& line : read_lines(file))
      EXPECT_FALSE(std::regex_search(line.text, kMachinePath))
          << file << ":" << line.number << ": a path of somebody's machine: " << line.text;
}

/// The folder names in backticks with a slash, in the first column of the README's table.
static std::vector<std::string> folders_in_readme() {
  static const std::regex kRow(R"(^\| `([\w]+)/` \|)");
  std::vector<std::string> folders;
  for (const Line& line : read_lines("README.md")) {
    std::smatch match;
    if (std::regex_search(line.text, match, kRow)) folders.push_back(match[1]);
  }
  std::sort(folders.begin(), folders.end());
  return folders;
}

TEST(Readme, ListsTheFoldersOfTheTree) {
  std::vector<std::string> folders;
  for (const auto& entry : std::filesystem::directory_iterator(CYCLOID_SOURCE_DIR)) {
    const std::string name = entry.path().filename();
    if (entry.is_directory() && name[0] != '.' && name != "build") folders.push_back(name);
  }
  std::sort(folders.begin(), folders.end());
  EXPECT_EQ(folders_in_readme(), folders);
}

TEST(Architecture, ListsTheStagesOfTheTree) {
  std::string text;
  for (const Line& line : read_lines("docs/architecture.md")) text += line.text + "\n";
  int stages = 0;
  for (const std::string& file : files_with({".cpp"})) {
    if (!file.starts_with("solver/stages/")) continue;
    ++stages;
    const std::string stage = std::filesystem::path(file).stem();
    EXPECT_NE(text.find("| `" + stage + "` |"), std::string::npos)
        << file << " has no row in docs/architecture.md";
  }
  static const std::regex kRow(R"(\n\| `\w+` \|)");
  const auto rows =
      std::distance(std::sregex_iterator(text.begin(), text.end(), kRow), std::sregex_iterator());
  EXPECT_EQ(rows, stages) << "docs/architecture.md has a row for a stage that is gone";
}

TEST(Schemas, GiveEveryFieldOfATableAnId) {
  static const std::regex kField(R"(^\s+\w+\s*:\s*[\[\]\w.]+.*;)");
  int fields = 0;
  for (const std::string& file : files_with({".fbs"})) {
    bool table = false;
    for (const Line& line : read_lines(file)) {
      if (line.text.starts_with("table ")) table = true;
      if (line.text.starts_with("}")) table = false;
      if (!table || !std::regex_search(line.text, kField)) continue;
      ++fields;
      EXPECT_NE(line.text.find("id: "), std::string::npos)
          << file << ":" << line.number << ": ids make the order of lines free to change";
    }
  }
  EXPECT_GT(fields, 80);
}

}  // namespace cycloid::tidy
