#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>

#include "tests/tidy/sources.hpp"

namespace cycloid::tidy {

/// Files whose types end up in one program: a folder, and each folder of tests.
static std::string program_of(const std::string& path) {
  const std::size_t slash = path.find('/');
  const bool of_tests = path.starts_with("tests/");
  return path.substr(0, of_tests ? path.find('/', slash + 1) : slash);
}

/// Types that two files of one program define under one name in one namespace. The linker keeps one
/// constructor for both, and the other type's objects are built in its size: a build without
/// optimisation then writes past them, while an optimised one seems well.
static Complaints against_types(const std::vector<Source>& all) {
  static const std::regex kNamespace(R"(^namespace ([\w:]*) ?\{)");
  static const std::regex kType(
      R"(^(?:struct|class|enum class) (\w+)(?: final)?(?: :[^;]*)? \{.*)");
  std::map<std::string, std::set<std::string>> files_of;
  for (const Source& source : all) {
    std::string space;
    bool own = false;  // Inside of an unnamed namespace names are the file's own.
    for (const std::string& line : source.code) {
      std::smatch match;
      if (std::regex_search(line, match, kNamespace)) {
        own = match[1].length() == 0;
        if (!own) space = match[1];
      } else if (!own && std::regex_match(line, match, kType)) {
        files_of[program_of(source.path) + " " + space + "::" + match[1].str()].insert(source.path);
      }
    }
  }
  Complaints complaints;
  for (const auto& [type, files] : files_of)
    if (files.size() > 1)
      complaints.push_back(
          type + " is defined in " + *files.begin() + " and in " + *std::next(files.begin()) +
          ": one program has one type of a name; rename the one that is used less");
  return complaints;
}

TEST(Types, HaveOneDefinitionInAProgram) {
  EXPECT_THAT(against_types(sources()), testing::IsEmpty());
}

TEST(Types, OfOneNameInTwoFilesAreSeen) {
  const std::string text = "namespace cycloid::solver {\nstruct Axis {\n};\n}\n";
  const std::string hidden = "namespace cycloid::solver {\nnamespace {\nstruct Axis {\n};\n}\n}\n";
  const Source one = make_source("solver/a.cpp", text);
  EXPECT_EQ(against_types({one, make_source("solver/b.cpp", text)}).size(), 1u);
  EXPECT_EQ(against_types({one, make_source("solver/b.cpp", hidden)}).size(), 0u);
  EXPECT_EQ(against_types({one, make_source("scenes/b.cpp", text)}).size(), 0u);
}

}  // namespace cycloid::tidy
