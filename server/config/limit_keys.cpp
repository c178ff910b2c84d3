#include <algorithm>
#include <chrono>

#include "server/config/key_makers.hpp"

namespace cycloid::server {

using config_keys_of::as;
using config_keys_of::integer;
using config_keys_of::kMany;
using config_keys_of::kManySeconds;
using config_keys_of::Value;

namespace {

using Keys = std::vector<ConfigKey<ServerConfig>>;

/// Of the process and its gate.
Keys process_limits() {
  using C = ServerConfig;
  return {
      integer("connections", 1, 1000000, "16384", true,
              [](C& c, const Value& v) { c.host.gate.connections_max = as<std::size_t>(v); }),
      integer("pending", 1, 1000000, "12000", true,
              [](C& c, const Value& v) { c.host.gate.pending_max = as<std::size_t>(v); }),
      integer("hello_ms", 1, 600000, "5000", false,
              [](C& c, const Value& v) { c.host.gate.hello_deadline_ns = v.integer * 1'000'000; }),
      integer("address_connections", 1, 1000000, "64", true,
              [](C& c, const Value& v) {
                AddressLimitOptions& addresses = c.host.gate.addresses;
                addresses.host_connections_max = as<std::uint32_t>(v);
                // A host is part of its network, which has room for one such host at least.
                addresses.network_connections_max =
                    std::max(AddressLimitOptions{}.network_connections_max, as<std::uint32_t>(v));
              }),
      integer("address_pending", 1, 1000000, "16", true,
              [](C& c, const Value& v) {
                c.host.gate.addresses.host_pending_max = as<std::uint32_t>(v);
              }),
      integer("rooms", 1, 100000, "256", true,
              [](C& c, const Value& v) { c.host.limits.rooms_max = as<std::size_t>(v); })};
}

/// Of a room and of one client in it.
Keys client_limits() {
  using C = ServerConfig;
  return {
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
      integer("digest_ticks", 1, 1000000, "60", false,
              [](C& c, const Value& v) { c.host.limits.room.digest_ticks = as<std::uint64_t>(v); }),
      integer(
          "snapshot_ticks", 1, 1000000, "3", false,
          [](C& c, const Value& v) { c.host.limits.room.snapshot_ticks = as<std::uint64_t>(v); }),
      integer("input_delay_ticks", 1, kInputDelayTicksMax, "2", false, [](C& c, const Value& v) {
        c.host.limits.room.input_delay_ticks = as<std::uint32_t>(v);
      })};
}

/// Of states and rates of one client.
Keys state_limits() {
  using C = ServerConfig;
  return {
      integer("queue_age_ms", 1, 600000, "2000", true,
              [](C& c, const Value& v) {
                c.host.limits.room.queue_age = std::chrono::milliseconds(v.integer);
              }),
      integer("state_parts_per_tick", 1, 4096, "8", true,
              [](C& c, const Value& v) {
                c.host.limits.room.state_parts_per_tick_max = as<std::uint32_t>(v);
              }),
      integer("state_restarts", 1, 1000, "3", true,
              [](C& c, const Value& v) {
                c.host.limits.room.state_restarts_max = as<std::uint32_t>(v);
              }),
      integer("resyncs", 1, 1000, "3", true,
              [](C& c, const Value& v) { c.host.limits.room.resyncs_max = as<std::uint32_t>(v); }),
      integer("resync_window_s", 1, kManySeconds, "300", true,
              [](C& c, const Value& v) {
                c.host.limits.room.resync_window = std::chrono::seconds(v.integer);
              }),
      integer("words_per_input", 1, 1000, "8", true,
              [](C& c, const Value& v) {
                c.host.limits.room.words_per_input_max = as<std::uint32_t>(v);
              }),
      integer("messages_per_s", 1, kMany, "1200", true, [](C& c, const Value& v) {
        c.host.limits.room.messages_per_s = as<std::uint64_t>(v);
      })};
}

/// Of what a room keeps.
Keys kept_limits() {
  using C = ServerConfig;
  return {
      integer("bytes_per_s", 1024, kMany, "262144", true,
              [](C& c, const Value& v) { c.host.limits.room.bytes_per_s = as<std::uint64_t>(v); }),
      integer("resume_s", 0, kManySeconds, "10", true,
              [](C& c, const Value& v) {
                c.host.limits.room.resume = std::chrono::seconds(v.integer);
              }),
      integer(
          "slow_ticks", 1, 1000000, "120", true,
          [](C& c, const Value& v) { c.host.limits.room.slow_ticks_max = as<std::uint32_t>(v); }),
      integer(
          "frames_kept", 1, 1000000, "3600", false,
          [](C& c, const Value& v) { c.host.limits.room.frames_kept_max = as<std::size_t>(v); }),
      integer(
          "keyframe_ticks", 1, 1000000, "60", false,
          [](C& c, const Value& v) { c.host.limits.room.keyframe_ticks = as<std::uint64_t>(v); }),
      integer(
          "keyframe_bytes", 65536, kMany, "8388608", false,
          [](C& c, const Value& v) { c.host.limits.room.keyframe_bytes_max = as<std::size_t>(v); }),
      integer("baseline_bytes", 65536, kMany, "4194304", false, [](C& c, const Value& v) {
        c.host.limits.room.baseline_bytes_max = as<std::size_t>(v);
      })};
}

}  // namespace

ConfigSection config_limits() {
  ConfigSection section{"limits", process_limits()};
  for (const Keys& more : {client_limits(), state_limits(), kept_limits()}) {
    section.keys.insert(section.keys.end(), more.begin(), more.end());
  }
  return section;
}

}  // namespace cycloid::server
