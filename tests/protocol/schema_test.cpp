#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>

#include "tests/places.hpp"

namespace cycloid::protocol {
namespace {

const std::filesystem::path kSchemas = places::source("protocol/schema");
const char* const kFiles[] = {"common.fbs", "client_message.fbs", "server_message.fbs"};

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// Whether peers that speak `schema` still understand those that speak the released one.
bool conforms(const std::filesystem::path& schema, const std::string& released) {
  const std::string command = "flatc -I '" + schema.parent_path().string() +
                              "' --conform-includes '" + (kSchemas / "released").string() +
                              "' --conform '" + (kSchemas / "released" / released).string() +
                              "' '" + schema.string() + "' > /dev/null 2>&1";
  return std::system(command.c_str()) == 0;
}

/// The released file with one edit, checked against itself.
bool conforms_after(const char* file, const std::string& from, const std::string& to) {
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) /
      ("schema-" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
  std::filesystem::create_directories(folder);
  for (const char* name : kFiles) {
    std::string text = text_of(kSchemas / "released" / name);
    if (std::string(name) == file) {
      const std::size_t at = text.find(from);
      EXPECT_NE(at, std::string::npos) << from;
      if (at != std::string::npos) text.replace(at, from.size(), to);
    }
    std::ofstream(folder / name) << text;
  }
  const bool result = conforms(folder / file, file);
  std::filesystem::remove_all(folder);
  return result;
}

TEST(Schema, ConformsToTheReleasedOne) {
  for (const char* file : kFiles) EXPECT_TRUE(conforms(kSchemas / file, file)) << file;
}

TEST(Schema, ConformanceAcceptsAnAppendedField) {
  EXPECT_TRUE(conforms_after("client_message.fbs", "name:string (id: 5);",
                             "name:string (id: 5);\n  build:string (id: 6);"));
}

TEST(Schema, ConformanceRejectsAReusedId) {
  EXPECT_FALSE(
      conforms_after("client_message.fbs", "name:string (id: 5);", "strength:uint64 (id: 5);"));
}

TEST(Schema, ConformanceRejectsAChangedDefault) {
  EXPECT_FALSE(conforms_after("client_message.fbs", "seat_wish:int32 = -1", "seat_wish:int32 = 0"));
}

TEST(Schema, ConformanceRejectsAMovedEnumerator) {
  EXPECT_FALSE(
      conforms_after("server_message.fbs", "Given = 1, Repeated = 2", "Repeated = 1, Given = 2"));
}

TEST(Schema, EveryTableFieldHasAnIdAndEveryEnumAnUnknown) {
  const std::regex table(R"(table \w+ \{([^}]*)\})");
  const std::regex field(R"(^\s*\w+:[^;]*;)", std::regex::multiline);
  const std::regex enumeration(R"(enum \w+ : ubyte \{([^}]*)\})");
  for (const char* file : kFiles) {
    const std::string text = text_of(kSchemas / file);
    int tables = 0;
    for (std::sregex_iterator it(text.begin(), text.end(), table), end; it != end; ++it, ++tables) {
      const std::string body = (*it)[1];
      for (std::sregex_iterator at(body.begin(), body.end(), field); at != end; ++at) {
        EXPECT_NE(at->str().find("(id: "), std::string::npos) << file << ": " << at->str();
      }
    }
    EXPECT_GT(tables, 0) << file;
    for (std::sregex_iterator it(text.begin(), text.end(), enumeration), end; it != end; ++it) {
      EXPECT_NE((*it)[1].str().find("Unknown = 0"), std::string::npos) << file << ": " << it->str();
    }
  }
}

}  // namespace
}  // namespace cycloid::protocol
