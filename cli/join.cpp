#include "client/join.hpp"

#include <charconv>
#include <iostream>
#include <memory>

#include "cli/commands.hpp"
#include "cli/output.hpp"
#include "cli/signals.hpp"

namespace cycloid::cli {
namespace {

using protocol::Refusal;

struct JoinCommand {
  std::string server;
  std::string scene;
  bool snapshot = false;
  std::string seat = "any";
  std::uint64_t ticks = 0;
  std::string name;
  int workers = 1;
};

/// "HOST:PORT", "[::1]:PORT" or Failure.
void parse_server(const std::string& text, client::JoinOptions& options) {
  const std::size_t colon = text.rfind(':');
  const std::string port = colon == std::string::npos ? "" : text.substr(colon + 1);
  const char* end = port.data() + port.size();
  const auto parsed = std::from_chars(port.data(), end, options.port);
  options.host = text.substr(0, colon);
  if (options.host.size() > 2 && options.host.front() == '[' && options.host.back() == ']') {
    options.host = options.host.substr(1, options.host.size() - 2);
  }
  const bool good = parsed.ec == std::errc() && parsed.ptr == end && options.port != 0;
  if (!good || options.host.empty()) throw Failure(kExitUsage, "HOST:PORT: not one: " + text);
}

std::int32_t parse_seat(const std::string& text) {
  if (text == "any") return protocol::kAnySeat;
  if (text == "spectator") return protocol::kSpectator;
  std::int32_t seat = -1;
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, seat);
  if (parsed.ec != std::errc() || parsed.ptr != end || seat < 0) {
    throw Failure(kExitUsage, "--seat: not a number, 'any' or 'spectator': " + text);
  }
  return seat;
}

Exit exit_of_refusal(Refusal code) {
  switch (code) {
    case Refusal::kProtocolVersion:
    case Refusal::kSolverVersion:
    case Refusal::kSceneDigest:
      return kExitIncompatible;
    case Refusal::kSeatTaken:
    case Refusal::kNoSuchSeat:
    case Refusal::kTokenInvalid:
    case Refusal::kTokenExpired:
    case Refusal::kTokenUsed:
    case Refusal::kTokenScope:
    case Refusal::kNoSuchRoom:
    case Refusal::kResumeUnknown:
      return kExitUsage;
    case Refusal::kBadMessage:
    case Refusal::kTooLarge:
      return kExitCorrupt;
    case Refusal::kFaulted:
    case Refusal::kResyncLimit:
      return kExitDiverged;
    case Refusal::kRoomFull:
    case Refusal::kTooSlow:
    case Refusal::kDraining:
    case Refusal::kRoomLocked:
    case Refusal::kRateLimited:
    case Refusal::kKicked:
    case Refusal::kReplaced:
      return kExitIo;
  }
  return kExitIo;
}

Exit exit_of(const client::JoinReport& report) {
  if (report.refused()) return exit_of_refusal(report.refused()->code);
  if (report.end == client::End::kFailed) return kExitCorrupt;
  if (report.end == client::End::kDisconnected) return kExitIo;
  return report.progress.mismatches == 0 ? kExitGood : kExitDiverged;
}

Json to_json(const client::JoinReport& report) {
  const client::Progress& progress = report.progress;
  Json object = {{"end", client::end_name(report.end)},
                 {"reason", report.reason},
                 {"refusal", nullptr},
                 {"seat", progress.seat},
                 {"first_tick", progress.first_tick},
                 {"tick", progress.last_tick},
                 {"digest", hex16(report.final_digest)},
                 {"frames", progress.frames},
                 {"snapshots", progress.snapshots},
                 {"digests_compared", progress.digests_compared},
                 {"mismatches", progress.mismatches},
                 {"resyncs", progress.resyncs},
                 {"inputs_sent", progress.inputs_sent},
                 {"inputs_replaced", progress.inputs_replaced},
                 {"bytes_in", report.bytes_in},
                 {"bytes_out", report.bytes_out}};
  if (report.refused()) object["refusal"] = static_cast<int>(report.refused()->code);
  return object;
}

Exit join(const JoinCommand& command, bool json) {
  client::JoinOptions options;
  parse_server(command.server, options);
  options.seat_wish = parse_seat(command.seat);
  options.scene = load_scene(command.scene);
  options.mode = command.snapshot ? protocol::Mode::kSnapshot : protocol::Mode::kLockstep;
  options.ticks = command.ticks;
  options.name = command.name;
  options.workers = command.workers;
  options.should_stop = stop_requested;
  catch_stop_signals();

  const client::JoinReport report = client::join(options);
  const Exit exit = exit_of(report);
  const Json object = to_json(report);
  if (exit != kExitGood && exit != kExitDiverged) {
    std::cerr << "cycloid: " << command.server << ": " << client::end_name(report.end) << ": "
              << report.reason << '\n';
  }
  if (json) print_json(object, exit);
  if (json) return exit;
  for (const auto& [name, value] : object.items()) {
    if (!value.is_null()) {
      std::cout << name << ' ' << (value.is_string() ? value.get<std::string>() : value.dump())
                << '\n';
    }
  }
  return exit;
}

}  // namespace

void add_join(CLI::App& app, Action& action) {
  auto options = std::make_shared<JoinCommand>();
  CLI::App* command =
      add_command(app, "join", "Join a room; the seat does what the scene's script says", action);
  command->add_option("HOST:PORT", options->server, "Where the server listens")->required();
  command->add_option("SCENE", options->scene, "The server's scene, by name or file")->required();
  command->add_flag("--snapshot", options->snapshot, "Receive states instead of stepping");
  command->add_option("--seat", options->seat, "A number, 'any' or 'spectator'")
      ->capture_default_str();
  command->add_option("--ticks", options->ticks, "Leave after so many ticks; 0: stay")
      ->capture_default_str();
  command->add_option("--name", options->name, "For the server's log");
  command->add_option("--workers", options->workers, "Threads; changes no bit")
      ->capture_default_str()
      ->check(CLI::Range(1, 64));
  command->callback(
      [options, &action] { action.run = [=, &action] { return join(*options, action.json); }; });
}

}  // namespace cycloid::cli
