#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "tests/tidy/sources.hpp"

namespace cycloid::tidy {

inline constexpr std::size_t kLinesMax = 400;
inline constexpr std::size_t kColumnsMax = 100;
inline constexpr std::size_t kFunctionLinesMax = 60;

/// Letters, not bytes: what UTF-8 adds to a letter begins with the bits 10.
static std::size_t columns(const std::string& line) {
  return static_cast<std::size_t>(std::count_if(
      line.begin(), line.end(), [](char c) { return (static_cast<unsigned char>(c) >> 6) != 2; }));
}

static Complaints against_shape(const Source& source) {
  // In two parts, so that this file does not name them itself.
  static const std::regex kUnfinished(std::string(R"(\b(TO)") + "DO|FIX" + "ME|XX" + R"(X)\b)");
  // Best effort: a comment that ends as a statement does and holds what only code holds.
  static const std::regex kOldCode(R"(^\s*//+\s*([{}]|.*(=|\(|->|::|\breturn\b).*[;{}])\s*$)");
  Complaints complaints;
  if (source.lines.size() > kLinesMax)
    complaints.push_back(source.path + ": more than 400 lines; one idea a file, so split it");
  if (source.path.ends_with(".hpp") && (source.lines.empty() || source.lines[0] != "#pragma once"))
    complaints.push_back(source.path + ": a header begins with #pragma once");
  for (std::size_t i = 0; i < source.lines.size(); ++i) {
    const std::string& line = source.lines[i];
    if (columns(line) > kColumnsMax)
      complaints.push_back(source.at(i) + "wider than 100 columns; ./dev format");
    if (line.find('\t') != std::string::npos)
      complaints.push_back(source.at(i) + "a tab; write spaces, ./dev format");
    if (std::regex_search(line, kUnfinished))
      complaints.push_back(source.at(i) + "not finished; do it now, or leave it out");
    if (std::regex_search(line, kOldCode))
      complaints.push_back(source.at(i) + "code in a comment; remove it, the history keeps it");
  }
  return complaints;
}

/// Functions that are too long, by the layout of clang-format: a body ends with a brace alone, at
/// the column where its head began. Best effort: what is not laid out so is not measured. Tests
/// are exempt, because one table of cases is easier to read than its halves.
static Complaints against_long_functions(const Source& source) {
  static const std::regex kOther(R"(^\s*(namespace|struct|class|enum|union|extern)\b)");
  Complaints complaints;
  if (source.path.starts_with("tests/")) return complaints;
  for (const std::string indent : {"", "  "}) {
    std::size_t head = 0;
    for (std::size_t i = 0; i < source.code.size(); ++i) {
      const std::string& line = source.code[i];
      const std::size_t start = line.find_first_not_of(' ');
      if (start != indent.size()) continue;
      const bool closes = line[start] == '}';
      const bool is_function = !std::regex_search(source.code[head], kOther);
      if (closes && is_function && i - head + 1 > kFunctionLinesMax)
        complaints.push_back(source.at(head) +
                             "a function of more than 60 lines; give its parts "
                             "names of their own");
      head = closes ? i + 1 : i;
    }
  }
  return complaints;
}

static Complaints against_machine_paths(const Source& source) {
  static const std::regex kPath(R"((^|[^\w.~}])/(work|root|home|Users)/\w)");
  Complaints complaints;
  for (std::size_t i = 0; i < source.lines.size(); ++i)
    if (std::regex_search(source.lines[i], kPath))
      complaints.push_back(source.at(i) +
                           "a path of somebody's machine; write it relative to the "
                           "root of the repository: " +
                           source.lines[i].substr(0, 100));
  return complaints;
}

TEST(Files, AreShortAndNarrowAndFinished) {
  for (const Source& source : sources()) EXPECT_THAT(against_shape(source), testing::IsEmpty());
}

TEST(Files, LongWideUnfinishedOrStaleOnesAreSeen) {
  std::string long_file = "#pragma once\n";
  for (int i = 0; i < 400; ++i) long_file += "\n";
  const std::string unfinished = std::string("// TO") + "DO: later\n";
  EXPECT_EQ(against_shape(make_source("cli/x.hpp", long_file)).size(), 1u);
  EXPECT_EQ(against_shape(make_source("cli/x.hpp", "int x;\n")).size(), 1u);
  EXPECT_EQ(against_shape(make_source("cli/x.hpp", "")).size(), 1u);
  EXPECT_EQ(against_shape(make_source("cli/x.cpp", std::string(101, 'x'))).size(), 1u);
  EXPECT_EQ(against_shape(make_source("cli/x.cpp", "\tint x;")).size(), 1u);
  EXPECT_EQ(against_shape(make_source("cli/x.cpp", unfinished)).size(), 1u);
  EXPECT_EQ(against_shape(make_source("cli/x.cpp", "  // x = f(y);\n  // }\n")).size(), 2u);
  EXPECT_EQ(against_shape(make_source("cli/x.cpp", "// return x;\n")).size(), 1u);
  EXPECT_EQ(against_shape(make_source("cli/x.cpp", "// Axes over both;\nf(x);  // So.\n")).size(),
            0u);
  EXPECT_THAT(against_shape(make_source("cli/x.cpp", "// m/s² " + std::string(92, 'x'))),
              testing::IsEmpty());
}

TEST(Functions, AreShort) {
  for (const Source& source : sources())
    EXPECT_THAT(against_long_functions(source), testing::IsEmpty());
}

TEST(Functions, LongOnesAreSeen) {
  std::string body;
  for (int i = 0; i < 60; ++i) body += "    ++x;\n";
  const auto complaints = [](const std::string& text) {
    return against_long_functions(make_source("cli/x.cpp", text)).size();
  };
  EXPECT_EQ(complaints("int x;\n\nvoid f(int a,\n       int b) {\n" + body + "}\n"), 1u);
  EXPECT_EQ(complaints("struct S {\n  void f() {\n" + body + "  }\n};\n"), 1u);
  EXPECT_EQ(complaints("struct S {\n" + body + "};\n"), 0u);
  EXPECT_EQ(complaints("void f() {\n  ++x;\n}\n"), 0u);
}

TEST(Files, NameNoMachine) {
  int seen = 0;
  for (const std::string& path : files_with({})) {
    const Source source = read_source(path);
    const auto holds_nul = [](const std::string& line) {
      return line.find('\0') != std::string::npos;
    };
    if (std::any_of(source.lines.begin(), source.lines.end(), holds_nul)) continue;  // No text.
    ++seen;
    EXPECT_THAT(against_machine_paths(source), testing::IsEmpty());
  }
  EXPECT_GT(seen, 150);
}

TEST(Files, ThatNameAMachineAreSeen) {
  const std::string home = std::string("/ho") + "me/";
  EXPECT_EQ(against_machine_paths(make_source("a.md", "path = " + home + "me/x")).size(), 1u);
  EXPECT_EQ(against_machine_paths(make_source("a.md", "\"" + home + "me\"")).size(), 1u);
  EXPECT_THAT(against_machine_paths(make_source("a.md", "see tests/work/x and docs" + home + "x")),
              testing::IsEmpty());
}

}  // namespace cycloid::tidy
