#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include "cli/commands.hpp"
#include "cli/log_file.hpp"
#include "cli/output.hpp"
#include "cli/replaying.hpp"
#include "cli/visible.hpp"
#include "server/desync/report.hpp"

namespace cycloid::cli {
namespace {

std::string text_file(const std::string& file) {
  const std::vector<std::byte> bytes = read_file(file);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// The report as JSON, which `show` has found to be one.
Json load_report(const std::string& file, std::string& shown) {
  const std::string text = text_file(file);
  std::string error;
  const auto readable = server::report_as_text(text, error);
  if (!readable) throw Failure(kExitCorrupt, file + ": " + error);
  shown = *readable;
  return Json::parse(text);
}

Exit show(const std::string& file, bool json) {
  std::string shown;
  Json report = load_report(file, shown);
  if (json)
    print_json(std::move(report), kExitGood);
  else
    std::cout << visible_lines(shown);
  return kExitGood;
}

/// What this build makes of the tick of a report.
struct Repeated {
  std::uint64_t from_tick = 0;  ///< Of the state of the server's with which it begins.
  std::string digest;           ///< After the report's tick.
  /// The first before the report's that comes out otherwise than recorded: from there on it is
  /// another match.
  std::optional<std::uint64_t> parted_tick;
};

/// Steps the cut log to the tick, from its last state before: the client's build need not come to
/// that state by itself.
Repeated repeat_log(const std::string& file, std::uint64_t tick) {
  const LoadedLog loaded = load_log(file);
  if (tick < loaded.first_tick() || tick > loaded.last_tick())
    throw Failure(kExitCorrupt, file + ": has no tick " + std::to_string(tick));
  scenes::Simulation simulation = keyframe_state(loaded, tick - 1);
  Repeated repeated;
  repeated.from_tick = simulation.tick();
  TickReader reader(loaded);
  std::vector<scenes::SeatInput> inputs;
  for (std::uint64_t now = repeated.from_tick + 1; now <= tick; ++now) {
    const protocol::LogTick& recorded = reader.at(now);
    inputs.clear();
    for (const protocol::SeatFrame& seat : recorded.frame.seats) inputs.push_back(seat.input);
    const solver::Error error = simulation.step(inputs);
    if (!error.ok()) {
      throw Failure(kExitDiverged, file + ": the world does not step to tick " +
                                       std::to_string(now) + ": " + error_text(error));
    }
    const bool parts = now < tick && simulation.digest() != recorded.digest;
    if (parts && !repeated.parted_tick) repeated.parted_tick = now;
  }
  repeated.digest = hex16(simulation.digest());
  return repeated;
}

/// With whom this build agrees, and what to do where that is not the server.
void print_agreement(const Repeated& repeated, const std::string& agrees, const std::string& log) {
  std::cout << "this build agrees with " << (agrees == "neither" ? "" : "the ") << agrees;
  if (agrees == "neither" && repeated.parted_tick)
    std::cout << ": it leaves the recorded match at tick " << *repeated.parted_tick << " already";
  if (agrees != "server") {
    std::cout << "; to go on: cycloid bisect " << log
              << " --against PROGRAM, with the server's cycloid";
  }
  std::cout << '\n';
}

Exit repeat(const std::string& file, bool json) {
  std::string shown;
  const Json report = load_report(file, shown);
  if (report.at("log").is_null()) {
    throw Failure(kExitIo, file + ": has no log: " + report.at("log_reason").get<std::string>());
  }
  // A name from a file: beside the report, and nowhere else.
  const auto name = std::filesystem::path(report.at("log").get<std::string>()).filename();
  const std::string log = (std::filesystem::path(file).parent_path() / name).string();
  const auto tick = report.at("tick").get<std::uint64_t>();
  const Repeated repeated = repeat_log(log, tick);
  const auto server = report.at("server").at("digest").get<std::string>();
  const auto client = report.at("client").at("digest").get<std::string>();
  const char* agrees = repeated.digest == server   ? "server"
                       : repeated.digest == client ? "client"
                                                   : "neither";
  const Exit exit = repeated.digest == server ? kExitGood : kExitDiverged;
  if (json) {
    print_json({{"tick", tick},
                {"from_tick", repeated.from_tick},
                {"parted_tick", repeated.parted_tick ? Json(*repeated.parted_tick) : Json()},
                {"digest", repeated.digest},
                {"server", server},
                {"client", client},
                {"agrees_with", agrees}},
               exit);
    return exit;
  }
  std::cout << "tick " << tick << ", made again from tick " << repeated.from_tick << ":\n  "
            << repeated.digest << "  this program\n  " << server << "  the server\n  " << client
            << "  the client\n";
  print_agreement(repeated, agrees, log);
  return exit;
}

}  // namespace

void add_desync(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("desync", "Read and repeat what a server reports of one");
  command->require_subcommand(1);
  command->footer(kExitCodesText);
  const auto add = [&](const char* name, const char* summary,
                       Exit (*run)(const std::string&, bool)) {
    auto file = std::make_shared<std::string>();
    CLI::App* verb = add_command(*command, name, summary, action);
    verb->add_option("REPORT", *file, "A desync-....json; its log lies beside it")->required();
    verb->callback([=, &action] { action.run = [=, &action] { return run(*file, action.json); }; });
  };
  add("show", "Print a report as text", &show);
  add("repeat", "Make its tick again with this build: 0 as the server, 1 as the client or neither",
      &repeat);
}

}  // namespace cycloid::cli
