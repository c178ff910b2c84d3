#ifdef CYCLOID_NETWORK

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/cli/program.hpp"

namespace cycloid::cli {
namespace {

using testing::HasSubstr;
using testing::MatchesRegex;

unsigned mode_of_file(const std::string& file) {
  struct stat status {};
  return ::stat(file.c_str(), &status) == 0 ? status.st_mode & 0777u : 0u;
}

std::string signed_for(const Folder& folder, const std::vector<std::string>& more = {}) {
  std::vector<std::string> words = {"token",  "make",  "--key",      folder.file("key"),
                                    "--room", "arena", "--identity", "ada"};
  words.insert(words.end(), more.begin(), more.end());
  const Ran ran = run_program(words);
  EXPECT_EQ(ran.exit, 0) << ran.err;
  return ran.out.substr(0, ran.out.find('\n'));
}

TEST(TokenCommand, KeygenWritesAPairThatOnlyItsOwnerCanSignWith) {
  const Folder folder;
  const Ran ran = run_program({"token", "keygen", folder.file("key"), "--json"});
  ASSERT_EQ(ran.exit, 0) << ran.err;
  EXPECT_EQ(mode_of_file(folder.file("key")), 0600u);
  EXPECT_EQ(ran.json()["public_key"], folder.file("key.pub"));
  EXPECT_THAT(read_text(folder.file("key")), MatchesRegex("ed25519-secret:[0-9a-f]{64}\n"));
  EXPECT_EQ(read_text(folder.file("key.pub")), ran.json()["public"].get<std::string>() + "\n");
  EXPECT_EQ(ran.out.find("secret"), std::string::npos);

  const std::string before = read_text(folder.file("key"));
  const Ran again = run_program({"token", "keygen", folder.file("key")});
  EXPECT_EQ(again.exit, 5);
  EXPECT_THAT(again.err, HasSubstr("key: exists already, and a key is never overwritten"));
  EXPECT_EQ(read_text(folder.file("key")), before);

  write_text(folder.file("other.pub"), "mine");
  EXPECT_EQ(run_program({"token", "keygen", folder.file("other")}).exit, 5);
  EXPECT_EQ(mode_of_file(folder.file("other")), 0u) << "half a pair was left";
  EXPECT_EQ(run_program({"token", "keygen", folder.file("none/key")}).exit, 5);
}

TEST(TokenCommand, ShowSaysWhatMakeWasAskedForAndWhetherAServerTakesIt) {
  const Folder folder;
  ASSERT_EQ(run_program({"token", "keygen", folder.file("key")}).exit, 0);
  ASSERT_EQ(run_program({"token", "keygen", folder.file("other")}).exit, 0);
  const std::string token = signed_for(folder, {"--seat", "3", "--lifetime", "120"});
  const Ran shown =
      run_program({"token", "show", token, "--key", folder.file("key.pub"), "--json"});
  ASSERT_EQ(shown.exit, 0) << shown.out << shown.err;
  EXPECT_EQ(shown.json()["room"], "arena");
  EXPECT_EQ(shown.json()["seat"], 3);
  EXPECT_EQ(shown.json()["role"], "player");
  EXPECT_EQ(shown.json()["identity"], "ada");
  EXPECT_EQ(shown.json()["verdict"], "good");
  EXPECT_EQ(shown.json()["expires"].get<std::int64_t>(),
            shown.json()["not_before"].get<std::int64_t>() + 120);
  EXPECT_NE(signed_for(folder), signed_for(folder));

  const Ran unknown = run_program({"token", "show", token, "--key", folder.file("other.pub")});
  EXPECT_EQ(unknown.exit, 3);
  EXPECT_THAT(unknown.out, HasSubstr("verdict the token names a key that is not known here"));
  const Ran both = run_program(
      {"token", "show", token, "--key", folder.file("other.pub"), "--key", folder.file("key.pub")});
  EXPECT_EQ(both.exit, 0);
  const Ran without = run_program({"token", "show", token});
  EXPECT_EQ(without.exit, 0);
  EXPECT_THAT(without.out, HasSubstr("verdict not verified"));

  const std::string old = signed_for(folder, {"--not-before", "1000000000"});
  const Ran expired = run_program({"token", "show", old, "--key", folder.file("key.pub")});
  EXPECT_EQ(expired.exit, 3);
  EXPECT_THAT(expired.out, HasSubstr("verdict the token expired at 1000000060"));
}

TEST(TokenCommand, MistakesNameTheirField) {
  const Folder folder;
  ASSERT_EQ(run_program({"token", "keygen", folder.file("key")}).exit, 0);
  const std::string key = folder.file("key");
  struct Case {
    std::vector<std::string> arguments;
    int exit;
    std::string words;
  };
  const std::vector<Case> cases = {
      {{"token"}, 2, "subcommand"},
      {{"token", "keygen"}, 2, "FILE"},
      {{"token", "make", "--room", "a"}, 2, "--key"},
      {{"token", "make", "--key", key}, 2, "--room"},
      {{"token", "make", "--key", key, "--room", ""}, 2, "room size is 0"},
      {{"token", "make", "--key", key, "--room", "a", "--seat", "256"},
       2,
       "--seat: Value 256 not in range -1 to 255"},
      {{"token", "make", "--key", key, "--room", "a", "--role", "king"}, 2, "king"},
      {{"token", "make", "--key", key, "--room", "a", "--lifetime", "0"}, 2, "--lifetime"},
      {{"token", "make", "--key", key, "--room", "a", "--lifetime", "86401"},
       2,
       "--lifetime: Value 86401 not in range 1 to 86400"},
      {{"token", "make", "--key", key, "--room", "a", "--lifetime", "9223372036854775807"},
       2,
       "--lifetime: Value 9223372036854775807 not in range"},
      {{"token", "make", "--key", key, "--room", "a", "--not-before", "9223372036854775807"},
       2,
       "--not-before: Value 9223372036854775807 not in range"},
      {{"token", "make", "--key", key, "--room", "a", "--role", "spectator", "--seat", "1"},
       2,
       "a spectator has none"},
      {{"token", "make", "--key", folder.file("none"), "--room", "a"}, 5, "none: cannot be"},
      {{"token", "make", "--key", key + ".pub", "--room", "a"}, 3, "is no signing key"},
      {{"token", "show", "!"}, 3, "TOKEN"},
      {{"token", "show", "AAAA"}, 3, "a token of 3 bytes, of 113 to 512"},
      {{"token", "show", "AAAA", "--key", key}, 3, "is no public key"},
  };
  for (const Case& wrong : cases) {
    const Ran ran = run_program(wrong.arguments);
    EXPECT_EQ(ran.exit, wrong.exit) << wrong.words << ran.err;
    EXPECT_THAT(ran.err, HasSubstr(wrong.words));
    EXPECT_EQ(ran.out, "") << wrong.words;
  }
}

TEST(TokenCommand, AKeyThatOthersCanReadIsRefused) {
  const Folder folder;
  ASSERT_EQ(run_program({"token", "keygen", folder.file("key")}).exit, 0);
  ASSERT_EQ(::chmod(folder.file("key").c_str(), 0640), 0);
  const Ran ran = run_program({"token", "make", "--key", folder.file("key"), "--room", "a"});
  EXPECT_EQ(ran.exit, 5);
  EXPECT_THAT(ran.err, HasSubstr("chmod 600"));
}

}  // namespace
}  // namespace cycloid::cli

#endif
