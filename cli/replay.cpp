#include <iostream>
#include <memory>

#include "cli/commands.hpp"
#include "cli/log_file.hpp"
#include "cli/output.hpp"

namespace cycloid::cli {
namespace {

struct ReplayCommand {
  std::string log;
  std::uint64_t to = 0;
  std::uint64_t digest_every = 0;
  int workers = 1;
  int lanes = kLanesDefault;
};

/// A log that was not closed is a match that was killed: its ticks are good. One that is torn has
/// lost something.
Exit exit_of(const LoadedLog& loaded, const Replayed& replayed) {
  if (replayed.divergence) return kExitDiverged;
  return loaded.log.state == protocol::LogState::kTorn ? kExitCorrupt : kExitGood;
}

Exit replay_log(const ReplayCommand& options, bool json) {
  const LoadedLog loaded = load_log(options.log);
  if (options.to > loaded.log.ticks.size()) {
    throw Failure(kExitUsage, "--to: " + options.log + " has only " +
                                  std::to_string(loaded.log.ticks.size()) + " ticks");
  }
  ReplayOptions replaying;
  replaying.to = options.to;
  replaying.workers = options.workers;
  replaying.lanes = options.lanes;
  replaying.on_tick = [&](std::uint64_t tick, std::uint64_t digest) {
    if (json || options.digest_every == 0 || tick % options.digest_every != 0) return;
    std::cout << tick << ' ' << hex16(digest) << '\n';
  };
  const Replayed replayed = replay(loaded, replaying);
  const Exit exit = exit_of(loaded, replayed);
  const std::string blemish = loaded.blemish();
  if (!blemish.empty()) std::cerr << "cycloid: " << options.log << ": " << blemish << '\n';
  if (replayed.divergence) {
    std::cerr << "cycloid: " << options.log << ": " << divergence_text(*replayed.divergence)
              << '\n';
  }
  if (json) {
    Json object = {{"log", options.log},      {"scene", loaded.log.header.scene_name},
                   {"ticks", replayed.ticks}, {"digest", hex16(replayed.digest)},
                   {"blemish", blemish},      {"diverged_at", nullptr}};
    if (replayed.divergence) object["diverged_at"] = replayed.divergence->tick;
    print_json(std::move(object), exit);
  } else if (!replayed.divergence) {
    std::cout << "replayed " << replayed.ticks << " ticks of " << loaded.log.header.scene_name
              << ", all digests equal, last " << hex16(replayed.digest) << '\n';
  }
  return exit;
}

}  // namespace

void add_replay(CLI::App& app, Action& action) {
  auto options = std::make_shared<ReplayCommand>();
  CLI::App* command = add_command(
      app, "replay", "Step the match in a log and compare the digest of every tick", action);
  command->add_option("LOG", options->log, "A .cylog file")->required();
  command->add_option("--to", options->to, "Stop after this tick")->check(CLI::PositiveNumber);
  command->add_option("--digest-every", options->digest_every, "Also print 'tick digest' so often");
  command->add_option("--workers", options->workers, "Threads; changes no bit")
      ->capture_default_str()
      ->check(CLI::Range(1, 64));
  add_lanes_option(command, options->lanes);
  command->callback([options, &action] {
    action.run = [=, &action] { return replay_log(*options, action.json); };
  });
}

}  // namespace cycloid::cli
