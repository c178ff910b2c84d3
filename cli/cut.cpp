#include <iostream>
#include <memory>

#include "cli/commands.hpp"
#include "cli/output.hpp"
#include "cli/replaying.hpp"
#include "cli/run_log.hpp"

namespace cycloid::cli {
namespace {

struct CutOptions {
  std::string log;
  LoadOptions loading;
  std::uint64_t from = 0;
  std::uint64_t to = 0;
  std::string out;
};

/// The state after tick `from`, as the replay makes it; a Failure where it is not the recorded one.
scenes::Simulation state_after(const LoadedLog& loaded, std::uint64_t from) {
  ReplayOptions replaying;
  replaying.from = from;
  replaying.to = from;
  scenes::Simulation simulation = make_simulation(loaded.scene, replaying.workers);
  const Replayed replayed = replay(loaded, replaying, simulation);
  if (replayed.divergence) {
    throw Failure(kExitDiverged, loaded.file + ": " + divergence_text(*replayed.divergence) +
                                     "; a cut can only begin before it");
  }
  return simulation;
}

/// The same cut has the same bytes: its salt and id follow from those of the log and its bounds.
protocol::LogHeader header_of(const LoadedLog& loaded, std::uint64_t from, std::uint64_t to) {
  protocol::LogHeader header = loaded.log.header;
  const auto mixed = [&](std::uint64_t value) {
    return (value ^ (from * 0x9e3779b97f4a7c15u)) * 0xff51afd7ed558ccdu + to;
  };
  header.salt = mixed(header.salt);
  header.parent_log_id = header.log_id;
  header.log_id = mixed(header.log_id);
  header.branch_tick = from;
  return header;
}

protocol::LogKeyframe keyframe_of(const LoadedLog& loaded, const scenes::Simulation& simulation) {
  protocol::LogKeyframe keyframe;
  keyframe.tick = simulation.tick();
  keyframe.digest = simulation.digest();
  if (keyframe.tick >= loaded.first_tick())
    keyframe.seats = TickReader(loaded).at(keyframe.tick).frame.seats;
  simulation.encode(keyframe.state);
  return keyframe;
}

/// Ticks of the log behind `from` as they are, with what they recorded: a cut around a divergence
/// has it, too.
Exit cut_log(CutOptions options, bool json) {
  const LoadedLog loaded = load_log(options.log, options.loading);
  if (options.to == 0) options.to = loaded.last_tick();
  const std::uint64_t first = loaded.first_tick() - 1;
  if (options.from < first || options.from > options.to || options.to > loaded.last_tick()) {
    throw Failure(kExitUsage, "--from " + std::to_string(options.from) + " --to " +
                                  std::to_string(options.to) + ": " + options.log +
                                  " goes from tick " + std::to_string(first) + " to " +
                                  std::to_string(loaded.last_tick()));
  }
  const scenes::Simulation begin = state_after(loaded, options.from);
  protocol::Bytes bytes;
  protocol::LogEncoder encoder(header_of(loaded, options.from, options.to), bytes);
  if (options.from != 0) encoder.first_keyframe(keyframe_of(loaded, begin), bytes);
  TickReader reader(loaded);
  std::uint64_t digest = begin.digest();
  OutputFile file(options.out);
  for (std::uint64_t tick = options.from + 1; tick <= options.to; ++tick) {
    const protocol::LogTick& read = reader.at(tick);
    encoder.tick(read, bytes);
    digest = read.digest;
    file.write(bytes);
    bytes.clear();
  }
  encoder.footer({options.to, digest, {}}, bytes);
  file.write(bytes);
  file.close();
  if (const std::string blemish = loaded.blemish(); !blemish.empty())
    std::cerr << "cycloid: " << options.log << ": " << blemish << '\n';
  if (json)
    print_json({{"log", options.out}, {"from", options.from}, {"to", options.to}}, kExitGood);
  else
    std::cout << options.out << ": ticks " << options.from + 1 << " to " << options.to << " of "
              << options.log << "; to repeat: cycloid replay " << options.out << '\n';
  return kExitGood;
}

}  // namespace

void add_cut(CLI::App& app, Action& action) {
  auto options = std::make_shared<CutOptions>();
  CLI::App* command = add_command(
      app, "cut", "Write some ticks of a log as a log of their own, which begins with the state",
      action);
  command->add_option("LOG", options->log, "A .cylog file")->required();
  command->add_option("--from", options->from, "Begin with the state after this tick")
      ->capture_default_str();
  command->add_option("--to", options->to, "The last tick; 0: that of the log")
      ->capture_default_str();
  command->add_option("-o,--out", options->out, "The log to write")->required();
  add_salvage_option(command, options->loading);
  command->callback(
      [options, &action] { action.run = [=, &action] { return cut_log(*options, action.json); }; });
}

}  // namespace cycloid::cli
