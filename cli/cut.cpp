#include <iostream>
#include <memory>
#include <optional>
#include <vector>

#include "cli/commands.hpp"
#include "cli/output.hpp"
#include "cli/replaying.hpp"
#include "cli/whole_file.hpp"

namespace cycloid::cli {
namespace {

struct CutOptions {
  std::string log;
  LoadOptions loading;
  std::optional<std::uint64_t> from;  ///< None: where the log begins.
  std::uint64_t to = 0;
  std::string out;
};

/// Ticks `from` + 1 to `to`.
struct CutBounds {
  std::uint64_t from = 0;
  std::uint64_t to = 0;
};

CutBounds bounds_of(const CutOptions& options, const LoadedLog& loaded) {
  const std::uint64_t first = loaded.first_tick() - 1;
  const std::uint64_t last = loaded.last_tick();
  const CutBounds bounds{options.from.value_or(first), options.to == 0 ? last : options.to};
  if (options.from && options.to == 0 && bounds.from == last) {
    throw Failure(kExitUsage, "--from " + std::to_string(last) + ": " + options.log +
                                  " has no tick behind it; --to " + std::to_string(last) +
                                  " takes the state alone");
  }
  if (first <= bounds.from && bounds.from <= bounds.to && bounds.to <= last) return bounds;
  throw Failure(kExitUsage, "--from " + std::to_string(bounds.from) + " --to " +
                                std::to_string(bounds.to) + ": " + options.log +
                                " goes from tick " + std::to_string(first) + " to " +
                                std::to_string(last));
}

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
protocol::LogHeader header_of(const LoadedLog& loaded, const CutBounds& bounds) {
  protocol::LogHeader header = loaded.log.header;
  const auto mixed = [&](std::uint64_t value) {
    return (value ^ (bounds.from * 0x9e3779b97f4a7c15u)) * 0xff51afd7ed558ccdu + bounds.to;
  };
  header.salt = mixed(header.salt);
  header.parent_log_id = header.log_id;
  header.log_id = mixed(header.log_id);
  header.branch_tick = bounds.from;
  return header;
}

/// Those of the frame of a tick: in a log that begins with its state, as the keyframe has them.
/// @pre 0 < tick, and the log holds the tick or begins behind it
std::vector<protocol::SeatFrame> seats_at(const LoadedLog& loaded, std::uint64_t tick) {
  if (tick >= loaded.first_tick()) return TickReader(loaded).at(tick).frame.seats;
  protocol::LogCursor cursor(*loaded.bytes, loaded.log.start);
  (void)cursor.next();
  return cursor.keyframe().seats;
}

protocol::LogKeyframe keyframe_of(const LoadedLog& loaded, const scenes::Simulation& simulation) {
  protocol::LogKeyframe keyframe;
  keyframe.tick = simulation.tick();
  keyframe.digest = simulation.digest();
  keyframe.seats = seats_at(loaded, keyframe.tick);
  simulation.encode(keyframe.state);
  return keyframe;
}

/// Ticks of the log behind `from` as they are, with what they recorded: a cut around a divergence
/// has it, too.
Exit cut_log(const CutOptions& options, bool json) {
  const LoadedLog loaded = load_log(options.log, options.loading);
  const CutBounds bounds = bounds_of(options, loaded);
  const scenes::Simulation begin = state_after(loaded, bounds.from);
  protocol::Bytes bytes;
  protocol::LogEncoder encoder(header_of(loaded, bounds), bytes);
  if (bounds.from != 0) encoder.first_keyframe(keyframe_of(loaded, begin), bytes);
  TickReader reader(loaded);
  std::uint64_t digest = begin.digest();
  WholeFile file(options.out);
  const auto write = [&] {
    file.write({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    bytes.clear();
  };
  for (std::uint64_t tick = bounds.from + 1; tick <= bounds.to; ++tick) {
    const protocol::LogTick& read = reader.at(tick);
    encoder.tick(read, bytes);
    digest = read.digest;
    write();
  }
  encoder.footer({bounds.to, digest, {}}, bytes);
  write();
  file.finish();
  print_blemish(loaded);
  const Exit exit = loaded.exit();
  if (json)
    print_json({{"log", options.out}, {"from", bounds.from}, {"to", bounds.to}}, exit);
  else
    std::cout << options.out << ": ticks " << bounds.from + 1 << " to " << bounds.to << " of "
              << options.log << "; to repeat: cycloid replay " << options.out << '\n';
  return exit;
}

}  // namespace

void add_cut(CLI::App& app, Action& action) {
  auto options = std::make_shared<CutOptions>();
  CLI::App* command = add_command(
      app, "cut", "Write some ticks of a log as a log of their own, which begins with the state",
      action);
  action.files.reads(command->add_option("LOG", options->log, "A .cylog file")->required());
  command->add_option("--from", options->from,
                      "Begin with the state after this tick; else as the log begins");
  command->add_option("--to", options->to, "The last tick; 0: that of the log")
      ->capture_default_str();
  action.files.writes(
      command->add_option("-o,--out", options->out, "The log to write")->required());
  add_salvage_option(command, options->loading);
  command->callback(
      [options, &action] { action.run = [=, &action] { return cut_log(*options, action.json); }; });
}

}  // namespace cycloid::cli
