#include "server/serve.hpp"

#include <algorithm>
#include <asio/ip/address.hpp>
#include <chrono>
#include <cmath>
#include <iostream>
#include <memory>

#include "cli/commands.hpp"
#include "cli/files.hpp"
#include "cli/output.hpp"
#include "cli/visible.hpp"
#include "server/config/run.hpp"

namespace cycloid::cli {
namespace {

struct ServeCommand {
  std::string scene;
  std::string config;
  bool check_config = false;
  CLI::App* parsed = nullptr;
  server::ServeOptions options;
  double tick_rate = 0.0;
  std::string log_sync = "interval";
};

double ms_of(std::uint64_t nanoseconds) {
  return double(nanoseconds) * 1e-6;
}

Json to_json(const server::ServeReport& report) {
  return {{"end", server::end_name(report.end)},
          {"reason", report.reason},
          {"tick", report.ticks},
          {"digest", hex16(report.final_digest)},
          {"worst_tick_ms", ms_of(report.worst_tick_ns)},
          {"lateness_p99_ms", ms_of(report.lateness_p99_ns)},
          {"slowed_ms", ms_of(report.slowed_ns)},
          {"bytes_in", report.bytes_in},
          {"bytes_out", report.bytes_out},
          {"clients", report.clients},
          {"refusals", report.refusals},
          {"desyncs", report.desyncs},
          {"inputs_late", report.inputs_late},
          {"durable", report.durable}};
}

Exit exit_of(const server::ServeReport& report) {
  switch (report.end) {
    case server::End::kDrained:
    case server::End::kTicks:
      return report.durable ? kExitGood : kExitIo;
    case server::End::kFaulted:
      return kExitDiverged;
    case server::End::kLogError:
      return kExitIo;
  }
  return kExitIo;
}

std::string host_text(const std::string& address) {
  return address.find(':') != std::string::npos ? "[" + address + "]" : address;
}

/// For CLI11: "" or the mistake.
std::string address_mistake(const std::string& text) {
  asio::error_code error;
  (void)asio::ip::make_address(text, error);
  return error ? "\"" + visible(text) + "\" is no IP address" : "";
}

scenes::Loaded load_for_config(const std::string& name) {
  try {
    scenes::Loaded loaded;
    // Such as a pipe, which may never end.
    if (const PathKind kind = kind_of(name); kind.exists && !kind.is_file) {
      loaded.mistakes.push_back({"", "it is no regular file"});
      return loaded;
    }
    loaded.scene = load_scene(name);
    return loaded;
  } catch (const Failure& failure) {
    scenes::Loaded loaded;
    loaded.mistakes.push_back({"", failure.what()});
    return loaded;
  }
}

/// What the command line says counts, whatever the file says.
void override_config(const ServeCommand& command, server::ServerConfig& config) {
  const auto said = [&](const char* option) { return command.parsed->count(option) > 0; };
  server::HostOptions& host = config.host;
  const server::Limits& limits = command.options.limits;
  if (said("--address")) host.address = command.options.address;
  if (said("--port")) host.port = command.options.port;
  if (said("--threads")) host.threads = command.options.threads;
  if (said("--rt")) host.realtime = true;
  if (said("--drain")) host.drain = command.options.drain;
  if (said("--snapshot-every")) host.limits.room.snapshot_ticks = limits.snapshot_ticks;
  if (said("--digest-every")) host.limits.room.digest_ticks = limits.digest_ticks;
  if (said("--input-delay")) host.limits.room.input_delay_ticks = limits.input_delay_ticks;
  if (said("--connections")) host.limits.room.connections_max = limits.connections_max;
}

Exit serve_config(const ServeCommand& command, bool json) {
  for (const char* option :
       {"--ticks", "--tick-rate", "--workers", "--log", "--log-sync", "--stop-on-log-error"}) {
    if (command.parsed->count(option) == 0) continue;
    throw Failure(kExitUsage, std::string(option) +
                                  " is of one room: with --config it stands in "
                                  "a [template.NAME] of the file");
  }
  server::ConfigResult read = server::read_config_file(command.config, load_for_config);
  if (!read.config) {
    const PathKind kind = kind_of(command.config);
    if (!kind.exists || kind.is_file) (void)read_file(command.config);  // Says why it cannot be.
    throw Failure(kExitUsage, server::config_mistakes_text(command.config, read.mistakes));
  }
  if (command.check_config) {
    if (json) print_json({{"config", command.config}, {"good", true}}, kExitGood);
    if (!json) std::cout << command.config << ": good\n";
    return kExitGood;
  }
  server::ConfiguredServer configured;
  configured.config = std::move(*read.config);
  configured.file = command.config;
  configured.load_scene = load_for_config;
  configured.override_config = [&](server::ServerConfig& config) {
    override_config(command, config);
  };
  override_config(command, configured.config);
  const std::string host = host_text(configured.config.host.address);
  const std::string operation = host_text(configured.config.operation.address);
  const auto on_listening = [&](const server::ListeningAt& at) {
    std::ostream& out = json ? std::cerr : std::cout;
    out << "listening on " << host << ':' << at.port << std::endl;
    if (at.operation_port != 0) {
      out << "operation on " << operation << ':' << at.operation_port << std::endl;
    }
  };
  const server::HostReport report = server::run_configured(configured, on_listening);
  Json rooms = Json::object();
  Exit exit = kExitGood;
  for (const auto& [name, room] : report.rooms) {
    rooms[name] = to_json(room);
    exit = std::max(exit, exit_of(room));
  }
  if (exit == kExitGood && !report.good) exit = kExitIo;  // Of a room that is no longer listed.
  const Json object = {
      {"rooms_ended", report.rooms_ended}, {"refusals", report.refusals}, {"rooms", rooms}};
  if (json) print_json(object, exit);
  if (!json) std::cout << object.dump(2) << '\n';
  return exit;
}

Exit serve(ServeCommand command, bool json) {
  if (command.parsed->count("--config") > 0) {
    if (command.config.empty()) throw Failure(kExitUsage, "--config: is no name of a file");
    if (!command.scene.empty()) {
      throw Failure(kExitUsage, "SCENE and --config: one of them, not both");
    }
    return serve_config(command, json);
  }
  if (command.scene.empty()) throw Failure(kExitUsage, "SCENE or --config is required");
  if (command.check_config) throw Failure(kExitUsage, "--check-config needs --config");
  if (command.tick_rate > 0.0 && command.tick_rate < 0.001) {
    throw Failure(kExitUsage, "--tick-rate: it is not 0 and less than 0.001");
  }
  server::ServeOptions& options = command.options;
  options.scene = load_scene(command.scene);
  options.scene_name = options.scene.name;
  options.tick_rate_millihertz =
      static_cast<std::uint32_t>(std::lround(command.tick_rate * 1000.0));
  options.log_sync = server::log_sync_of(command.log_sync);

  const auto on_listening = [&](std::uint16_t port) {
    (json ? std::cerr : std::cout)
        << "listening on " << host_text(options.address) << ':' << port << std::endl;
  };
  const server::ServeReport report = server::serve(options, on_listening);
  const Exit exit = exit_of(report);
  if (exit != kExitGood) {
    std::cerr << "cycloid: " << server::end_name(report.end) << ": "
              << visible(report.durable ? report.reason
                                        : "the log is not durable: " + report.reason)
              << '\n';
  }
  const Json object = to_json(report);
  if (json) print_json(object, exit);
  if (json) return exit;
  for (const auto& [name, value] : object.items()) {
    print_member(name, value);
  }
  return exit;
}

void add_process(CLI::App& command, ServeCommand& serve, FileOptions& files) {
  files.reads(
      command.add_option("--config", serve.config,
                         "Serve the rooms of this file (TOML; docs/server.md has its keys)"));
  command.add_flag("--check-config", serve.check_config,
                   "Read the file, name every mistake, and serve nothing");
  command.add_option("--threads", serve.options.threads, "Threads of ticks and sockets")
      ->capture_default_str()
      ->check(CLI::Range(1, 64));
  command.add_flag("--rt", serve.options.realtime,
                   "Ask for SCHED_FIFO and locked memory; goes on without, and says so");
  command
      .add_option_function<double>(
          "--drain",
          [&serve](double seconds) {
            serve.options.drain =
                std::chrono::milliseconds(static_cast<std::int64_t>(seconds * 1000.0));
          },
          "Seconds from a SIGTERM to the end of the rooms; 0: at once")
      ->check(CLI::Range(0.0, 86400.0));
}

void add_limits(CLI::App& command, server::Limits& limits) {
  command.add_option("--snapshot-every", limits.snapshot_ticks, "Ticks between two snapshots")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  command.add_option("--digest-every", limits.digest_ticks, "Ticks between two digests")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  command.add_option("--input-delay", limits.input_delay_ticks, "Lead of the inputs in ticks")
      ->capture_default_str()
      ->check(CLI::Range(1u, server::kInputDelayTicksMax));
  command
      .add_option("--connections", limits.connections_max, "Most connections of a room at a time")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
}

}  // namespace

void add_serve(CLI::App& app, Action& action) {
  auto command = std::make_shared<ServeCommand>();
  server::ServeOptions& options = command->options;
  CLI::App* serving = add_command(
      app, "serve", "Serve rooms; prints 'listening on ADDRESS:PORT' (with --json on stderr)",
      action);
  action.files.reads(serving->add_option("SCENE", command->scene,
                                         "A catalogue name or a scene file; or --config"));
  serving->add_option("--address", options.address, "The IP address to listen on")
      ->capture_default_str()
      ->check(address_mistake);
  serving->add_option("--port", options.port, "The port; 0: any")
      ->capture_default_str()
      ->check(CLI::Range(0, 65535));
  serving->add_option("--ticks", options.ticks, "Close the match after so many; 0: never")
      ->capture_default_str();
  serving->add_option("--tick-rate", command->tick_rate, "Ticks per second; 0: the scene's")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 10000.0));
  serving
      ->add_option("--workers", options.workers,
                   "Threads of a step at most: one alone while that is faster; changes no bit")
      ->capture_default_str()
      ->check(CLI::Range(1, 64));
  action.files.streams(
      serving->add_option("--log", options.log, "Write the match to this file, which must be new"));
  serving
      ->add_option("--log-sync", command->log_sync,
                   "When the log is on the disk: 100 ms later, before the tick leaves, or as the "
                   "system sees fit")
      ->capture_default_str()
      ->check(CLI::IsMember(
          std::vector<std::string>(server::kLogSyncNames.begin(), server::kLogSyncNames.end())));
  serving->add_flag("--stop-on-log-error", options.stop_on_log_error,
                    "End the match when the log cannot be written");
  add_process(*serving, *command, action.files);
  add_limits(*serving, options.limits);
  command->parsed = serving;
  serving->callback(
      [command, &action] { action.run = [=, &action] { return serve(*command, action.json); }; });
}

}  // namespace cycloid::cli
