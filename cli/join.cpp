#include "client/join.hpp"

#include <charconv>
#include <iostream>
#include <limits>
#include <memory>
#include <random>
#include <stdexcept>

#include "cli/commands.hpp"
#include "cli/output.hpp"
#include "cli/signals.hpp"
#include "cli/visible.hpp"
#include "client/net/tls.hpp"
#include "client/token_text.hpp"
#include "solver/version.hpp"

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
  std::string room;
  std::string token;
  std::uint32_t predict = 0;
  std::string profile = "exact";
  std::uint32_t reconnect_s = 0;
  bool tls = false;
  client::TlsTrust trust;
};

/// "HOST:PORT", "[::1]:PORT" or Failure.
void parse_server(const std::string& text, client::JoinOptions& options) {
  const std::size_t colon = text.rfind(':');
  const std::string port = colon == std::string::npos ? "" : text.substr(colon + 1);
  const char* end = port.data() + port.size();
  const auto parsed = std::from_chars(port.data(), end, options.port);
  options.host = text.substr(0, colon);
  bool good = parsed.ec == std::errc() && parsed.ptr == end && options.port != 0;
  if (options.host.size() > 2 && options.host.front() == '[' && options.host.back() == ']')
    options.host = options.host.substr(1, options.host.size() - 2);
  else
    good = good && options.host.find(':') == std::string::npos;
  if (!good || options.host.empty())
    throw Failure(kExitUsage, "HOST:PORT: not one, nor [IPV6]:PORT: " + text);
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

/// What `cycloid token` has written, without the end of its line.
std::vector<std::byte> read_token(const std::string& file) {
  if (file.empty()) return {};
  std::string text;
  for (const std::byte letter : read_file(file)) text += static_cast<char>(letter);
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  const auto token = client::token_from_text(text);
  if (!token) throw Failure(kExitUsage, "--token: " + file + " holds no token");
  return *token;
}

Exit exit_of_refusal(Refusal code) {
  switch (code) {
    case Refusal::kProtocolVersion:
    case Refusal::kSolverVersion:
    case Refusal::kSceneDigest:
      return kExitIncompatible;
    case Refusal::kSeatTaken:
    case Refusal::kNoSuchSeat:
    case Refusal::kNoSuchRoom:
    case Refusal::kTokenInvalid:
    case Refusal::kTokenExpired:
    case Refusal::kTokenUsed:
    case Refusal::kTokenScope:
      return kExitUsage;
    case Refusal::kBadMessage:
    case Refusal::kTooLarge:
      return kExitCorrupt;
    case Refusal::kFaulted:
    case Refusal::kResyncLimit:
      return kExitDiverged;
    default:
      return kExitIo;
  }
}

Exit exit_of(const client::JoinReport& report) {
  if (report.refused()) return exit_of_refusal(report.refused()->code);
  if (report.end == client::End::kFailed) return kExitCorrupt;
  if (report.end == client::End::kDisconnected) return kExitIo;
  return report.progress.mismatches == 0 ? kExitGood : kExitDiverged;
}

/// What went wrong, in a line. A match whose seats are taken may be watched; by the code alone it
/// is not told from a room or server that takes nobody more.
std::string failure_text(const client::JoinReport& report, bool wants_seat) {
  const std::string text = std::string(client::end_name(report.end)) + ": " + report.reason;
  const bool full = report.refused() && report.refused()->code == Refusal::kRoomFull;
  const bool of_seats = report.reason.find(" seats taken, of ") != std::string::npos;
  if (!full || !of_seats || !wants_seat) return text;
  return text + "; to look on without a seat: --seat spectator";
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
                 {"states_kept", progress.states_kept},
                 {"digests_compared", progress.digests_compared},
                 {"mismatches", progress.mismatches},
                 {"resyncs", progress.resyncs},
                 {"inputs_sent", progress.inputs_sent},
                 {"inputs_replaced", progress.inputs_replaced},
                 {"lead_ticks", progress.lead_ticks},
                 {"rewinds", progress.rewinds},
                 {"reconnects", report.reconnects},
                 {"rollbacks", report.prediction.rollbacks},
                 {"ticks_resimulated", report.prediction.resimulated},
                 {"deepest_rollback_ticks", report.prediction.deepest_ticks},
                 {"prediction_stalls", report.prediction.stalls},
                 {"bytes_in", report.bytes_in},
                 {"bytes_out", report.bytes_out}};
  if (report.refused()) object["refusal"] = static_cast<int>(report.refused()->code);
  return object;
}

/// The way to the room and back to it.
void set_connection(const JoinCommand& command, client::JoinOptions& options) {
  options.room = command.room;
  options.token = read_token(command.token);
  options.reconnect.on = command.reconnect_s != 0;
  options.reconnect.deadline = std::chrono::seconds(command.reconnect_s);
  options.reconnect.seed = std::random_device{}();
  if (!command.tls && command.trust.ca_file.empty() && command.trust.fingerprint.empty()) return;
  try {
    options.tls = std::make_shared<const client::ClientTls>(command.trust);
  } catch (const std::runtime_error& error) {
    // A mistake in the fingerprint names the field itself.
    const bool of_file = command.trust.fingerprint.empty();
    const std::string of_system = command.trust.ca_file.empty() ? "--tls: " : "--tls-ca: ";
    throw Failure(kExitUsage, (of_file ? of_system : "--tls-") + error.what());
  }
}

Exit join(const JoinCommand& command, bool json) {
  if (command.predict != 0 && command.snapshot) {
    throw Failure(kExitUsage, "--predict: a snapshot client steps nothing; leave --snapshot out");
  }
  client::JoinOptions options;
  set_connection(command, options);
  options.predict_ticks = command.predict;
  if (command.profile == "quantised") options.profile = protocol::Profile::kQuantised;
  parse_server(command.server, options);
  options.seat_wish = parse_seat(command.seat);
  options.scene = load_scene(command.scene);
  options.mode = command.snapshot ? protocol::Mode::kSnapshot : protocol::Mode::kLockstep;
  options.ticks = command.ticks;
  options.name = command.name;
  options.workers = command.workers;
  options.should_stop = stop_requested;
  if (const std::string mistake = client::mistake_of(options); !mistake.empty())
    throw Failure(kExitUsage, "--" + mistake);
  catch_stop_signals();

  const client::JoinReport report = client::join(options);
  const Exit exit = exit_of(report);
  const Json object = to_json(report);
  if (exit != kExitGood && exit != kExitDiverged) {
    const bool wants_seat = options.seat_wish != protocol::kSpectator;
    std::cerr << "cycloid: " << command.server << ": " << visible(failure_text(report, wants_seat))
              << '\n';
  }
  if (json) print_json(object, exit);
  if (json) return exit;
  for (const auto& [name, value] : object.items()) {
    if (!value.is_null()) {
      print_member(name, value);
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
  command
      ->add_option("--workers", options->workers,
                   "Threads at most: one alone while that is faster; changes no bit")
      ->capture_default_str()
      ->check(CLI::Range(1, 64));
  command->add_option("--room", options->room, "Its name, where the server has several");
  command->add_option("--token", options->token, "File with the token that admits us");
  command
      ->add_option("--predict", options->predict, "Most ticks to run ahead of the server; 0: none")
      ->capture_default_str()
      ->check(CLI::Range(0u, client::Predictor::kWindowTicksMax));
  command->add_option("--profile", options->profile, "Of received states: exact or quantised")
      ->capture_default_str()
      ->check(CLI::IsMember({"exact", "quantised"}));
  command
      ->add_option("--reconnect", options->reconnect_s,
                   "Seconds to try to come back to the seat after a break; 0: not at all")
      ->capture_default_str()
      ->check(CLI::Range(std::uint32_t{0}, std::numeric_limits<std::uint32_t>::max()));
  command->add_flag("--tls", options->tls,
                    "Encrypt; the system's authorities vouch for the server");
  command->add_option("--tls-ca", options->trust.ca_file,
                      "Encrypt; these authorities do, a PEM file");
  command->add_option("--tls-fingerprint", options->trust.fingerprint,
                      "Encrypt; the server has the certificate with this SHA-256, and no other");
  command->callback(
      [options, &action] { action.run = [=, &action] { return join(*options, action.json); }; });
}

}  // namespace cycloid::cli
