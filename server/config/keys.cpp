#include "server/config/keys.hpp"

#include <chrono>
#include <cmath>

namespace cycloid::server {
namespace {

using Kind = ConfigKind;
using Value = ConfigValue;
using Key = ConfigKey<ServerConfig>;

constexpr double kManySeconds = 86400.0;
constexpr double kMany = 1'000'000'000.0;

template <class Number>
Number as(const Value& value) {
  return static_cast<Number>(value.integer);
}

std::chrono::milliseconds milliseconds(const Value& value) {
  return std::chrono::milliseconds(value.integer);
}

Key integer(const char* name, double least, double most, const char* otherwise, bool reloads,
            void (*put)(ServerConfig&, const Value&)) {
  return {name, Kind::kInteger, least, most, otherwise, {}, reloads, put};
}

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
           integer("user_timeout_ms", 1000, 3600000, "20000", false,
                   [](C& c, const Value& v) { c.host.sockets.user_timeout = milliseconds(v); })}};
}

ConfigSection operation_section() {
  using C = ServerConfig;
  return {"operation",
          {flag("enabled", "true", [](C& c, const Value& v) { c.operation_on = v.flag; }),
           text("address", "127.0.0.1", false,
                [](C& c, const Value& v) { c.operation.address = v.text; }),
           integer("port", 0, 65535, "7778", false,
                   [](C& c, const Value& v) { c.operation.port = as<std::uint16_t>(v); }),
           integer("missed_ticks", 1, 100000, "60", false, [](C& c, const Value& v) {
             c.operation.missed_ticks_max = as<std::uint32_t>(v);
           })}};
}

ConfigSection admin_section() {
  using C = ServerConfig;
  return {"admin",
          {text("token_file", "", false, [](C& c, const Value& v) { c.admin_token_file = v.text; }),
           flag("remote", "false", [](C& c, const Value& v) { c.admin_remote = v.flag; }),
           text("snapshot_directory", "", false,
                [](C& c, const Value& v) { c.snapshot_directory = v.text; })}};
}

ConfigSection limits_section() {
  using C = ServerConfig;
  return {
      "limits",
      {integer("connections", 1, 1000000, "16384", false,
               [](C& c, const Value& v) { c.host.gate.connections_max = as<std::size_t>(v); }),
       integer("pending", 1, 1000000, "12000", false,
               [](C& c, const Value& v) { c.host.gate.pending_max = as<std::size_t>(v); }),
       integer("hello_ms", 1, 600000, "5000", false,
               [](C& c, const Value& v) { c.host.gate.hello_deadline_ns = v.integer * 1'000'000; }),
       integer("address_connections", 1, 1000000, "64", false,
               [](C& c, const Value& v) {
                 c.host.gate.addresses.host_connections_max = as<std::uint32_t>(v);
               }),
       integer("address_pending", 1, 1000000, "16", false,
               [](C& c, const Value& v) {
                 c.host.gate.addresses.host_pending_max = as<std::uint32_t>(v);
               }),
       integer("rooms", 1, 100000, "256", true,
               [](C& c, const Value& v) { c.host.limits.rooms_max = as<std::size_t>(v); }),
       integer(
           "room_connections", 1, 1000000, "1024", true,
           [](C& c, const Value& v) { c.host.limits.room.connections_max = as<std::size_t>(v); }),
       integer("messages_per_tick", 1, kMany, "64", true,
               [](C& c, const Value& v) {
                 c.host.limits.room.messages_per_tick_max = as<std::uint32_t>(v);
               }),
       integer(
           "queue_bytes", 4096, kMany, "1048576", true,
           [](C& c, const Value& v) { c.host.limits.room.queue_bytes_max = as<std::size_t>(v); }),
       integer(
           "idle_s", 1, kManySeconds, "30", true,
           [](C& c, const Value& v) { c.host.limits.room.idle = std::chrono::seconds(v.integer); }),
       integer("catch_up_ticks", 1, 10000, "8", true,
               [](C& c, const Value& v) {
                 c.host.limits.room.catch_up_ticks_max = as<std::uint32_t>(v);
               }),
       integer(
           "digest_ticks", 1, 1000000, "60", false,
           [](C& c, const Value& v) { c.host.limits.room.digest_ticks = as<std::uint64_t>(v); }),
       integer(
           "snapshot_ticks", 1, 1000000, "3", false,
           [](C& c, const Value& v) { c.host.limits.room.snapshot_ticks = as<std::uint64_t>(v); }),
       integer("input_delay_ticks", 1, 60, "2", false, [](C& c, const Value& v) {
         c.host.limits.room.input_delay_ticks = as<std::uint32_t>(v);
       })}};
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

}  // namespace

const std::vector<ConfigSection>& config_sections() {
  static const std::vector<ConfigSection> kSections = {
      server_section(), sockets_section(),   limits_section(), admission_section(),
      tls_section(),    operation_section(), admin_section()};
  return kSections;
}

const std::vector<ConfigKey<RoomTemplate>>& config_template_keys() {
  using T = RoomTemplate;
  static const std::vector<ConfigKey<T>> kKeys = {
      {"scene",
       Kind::kNeededText,
       0,
       0,
       "",
       {},
       false,
       [](T& t, const Value& v) { t.settings.scene_name = v.text; }},
      {"on_first_join",
       Kind::kFlag,
       0,
       0,
       "false",
       {},
       false,
       [](T& t, const Value& v) { t.on_first_join = v.flag; }},
      {"empty_ttl_s",
       Kind::kInteger,
       0,
       kManySeconds,
       "0",
       {},
       false,
       [](T& t, const Value& v) { t.settings.empty_ttl = std::chrono::seconds(v.integer); }},
      {"tick_rate_hz",
       Kind::kNumber,
       0,
       10000,
       "0",
       {},
       false,
       [](T& t, const Value& v) {
         t.settings.tick_rate_millihertz =
             static_cast<std::uint32_t>(std::lround(v.number * 1000.0));
       }},
      {"ticks",
       Kind::kInteger,
       0,
       1e15,
       "0",
       {},
       false,
       [](T& t, const Value& v) { t.settings.ticks = as<std::uint64_t>(v); }},
      {"workers",
       Kind::kInteger,
       1,
       64,
       "1",
       {},
       false,
       [](T& t, const Value& v) { t.settings.workers = as<int>(v); }},
      {"log_directory",
       Kind::kText,
       0,
       0,
       "",
       {},
       false,
       [](T& t, const Value& v) { t.settings.log_directory = v.text; }},
      {"log_sync",
       Kind::kText,
       0,
       0,
       "interval",
       {"interval", "tick"},
       false,
       [](T& t, const Value& v) {
         t.settings.log_sync = v.text == "tick" ? LogSync::kEveryTick : LogSync::kInterval;
       }},
      {"stop_on_log_error",
       Kind::kFlag,
       0,
       0,
       "false",
       {},
       false,
       [](T& t, const Value& v) { t.settings.stop_on_log_error = v.flag; }},
  };
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
