#include "server/config/config.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>

#include "tests/places.hpp"
#include "tests/server/config_fixture.hpp"

namespace cycloid::server {
namespace {

using namespace std::chrono_literals;

TEST(Config, WhatIsNotSaidIsAsDocumented) {
  const ConfigResult read = read_config(kConfigRooms, load_for_test);
  ASSERT_TRUE(read.config) << config_mistakes_text("f", read.mistakes);
  EXPECT_EQ(read.config->host.port, 7777);
  EXPECT_EQ(read.config->host.threads, 2);
  EXPECT_EQ(read.config->host.drain, 10s);
  ASSERT_EQ(read.config->host.rooms.size(), 1u);
  EXPECT_EQ(read.config->host.rooms[0].name, "arena");
  EXPECT_TRUE(read.config->host.templates.at("duel").on_first_join);
  EXPECT_FALSE(read.config->operation.admin);
}

TEST(Config, WhatIsSaidIsTaken) {
  const std::string text =
      std::string(R"(
[server]
port = 0
threads = 3
drain_s = 4
log_level = "warn"
[limits]
rooms = 9
queue_bytes = 8192
[operation]
missed_ticks = 12
)") + kConfigRooms +
      "[template.slow]\nscene = \"two-seats\"\ntick_rate_hz = 0.5\nempty_ttl_s = 7\n" +
      "log_sync = \"none\"\n";
  const ConfigResult read = read_config(text, load_for_test);
  ASSERT_TRUE(read.config) << config_mistakes_text("f", read.mistakes);
  EXPECT_EQ(read.config->host.threads, 3);
  EXPECT_EQ(read.config->host.drain, 4s);
  EXPECT_EQ(read.config->log_level, "warn");
  EXPECT_EQ(read.config->host.limits.rooms_max, 9u);
  EXPECT_EQ(read.config->host.limits.room.queue_bytes_max, 8192u);
  EXPECT_EQ(read.config->operation.missed_ticks_max, 12u);
  const RoomSettings& slow = read.config->host.templates.at("slow").settings;
  EXPECT_EQ(slow.tick_rate_millihertz, 500u);
  EXPECT_EQ(slow.empty_ttl, 7s);
  EXPECT_EQ(slow.log_sync, LogSync::kNone);
}

TEST(Config, EveryMistakeIsNamedWithItsLineAndKey) {
  const ConfigResult read = read_config(R"([server]
port = 70000
threads = "two"
adress = "x"
address = "nowhere"
log_level = "loud"
[limits]
queue_bytes = 1.5
[sever]
x = 1
[template.duel]
scene = "no-such-scene"
[template."a b"]
scene = "two-seats"
[template.none]
ticks = -1
[[room]]
name = "arena"
template = "duet"
[[room]]
name = "arena"
)",
                                        load_for_test);
  ASSERT_FALSE(read.config);
  std::map<std::string, std::uint32_t> seen;
  for (const ConfigMistake& mistake : read.mistakes) {
    EXPECT_FALSE(mistake.reason.empty());
    seen[mistake.key] = mistake.line;
  }
  const std::map<std::string, std::uint32_t> kExpected = {{"server.port", 2},
                                                          {"server.threads", 3},
                                                          {"server.adress", 4},
                                                          {"server.address", 5},
                                                          {"server.log_level", 6},
                                                          {"limits.queue_bytes", 8},
                                                          {"sever", 9},
                                                          {"template.duel.scene", 12},
                                                          {"template.a b", 13},
                                                          {"template.none.scene", 15},
                                                          {"template.none.ticks", 16},
                                                          {"room.0.template", 19},
                                                          {"room.1.template", 20},
                                                          {"room", 0}};
  EXPECT_EQ(seen, kExpected) << config_mistakes_text("file", read.mistakes);
}

TEST(Config, RoomsThatAnybodyMakesEndWhenTheyAreEmpty) {
  const ConfigResult read =
      read_config("[template.duel]\nscene = \"two-seats\"\non_first_join = true\n", load_for_test);
  ASSERT_EQ(read.mistakes.size(), 1u);
  EXPECT_EQ(read.mistakes[0].key, "template.duel.empty_ttl_s");
}

TEST(Config, ANetworkHasRoomForOneOfItsHosts) {
  const auto limits_of = [](const std::string& text) {
    return read_config(text + kConfigRooms, load_for_test).config->host.gate.addresses;
  };
  EXPECT_EQ(limits_of("").network_connections_max, 512u);
  const auto wide = limits_of("[limits]\naddress_connections = 2000\n");
  EXPECT_EQ(wide.host_connections_max, 2000u);
  EXPECT_EQ(wide.network_connections_max, 2000u);
}

TEST(Config, AFolderIsNoFileAndNoReasonToEnd) {
  const ConfigResult read = read_config_file(testing::TempDir(), load_for_test);
  ASSERT_EQ(read.mistakes.size(), 1u);
  EXPECT_EQ(read.mistakes[0].reason, "the file cannot be read");
  std::string mistake;
  EXPECT_EQ(read_admin_token(testing::TempDir(), mistake), "");
  EXPECT_EQ(mistake, testing::TempDir() + ": cannot be read");
}

TEST(Config, AFileWithoutAnEndIsNotReadToIt) {
  std::string mistake;
  EXPECT_EQ(read_admin_token("/dev/zero", mistake), "");
  EXPECT_EQ(mistake, "/dev/zero: cannot be read");
  const ConfigResult read = read_config(
      std::string("[admission]\nkeys_file = \"/dev/zero\"\n") + kConfigRooms, load_for_test);
  EXPECT_EQ(config_mistakes_text("f", read.mistakes),
            "f:2: admission.keys_file: /dev/zero: cannot be read");
}

TEST(Config, ANameThatNoFolderCanHaveIsNoReasonToEnd) {
  const std::string text = "[template.long]\nscene = \"two-seats\"\nlog_directory = \"" +
                           std::string(5000, 'x') + "\"\n" + kConfigRooms;
  const ConfigResult read = read_config(text, load_for_test);
  ASSERT_EQ(read.mistakes.size(), 1u);
  EXPECT_EQ(read.mistakes[0].key, "template.long.log_directory");
}

TEST(Config, ATickRateThatWouldRoundToTheScenesIsRefused) {
  const auto read_rate = [](const char* rate) {
    return read_config("[template.slow]\nscene = \"two-seats\"\ntick_rate_hz = " +
                           std::string(rate) + "\n" + kConfigRooms,
                       load_for_test);
  };
  for (const char* rate : {"0.0001", "0.0009", "1e-300"}) {
    const ConfigResult read = read_rate(rate);
    ASSERT_EQ(read.mistakes.size(), 1u) << rate;
    EXPECT_EQ(read.mistakes[0].key, "template.slow.tick_rate_hz");
    EXPECT_EQ(read.mistakes[0].line, 3u);
    EXPECT_EQ(read.mistakes[0].reason, "it is not 0 and less than 0.001");
  }
  for (const char* rate : {"0", "0.0", "0.001", "60"}) EXPECT_TRUE(read_rate(rate).config) << rate;
}

TEST(Config, WhatIsNotAsciiIsRefusedWithItsLine) {
  const ConfigResult read = read_config("[server]\n# caf\xc3\xa9\n", load_for_test);
  ASSERT_FALSE(read.config);
  ASSERT_EQ(read.mistakes.size(), 1u);
  EXPECT_EQ(read.mistakes[0].line, 2u);
  EXPECT_EQ(read.mistakes[0].reason.substr(0, 11), "a character");
}

TEST(Config, WhatIsNoTomlIsSaidWithItsLine) {
  for (const char* text : {"[server]\nport = \n", "[server]\nport = 1\nport = 2\n", "\n[=]\n",
                           "\n[[ #]]\n", "\n[server.=]\n"}) {
    const ConfigResult read = read_config(text, load_for_test);
    ASSERT_EQ(read.mistakes.size(), 1u);
    EXPECT_GE(read.mistakes[0].line, 2u) << read.mistakes[0].reason;
    EXPECT_EQ(read.mistakes[0].reason.substr(0, 8), "not TOML");
  }
}

TEST(Config, TheAdminNeedsATokenAndStaysAtHome) {
  const ConfigFile token("token");
  const auto keys_of = [&](const std::string& rest) {
    const std::string text =
        "[admin]\ntoken_file = \"" + token.path() + "\"\n" + rest + kConfigRooms;
    std::string keys;
    for (const ConfigMistake& mistake : read_config(text, load_for_test).mistakes)
      keys += mistake.key + " ";
    return keys;
  };
  EXPECT_EQ(keys_of(""), "admin.token_file ");  // It is not there.
  token.write("short\n");
  EXPECT_EQ(keys_of(""), "admin.token_file ");
  token.write("0123456789abcdef\n");
  EXPECT_EQ(keys_of(""), "");
  EXPECT_EQ(keys_of("[operation]\naddress = \"0.0.0.0\"\n"), "operation.address ");
  EXPECT_EQ(keys_of("remote = true\n[operation]\naddress = \"0.0.0.0\"\n"), "");
  EXPECT_EQ(keys_of("[operation]\nenabled = false\n"), "admin.token_file ");
  EXPECT_EQ(keys_of("snapshot_directory = \"/no/such\"\n"), "admin.snapshot_directory ");
}

TEST(Config, AnOperationAddressOfIpv6NeedsALibraryThatKnowsIt) {
  const auto mistakes = [](const std::string& enabled) {
    const std::string text = "[operation]\naddress = \"::1\"\nenabled = " + enabled + "\n";
    return read_config(text + kConfigRooms, load_for_test).mistakes;
  };
  EXPECT_TRUE(mistakes("false").empty());
  const auto found = mistakes("true");
  ASSERT_EQ(found.size(), HttpServer::knows_ipv6() ? 0u : 1u);
  if (found.empty()) return;
  EXPECT_EQ(found[0].key, "operation.address");
  EXPECT_NE(found[0].reason.find("IPv6"), std::string::npos) << found[0].reason;
}

TEST(Config, TokensNeedKeysAndTlsItsFiles) {
  const auto keys_of = [&](const std::string& head) {
    std::string keys;
    for (const ConfigMistake& mistake : read_config(head + kConfigRooms, load_for_test).mistakes) {
      keys += mistake.key + " ";
    }
    return keys;
  };
  EXPECT_EQ(keys_of("[admission]\ntokens = \"required\"\n"), "admission.keys_file ");
  EXPECT_EQ(keys_of("[admission]\ntokens = \"maybe\"\n"), "admission.tokens ");
  EXPECT_EQ(keys_of("[tls]\nmode = \"required\"\n"), "tls.certificate_file tls.key_file ");
  const ConfigFile keys("keys");
  const std::string named = "[admission]\nkeys_file = \"" + keys.path() + "\"\n";
  EXPECT_EQ(keys_of(named), "admission.keys_file ");
  keys.write("# none\n");
  EXPECT_EQ(keys_of(named), "admission.keys_file ");
  keys.write("ed25519-public:" + std::string(64, '1') + "\n");
  EXPECT_EQ(keys_of(named), "");
  keys.write("ed25519-public:12\n");
  EXPECT_EQ(keys_of(named), "admission.keys_file ");
}

TEST(Config, TheDocumentListsEveryKey) {
  std::ifstream stream(places::source("docs/server.md"));
  std::string line;
  std::map<std::string, std::string> listed;
  const std::regex kRow(R"(^\| `([a-zA-Z_.]+)` \| ([^|]*) \| ([^|]*) \| ([^|]*) \|.*)");
  while (std::getline(stream, line)) {
    std::smatch match;
    if (std::regex_match(line, match, kRow)) {
      listed[match[1]] = match[2].str() + "|" + match[3].str() + "|" + match[4].str();
    }
  }
  std::map<std::string, std::string> known;
  for (const ConfigKeyText& key : config_keys()) {
    const std::string otherwise = key.otherwise.empty()       ? "none"
                                  : key.otherwise == "needed" ? "needed"
                                                              : key.otherwise;
    known[key.name] = key.range + "|" + otherwise + "|" + (key.reloads ? "yes" : "no");
  }
  EXPECT_EQ(listed, known);
}

TEST(ConfigReload, TakesWhatIsSafeAndNothingElse) {
  const auto read = [](const std::string& text) {
    return *read_config(text + kConfigRooms, load_for_test).config;
  };
  const ServerConfig running = read("[server]\nport = 1\n");
  EXPECT_TRUE(fixed_differences(running, running).empty());
  EXPECT_TRUE(
      fixed_differences(running, read("[server]\nport = 1\nlog_level = \"warn\"\n")).empty());
  EXPECT_TRUE(
      fixed_differences(running, read("[server]\nport = 1\n[limits]\nrooms = 3\n")).empty());
  using Keys = std::vector<std::string>;
  EXPECT_EQ(fixed_differences(running, read("[server]\nport = 2\nthreads = 4\n")),
            (Keys{"server.port", "server.threads"}));
  const Keys added = fixed_differences(
      running, read("[server]\nport = 1\n[template.new]\nscene = \"two-seats\"\nticks = 5\n"));
  EXPECT_EQ(std::ranges::count(added, "template.new.scene"), 1);
  EXPECT_EQ(std::ranges::count(added, "template.new.ticks"), 1);
  for (const std::string& key : added) EXPECT_TRUE(key.starts_with("template.new.")) << key;
}

}  // namespace
}  // namespace cycloid::server
