#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>

#include "tests/tidy/sources.hpp"

namespace cycloid::tidy {

/// Types and inline constants that two files define under one name in one namespace.
/// The linker keeps one constructor for both, and the other type's objects are built in its size: a
/// build without optimisation then writes past them, while an optimised one seems well. Of two
/// constants either value may be read.
static Complaints against_names(const std::vector<Source>& all) {
  static const std::regex kNamespace(R"(^namespace ([\w:]*) ?\{)");
  static const std::regex kType(
      R"(^(?:struct|class|enum class) (\w+)(?: final)?(?: :[^;]*)? \{.*)");
  static const std::regex kConstant(R"(^inline (?:constexpr|const) [\w:<>, ]+ (\w+)(?: =|\{|;).*)");
  std::map<std::string, std::set<std::string>> files_of;
  for (const Source& source : all) {
    std::string space;
    bool own = false;  // Inside of an unnamed namespace names are the file's own.
    for (const std::string& line : source.code) {
      std::smatch match;
      if (std::regex_search(line, match, kNamespace)) {
        own = match[1].length() == 0;
        if (!own) space = match[1];
      } else if (!own && (std::regex_match(line, match, kType) ||
                          std::regex_match(line, match, kConstant))) {
        files_of[space + "::" + match[1].str()].insert(source.path);
      }
    }
  }
  Complaints complaints;
  for (const auto& [type, files] : files_of)
    if (files.size() > 1)
      complaints.push_back(
          type + " is defined in " + *files.begin() + " and in " + *std::next(files.begin()) +
          ": a program has one definition of a name; rename the one that is used less");
  return complaints;
}

TEST(Names, HaveOneDefinition) {
  EXPECT_THAT(against_names(sources()), testing::IsEmpty());
}

TEST(Names, DefinedInTwoFilesAreSeen) {
  const std::string text = "namespace cycloid::solver {\nstruct Axis {\n};\n}\n";
  const std::string hidden = "namespace cycloid::solver {\nnamespace {\nstruct Axis {\n};\n}\n}\n";
  const Source one = make_source("solver/a.cpp", text);
  EXPECT_EQ(against_names({one, make_source("solver/b.cpp", text)}).size(), 1u);
  EXPECT_EQ(against_names({one, make_source("solver/b.cpp", hidden)}).size(), 0u);
  const std::string elsewhere = "namespace cycloid::scenes {\nstruct Axis {\n};\n}\n";
  EXPECT_EQ(against_names({one, make_source("scenes/b.cpp", elsewhere)}).size(), 0u);
  const char* constant = "namespace cycloid::solver {\ninline constexpr float kFlat = 1e-3f;\n}\n";
  EXPECT_EQ(against_names({make_source("solver/a.hpp", constant),
                           make_source("tests/solver/b.hpp", constant)})
                .size(),
            1u);
}

}  // namespace cycloid::tidy
