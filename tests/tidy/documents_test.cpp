#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cctype>
#include <filesystem>
#include <regex>
#include <set>
#include <string>

#include "tests/places.hpp"
#include "tests/tidy/sources.hpp"

namespace cycloid::tidy {

using Names = std::set<std::string>;

/// The first group of every match in the lines.
static Names names_in(const Source& source, const std::regex& pattern) {
  Names names;
  for (const std::string& line : source.lines)
    for (std::sregex_iterator match(line.begin(), line.end(), pattern), end; match != end; ++match)
      names.insert((*match)[1]);
  return names;
}

static Complaints against_list(const Names& listed, const Names& present, const std::string& where,
                               const std::string& what) {
  Complaints complaints;
  for (const std::string& name : present)
    if (!listed.contains(name))
      complaints.push_back(where + " has no row for " + what + " " + name + "; add one");
  for (const std::string& name : listed)
    if (!present.contains(name))
      complaints.push_back(where + " has a row for " + what + " " + name +
                           ", which does not exist; remove the row");
  return complaints;
}

/// Names in backticks in the first column of a table, folders with a slash behind them.
static const std::regex kFolderRow(R"(^\| `([\w-]+)/` \|)");
static const std::regex kStageRow(R"(^\| `(\w+)` \|)");

TEST(Readme, ListsTheFoldersOfTheTree) {
  Names folders;
  for (const auto& entry : std::filesystem::directory_iterator(places::source(""))) {
    const std::string name = entry.path().filename();
    if (entry.is_directory() && is_ours(name) && name[0] != '.') folders.insert(name);
  }
  const Names listed = names_in(read_source("README.md"), kFolderRow);
  EXPECT_THAT(against_list(listed, folders, "README.md", "folder"), testing::IsEmpty());
}

TEST(Architecture, ListsTheStagesOfTheTree) {
  Names stages;
  for (const std::string& path : files_with({".cpp"}))
    if (path.starts_with("solver/stages/")) stages.insert(std::filesystem::path(path).stem());
  const Names listed = names_in(read_source("docs/architecture.md"), kStageRow);
  EXPECT_THAT(against_list(listed, stages, "docs/architecture.md", "stage"), testing::IsEmpty());
}

TEST(Lists, ThatLackARowOrHaveOneTooManyAreSeen) {
  const Source readme = make_source("a.md", "| `solver/` | x |\n| `old/` | y |\n| `z` | `w/` |\n");
  EXPECT_EQ(names_in(readme, kFolderRow), (Names{"solver", "old"}));
  EXPECT_EQ(against_list({"solver", "old"}, {"solver"}, "a.md", "folder").size(), 1u);
  EXPECT_EQ(against_list({"solver"}, {"solver", "new"}, "a.md", "folder").size(), 1u);
  EXPECT_EQ(names_in(make_source("a.md", "| `color` | x |\n"), kStageRow), (Names{"color"}));
}

/// Fields of tables without an id; enums, structs and unions have none.
static Complaints against_fields(const Source& schema, int& fields) {
  static const std::regex kField(R"(\w+\s*:\s*[\[\w])");
  static const std::regex kId(R"(\(.*\bid:\s*\d+)");
  Complaints complaints;
  bool table = false;
  for (std::size_t i = 0; i < schema.code.size(); ++i) {
    const std::string& line = schema.code[i];
    if (line.starts_with("table ")) {
      table = true;
      continue;
    }
    if (line.starts_with("}")) table = false;
    if (!table || !std::regex_search(line, kField)) continue;
    ++fields;
    if (!std::regex_search(line, kId))
      complaints.push_back(schema.at(i) +
                           "a field without an id moves when lines do; write "
                           "(id: N) with the next free number");
  }
  return complaints;
}

TEST(Schemas, GiveEveryFieldOfATableAnId) {
  int fields = 0;
  for (const std::string& path : files_with({".fbs"}))
    EXPECT_THAT(against_fields(read_source(path), fields), testing::IsEmpty());
  EXPECT_GT(fields, 80);
}

TEST(Schemas, WithoutIdsAreSeen) {
  int fields = 0;
  const Source bad = make_source(
      "a.fbs", "table A {\n  a:int;\n  b:[B] (deprecated);  // (id: 1)\n  c:int = 1 (id: 2);\n}\n");
  EXPECT_EQ(against_fields(bad, fields).size(), 2u);
  EXPECT_EQ(fields, 3);
  const Source exempt = make_source("a.fbs", "struct S {\n  a:int;\n}\nenum E : ubyte { A }\n");
  EXPECT_THAT(against_fields(exempt, fields), testing::IsEmpty());
}

/// "Suite.Test" of every test of the tree.
static Names tests_of(const std::vector<Source>& sources) {
  static const std::regex kTest(R"(^\s*(?:TYPED_)?TEST(_F|_P)?\(\s*(\w+)\s*,\s*(\w+)\s*\))");
  Names tests;
  for (const Source& source : sources)
    for (const std::string& line : source.code) {
      std::smatch match;
      if (std::regex_search(line, match, kTest))
        tests.insert(match[2].str() + "." + match[3].str());
    }
  return tests;
}

/// Tests that a page names as `Suite.Test`, `Suite.Begins...` or `Suite.*`, and that are gone.
static Complaints against_claims(const Source& page, const Names& tests) {
  static const std::regex kClaim(R"(`([A-Z]\w+\.([A-Z]\w+(\.\.\.)?|\*))`)");
  Complaints complaints;
  for (const std::string& claim : names_in(page, kClaim)) {
    const std::string begin = claim.substr(0, claim.find_first_of("*", claim.find('.')));
    const bool open = claim.ends_with("*") || claim.ends_with("...");
    const std::string prefix = claim.ends_with("...") ? claim.substr(0, claim.size() - 3) : begin;
    const auto found = tests.lower_bound(prefix);
    const bool exists =
        found != tests.end() && (open ? found->starts_with(prefix) : *found == claim);
    if (!exists)
      complaints.push_back(page.path + " names the test " + claim +
                           ", which does not exist; name the one that shows it");
  }
  return complaints;
}

/// What headings of a page are called in links, as the hosts of repositories call them.
static Names anchors_of(const Source& page) {
  Names anchors;
  for (const std::string& line : page.lines) {
    const std::size_t begin = line.find_first_not_of('#');
    if (begin == 0 || begin == std::string::npos || line[begin] != ' ') continue;
    std::string anchor;
    for (const char letter : line.substr(begin + 1)) {
      const auto code = static_cast<unsigned char>(letter);
      if (letter == ' ') anchor += '-';
      if (std::isalnum(code) != 0 || letter == '-' || letter == '_')
        anchor += static_cast<char>(std::tolower(code));
    }
    anchors.insert(anchor);
  }
  return anchors;
}

/// Whether a link of this page, "file#heading", has either of them empty or there.
static bool leads_somewhere(const Source& page, const std::string& file,
                            const std::string& heading) {
  if (file.empty()) return anchors_of(page).contains(heading);
  const std::filesystem::path folder = std::filesystem::path(page.path).parent_path();
  const std::string path = (folder / file).lexically_normal().generic_string();
  if (!std::filesystem::exists(places::source(path))) return false;
  return heading.empty() || anchors_of(read_source(path)).contains(heading);
}

/// Links within the repository that lead nowhere: to no file, or to no heading of a page.
static Complaints against_links(const Source& page) {
  static const std::regex kLink(R"(\]\(([^)#:]*)(?:#([^)]*))?\))");
  Complaints complaints;
  for (const std::string& line : page.lines)
    for (std::sregex_iterator link(line.begin(), line.end(), kLink), end; link != end; ++link)
      if (!leads_somewhere(page, (*link)[1], (*link)[2]))
        complaints.push_back(page.path + " has the link " + link->str() + ", which leads nowhere");
  return complaints;
}

TEST(Pages, NameTestsAndFilesThatExist) {
  const Names tests = tests_of(sources());
  EXPECT_GT(tests.size(), 50u);
  for (const std::string& path : files_with({".md"})) {
    EXPECT_THAT(against_claims(read_source(path), tests), testing::IsEmpty());
    EXPECT_THAT(against_links(read_source(path)), testing::IsEmpty());
  }
}

TEST(Pages, ThatNameWhatIsGoneAreSeen) {
  const Names tests = tests_of({make_source("t.cpp", "TEST(Digest, IsSmall) {\n")});
  const auto complaints = [&](const char* text) {
    return against_claims(make_source("a.md", text), tests).size();
  };
  EXPECT_EQ(complaints("`Digest.IsSmall` `Digest.Is...` `Digest.*` `world.hpp` `World.step`"), 0u);
  EXPECT_EQ(complaints("`Digest.IsGone`"), 1u);
  EXPECT_EQ(complaints("`Digest.Are...` and `Snapshot.*`"), 2u);
  const auto dead_links = [](const char* text) {
    return against_links(make_source("a.md", text)).size();
  };
  EXPECT_EQ(dead_links("[x](docs/none.md) [y](docs/none.md#z)"), 2u);
  EXPECT_EQ(dead_links("[x](README.md) [y](README.md#two-commands) [z](https://a.b/c#d)"), 0u);
  EXPECT_EQ(dead_links("[x](README.md#no-commands)"), 1u);
  EXPECT_EQ(dead_links("## `One` thing, said\n[x](#one-thing-said) [y](#one)"), 1u);
}

}  // namespace cycloid::tidy
