#include "server/config/config.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>

#include "server/config/run.hpp"
#include "tests/server/host_fixture.hpp"

namespace cycloid::server {
namespace {

using namespace std::chrono_literals;

scenes::Loaded load(const std::string& name) {
  if (name != "two-seats") return scenes::find(name);
  scenes::Loaded loaded;
  loaded.scene = two_seat_scene();
  return loaded;
}

constexpr const char* kRooms = R"(
[template.duel]
scene = "two-seats"
on_first_join = true

[[room]]
name = "arena"
template = "duel"
)";

/// A file that is gone with the test.
class ConfigFile {
 public:
  explicit ConfigFile(const std::string& what)
      : path_(testing::TempDir() + "cycloid-" + what + "-" + std::to_string(::getpid())) {}
  ~ConfigFile() { std::filesystem::remove(path_); }
  void write(const std::string& text) const { std::ofstream(path_) << text; }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

TEST(Config, WhatIsNotSaidIsAsDocumented) {
  const ConfigResult read = read_config(kRooms, load);
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
  const std::string text = std::string(R"(
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
)") + kRooms + "[template.slow]\nscene = \"two-seats\"\ntick_rate_hz = 0.5\nempty_ttl_s = 7\n";
  const ConfigResult read = read_config(text, load);
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
                                        load);
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

TEST(Config, WhatIsNotAsciiIsRefusedWithItsLine) {
  const ConfigResult read = read_config("[server]\n# caf\xc3\xa9\n", scenes::load);
  ASSERT_FALSE(read.config);
  ASSERT_EQ(read.mistakes.size(), 1u);
  EXPECT_EQ(read.mistakes[0].line, 2u);
  EXPECT_EQ(read.mistakes[0].reason.substr(0, 11), "a character");
}

TEST(Config, WhatIsNoTomlIsSaidWithItsLine) {
  for (const char* text : {"[server]\nport = \n", "[server]\nport = 1\nport = 2\n"}) {
    const ConfigResult read = read_config(text, load);
    ASSERT_EQ(read.mistakes.size(), 1u);
    EXPECT_GE(read.mistakes[0].line, 2u) << read.mistakes[0].reason;
    EXPECT_EQ(read.mistakes[0].reason.substr(0, 8), "not TOML");
  }
}

TEST(Config, TheAdminNeedsATokenAndStaysAtHome) {
  const ConfigFile token("token");
  const auto keys_of = [&](const std::string& rest) {
    const std::string text = "[admin]\ntoken_file = \"" + token.path() + "\"\n" + rest + kRooms;
    std::string keys;
    for (const ConfigMistake& mistake : read_config(text, load).mistakes) keys += mistake.key + " ";
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

TEST(Config, TokensNeedKeysAndTlsItsFiles) {
  const auto keys_of = [&](const std::string& head) {
    std::string keys;
    for (const ConfigMistake& mistake : read_config(head + kRooms, load).mistakes) {
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
  std::ifstream stream(std::string(CYCLOID_SOURCE_DIR) + "/docs/server.md");
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
    return *read_config(text + kRooms, load).config;
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

/// A configured server that runs beside the test.
class Configured {
 public:
  explicit Configured(const ConfigFile& file) {
    ConfiguredServer server;
    server.config = *read_config_file(file.path(), load).config;
    server.file = file.path();
    server.load_scene = load;
    server.config.host.logger = lines_.logger();
    std::promise<ListeningAt> at;
    auto listening = at.get_future();
    report_ = std::async(std::launch::async, [this, server, &at] {
      return run_configured(
          server, [&](const ListeningAt& where) { at.set_value(where); }, stop_.get_token());
    });
    at_ = listening.get();
  }
  ~Configured() { stop_.request_stop(); }
  const ListeningAt& at() const { return at_; }
  HostReport stop() {
    stop_.request_stop();
    return report_.get();
  }
  std::string lines() const { return lines_.text(); }

 private:
  HostLines lines_;
  std::stop_source stop_;
  std::future<HostReport> report_;
  ListeningAt at_;
};

TEST(ConfigReload, BySighupTakesLimitsAndRefusesAPortByName) {
  const ConfigFile file("reload");
  const std::string ports = "[server]\nport = 0\n[operation]\nport = 0\n";
  file.write(ports + kRooms);
  Configured server(file);
  HostPeer first(server.at().port);
  first.greet("duel:1");
  ASSERT_TRUE(first.wait_for<protocol::Welcome>());

  const auto reload = [&](const std::string& text) {
    file.write(text);
    ASSERT_EQ(::kill(::getpid(), SIGHUP), 0);
    std::this_thread::sleep_for(300ms);
  };
  reload("[server]\nport = 4711\n[operation]\nport = 0\n[limits]\nrooms = 1\n" +
         std::string(kRooms));
  HostPeer second(server.at().port);  // The old limit still holds: nothing was taken.
  second.greet("duel:2");
  ASSERT_TRUE(second.wait_for<protocol::Welcome>());
  reload("[server\n");
  reload(ports + "[limits]\nrooms = 1\n" + kRooms);
  HostPeer third(server.at().port);
  third.greet("duel:3");
  const auto refused = third.wait_for<protocol::Refused>();
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->code, protocol::Refusal::kRoomFull);
  first.hang_up();
  second.hang_up();
  EXPECT_TRUE(server.stop().good);
  const std::string lines = server.lines();
  EXPECT_NE(lines.find("cannot change while the server runs: server.port"), std::string::npos)
      << lines;
  EXPECT_NE(lines.find("not TOML"), std::string::npos) << lines;
  EXPECT_NE(lines.find("reloaded " + file.path()), std::string::npos) << lines;
}

}  // namespace
}  // namespace cycloid::server
