#include <chrono>
#include <cmath>
#include <utility>

#include "server/config/key_makers.hpp"

namespace cycloid::server {
namespace {

using Kind = ConfigKind;
using Key = ConfigKey<ServerConfig>;

using config_keys_of::as;
using config_keys_of::integer;
using config_keys_of::kManySeconds;
using config_keys_of::Value;

Key text(const char* name, const char* otherwise, bool reloads,
         void (*put)(ServerConfig&, const Value&)) {
  return {name, Kind::kText, 0, 0, otherwise, {}, reloads, put};
}

Key flag(const char* name, const char* otherwise, void (*put)(ServerConfig&, const Value&)) {
  return {name, Kind::kFlag, 0, 0, otherwise, {}, false, put};
}

ConfigSection server_section() {
  using C = ServerConfig;
  return {
      "server",
      {text("address", "127.0.0.1", false, [](C& c, const Value& v) { c.host.address = v.text; }),
       integer("port", 0, 65535, "7777", false,
               [](C& c, const Value& v) { c.host.port = as<std::uint16_t>(v); }),
       integer("threads", 1, 64, "2", false,
               [](C& c, const Value& v) { c.host.threads = as<int>(v); }),
       flag("realtime", "false", [](C& c, const Value& v) { c.host.realtime = v.flag; }),
       integer("drain_s", 0, kManySeconds, "10", true,
               [](C& c, const Value& v) { c.host.drain = std::chrono::seconds(v.integer); }),
       Key{"log_level",
           Kind::kText,
           0,
           0,
           "info",
           {"debug", "info", "warn", "error"},
           true,
           [](C& c, const Value& v) { c.log_level = v.text; }}}};
}

ConfigSection sockets_section() {
  using C = ServerConfig;
  return {"sockets",
          {integer("send_buffer_bytes", 4096, 16777216, "262144", false,
                   [](C& c, const Value& v) { c.host.sockets.send_buffer_bytes = as<int>(v); }),
           integer("keep_alive_s", 1, 3600, "15", false,
                   [](C& c, const Value& v) {
                     c.host.sockets.keep_alive = std::chrono::seconds(v.integer);
                   }),
           integer("user_timeout_ms", 1000, 3600000, "20000", false, [](C& c, const Value& v) {
             c.host.sockets.user_timeout = std::chrono::milliseconds(v.integer);
           })}};
}

ConfigSection operation_section() {
  using C = ServerConfig;
  return {
      "operation",
      {flag("enabled", "true", [](C& c, const Value& v) { c.operation_on = v.flag; }),
       text("address", "127.0.0.1", false,
            [](C& c, const Value& v) { c.operation.address = v.text; }),
       integer("port", 0, 65535, "7778", false,
               [](C& c, const Value& v) { c.operation.port = as<std::uint16_t>(v); }),
       integer("missed_ticks", 1, 100000, "60", false,
               [](C& c, const Value& v) { c.operation.missed_ticks_max = as<std::uint32_t>(v); }),
       text("desync_directory", "", false,
            [](C& c, const Value& v) { c.host.desync_directory = v.text; })}};
}

ConfigSection admin_section() {
  using C = ServerConfig;
  return {"admin",
          {text("token_file", "", false, [](C& c, const Value& v) { c.admin_token_file = v.text; }),
           flag("remote", "false", [](C& c, const Value& v) { c.admin_remote = v.flag; }),
           text("snapshot_directory", "", false,
                [](C& c, const Value& v) { c.snapshot_directory = v.text; })}};
}

ConfigSection admission_section() {
  using C = ServerConfig;
  return {"admission",
          {Key{"tokens",
               Kind::kText,
               0,
               0,
               "ignored",
               {"ignored", "optional", "required"},
               false,
               [](C& c, const Value& v) {
                 c.host.gate.tokens = v.text == "required"   ? TokenPolicy::kRequired
                                      : v.text == "optional" ? TokenPolicy::kOptional
                                                             : TokenPolicy::kIgnored;
               }},
           text("keys_file", "", true, [](C& c, const Value& v) { c.token_keys_file = v.text; }),
           integer("leeway_s", 0, 3600, "30", false,
                   [](C& c, const Value& v) { c.host.gate.leeway_s = v.integer; })}};
}

ConfigSection tls_section() {
  using C = ServerConfig;
  return {"tls",
          {Key{"mode",
               Kind::kText,
               0,
               0,
               "off",
               {"off", "required"},
               false,
               [](C& c, const Value& v) { c.tls_required = v.text == "required"; }},
           text("certificate_file", "", false,
                [](C& c, const Value& v) { c.tls_files.certificate_chain = v.text; }),
           text("key_file", "", false,
                [](C& c, const Value& v) { c.tls_files.private_key = v.text; })}};
}

SlowPeer slow_peer_of(const std::string& word) {
  if (word == "wait") return SlowPeer::kWait;
  if (word == "spectate") return SlowPeer::kSpectate;
  return word == "drop" ? SlowPeer::kDrop : SlowPeer::kReplace;
}

WhenMissing when_missing_of(const std::string& word) {
  if (word == "neutral") return WhenMissing::kNeutral;
  if (word == "wait-repeat") return WhenMissing::kWaitThenRepeat;
  return word == "wait-neutral" ? WhenMissing::kWaitThenNeutral : WhenMissing::kRepeat;
}

using TemplateKeys = std::vector<ConfigKey<RoomTemplate>>;

struct KeyRange {
  double least;
  double most;
};

/// A key of a template; none of them changes while a server runs.
ConfigKey<RoomTemplate> key(const char* name, Kind kind, KeyRange range, const char* otherwise,
                            std::vector<std::string> choices,
                            void (*put)(RoomTemplate&, const Value&)) {
  return {name, kind, range.least, range.most, otherwise, std::move(choices), false, put};
}

/// What the match is, and what is left of it.
TemplateKeys match_keys() {
  using T = RoomTemplate;
  return {
      key("scene", Kind::kNeededText, {0, 0}, "", {},
          [](T& t, const Value& v) { t.settings.scene_name = v.text; }),
      key("on_first_join", Kind::kFlag, {0, 0}, "false", {},
          [](T& t, const Value& v) { t.on_first_join = v.flag; }),
      key("empty_ttl_s", Kind::kInteger, {0, kManySeconds}, "0", {},
          [](T& t, const Value& v) { t.settings.empty_ttl = std::chrono::seconds(v.integer); }),
      key("tick_rate_hz", Kind::kNumber, {0, 10000}, "0", {},
          [](T& t, const Value& v) {
            t.settings.tick_rate_millihertz =
                static_cast<std::uint32_t>(std::lround(v.number * 1000.0));
          }),
      key("ticks", Kind::kInteger, {0, 1e15}, "0", {},
          [](T& t, const Value& v) { t.settings.ticks = as<std::uint64_t>(v); }),
      key("workers", Kind::kInteger, {1, 64}, "1", {},
          [](T& t, const Value& v) { t.settings.workers = as<int>(v); }),
      key("log_directory", Kind::kText, {0, 0}, "", {},
          [](T& t, const Value& v) { t.settings.log_directory = v.text; }),
      key("log_sync", Kind::kText, {0, 0}, "interval", {kLogSyncNames.begin(), kLogSyncNames.end()},
          [](T& t, const Value& v) { t.settings.log_sync = log_sync_of(v.text); }),
      key("stop_on_log_error", Kind::kFlag, {0, 0}, "false", {},
          [](T& t, const Value& v) { t.settings.stop_on_log_error = v.flag; })};
}

/// What becomes of inputs that are not there.
TemplateKeys input_keys() {
  using T = RoomTemplate;
  return {
      key("slow_peer", Kind::kText, {0, 0}, "replace", {"wait", "replace", "spectate", "drop"},
          [](T& t, const Value& v) { t.settings.slow = slow_peer_of(v.text); }),
      key("when_missing", Kind::kText, {0, 0}, "repeat",
          {"repeat", "neutral", "wait-repeat", "wait-neutral"},
          [](T& t, const Value& v) {
            t.settings.policy.axes.fill(when_missing_of(v.text));
            t.settings.policy.buttons.fill(when_missing_of(v.text));
          }),
      key("wait_ticks", Kind::kInteger, {0, 1000}, "3", {},
          [](T& t, const Value& v) { t.settings.policy.wait_ticks_max = as<std::uint32_t>(v); }),
      key("one_shot_buttons", Kind::kInteger, {0, 65535}, "0", {},
          [](T& t, const Value& v) { t.settings.policy.one_shot_buttons = as<std::uint16_t>(v); }),
      key("adaptive_delay", Kind::kFlag, {0, 0}, "false", {},
          [](T& t, const Value& v) { t.settings.delay.adaptive = v.flag; }),
      key("spectator_delay_ticks", Kind::kInteger, {0, 1000000}, "0", {},
          [](T& t, const Value& v) { t.settings.spectator_delay_ticks = as<std::uint64_t>(v); })};
}

}  // namespace

const std::vector<ConfigSection>& config_sections() {
  static const std::vector<ConfigSection> kSections = {
      server_section(), sockets_section(),   config_limits(), admission_section(),
      tls_section(),    operation_section(), admin_section()};
  return kSections;
}

const std::vector<ConfigKey<RoomTemplate>>& config_template_keys() {
  static const TemplateKeys kKeys = [] {
    TemplateKeys keys = match_keys();
    const TemplateKeys more = input_keys();
    keys.insert(keys.end(), more.begin(), more.end());
    return keys;
  }();
  return kKeys;
}

const std::vector<ConfigKey<ConfigRoom>>& config_room_keys() {
  static const std::vector<ConfigKey<ConfigRoom>> kKeys = {
      {"name",
       Kind::kNeededText,
       0,
       0,
       "",
       {},
       false,
       [](ConfigRoom& r, const Value& v) { r.name = v.text; }},
      {"template",
       Kind::kNeededText,
       0,
       0,
       "",
       {},
       false,
       [](ConfigRoom& r, const Value& v) { r.of_template = v.text; }},
  };
  return kKeys;
}

}  // namespace cycloid::server
