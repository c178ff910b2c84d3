#include "server/serve.hpp"

#include <chrono>
#include <cmath>
#include <iostream>
#include <memory>

#include "cli/commands.hpp"
#include "cli/output.hpp"

namespace cycloid::cli {
namespace {

struct ServeCommand {
  std::string scene;
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

Exit serve(ServeCommand command, bool json) {
  server::ServeOptions& options = command.options;
  options.scene = load_scene(command.scene);
  options.scene_name = options.scene.name;
  options.tick_rate_millihertz =
      static_cast<std::uint32_t>(std::lround(command.tick_rate * 1000.0));
  if (command.log_sync == "tick") options.log_sync = server::LogSync::kEveryTick;

  const auto on_listening = [&](std::uint16_t port) {
    const bool v6 = options.address.find(':') != std::string::npos;
    const std::string host = v6 ? "[" + options.address + "]" : options.address;
    (json ? std::cerr : std::cout) << "listening on " << host << ':' << port << std::endl;
  };
  const server::ServeReport report = server::serve(options, on_listening);
  const Exit exit = exit_of(report);
  if (exit != kExitGood) {
    std::cerr << "cycloid: " << server::end_name(report.end) << ": "
              << (report.durable ? report.reason : "the log is not durable: " + report.reason)
              << '\n';
  }
  const Json object = to_json(report);
  if (json) print_json(object, exit);
  if (json) return exit;
  for (const auto& [name, value] : object.items()) {
    std::cout << name << ' ' << (value.is_string() ? value.get<std::string>() : value.dump())
              << '\n';
  }
  return exit;
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
      ->check(CLI::Range(1, 256));
  command.add_option("--connections", limits.connections_max, "Most connections at a time")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
}

}  // namespace

void add_serve(CLI::App& app, Action& action) {
  auto command = std::make_shared<ServeCommand>();
  server::ServeOptions& options = command->options;
  CLI::App* serving = add_command(
      app, "serve", "Serve one room; prints 'listening on ADDRESS:PORT' (with --json on stderr)",
      action);
  serving->add_option("SCENE", command->scene, "A catalogue name or a scene file")->required();
  serving->add_option("--address", options.address, "The address to listen on")
      ->capture_default_str();
  serving->add_option("--port", options.port, "The port; 0: any")->capture_default_str();
  serving->add_option("--ticks", options.ticks, "Close the match after so many; 0: never")
      ->capture_default_str();
  serving->add_option("--tick-rate", command->tick_rate, "Ticks per second; 0: the scene's")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 10000.0));
  serving->add_option("--workers", options.workers, "Threads of the step; changes no bit")
      ->capture_default_str()
      ->check(CLI::Range(1, 64));
  serving->add_option("--log", options.log, "Write the match to this file, which must be new");
  serving
      ->add_option("--log-sync", command->log_sync,
                   "When the log is on the disk: 100 ms later, or before the tick leaves")
      ->capture_default_str()
      ->check(CLI::IsMember({"interval", "tick"}));
  serving->add_flag("--stop-on-log-error", options.stop_on_log_error,
                    "End the match when the log cannot be written");
  add_limits(*serving, options.limits);
  serving->callback(
      [command, &action] { action.run = [=, &action] { return serve(*command, action.json); }; });
}

}  // namespace cycloid::cli
