#include "server/serve.hpp"

#include <utility>

#include "server/host/host.hpp"

namespace cycloid::server {
namespace {

constexpr const char* kOnlyRoom = "main";

HostOptions host_options(const ServeOptions& options) {
  HostOptions host;
  host.address = options.address;
  host.port = options.port;
  host.threads = options.threads;
  host.realtime = options.realtime;
  host.catch_signals = options.catch_signals;
  host.drain = options.drain;
  host.ends_with_last_room = true;
  host.gate.hello_deadline_ns = options.limits.handshake.count();
  host.limits.room = options.limits;
  NamedRoom room;
  room.name = kOnlyRoom;
  room.settings.scene = options.scene;
  room.settings.scene_name = options.scene_name;
  room.settings.tick_rate_millihertz = options.tick_rate_millihertz;
  room.settings.ticks = options.ticks;
  room.settings.workers = options.workers;
  room.settings.log = options.log;
  room.settings.log_sync = options.log_sync;
  room.settings.stop_on_log_error = options.stop_on_log_error;
  host.rooms.push_back(std::move(room));
  return host;
}

}  // namespace

ServeReport serve(const ServeOptions& options,
                  const std::function<void(std::uint16_t port)>& on_listening,
                  std::stop_token stop) {
  Host host(host_options(options));
  if (on_listening) on_listening(host.port());
  HostReport all = host.run(std::move(stop));
  ServeReport report = all.rooms[kOnlyRoom];
  report.refusals += all.refusals;
  report.bytes_in += all.gate_bytes;
  return report;
}

}  // namespace cycloid::server
