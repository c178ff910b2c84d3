#include <iostream>
#include <memory>

#include "cli/commands.hpp"
#include "cli/output.hpp"
#include "cli/replaying.hpp"
#include "cli/visible.hpp"

namespace cycloid::cli {
namespace {

struct ReplayCommand {
  std::string log;
  LoadOptions loading;
  std::uint64_t to = 0;
  bool from_start = false;
  std::uint64_t digest_every = 0;
  int workers = 1;
  int lanes = kLanesDefault;
};

void check_bounds(const ReplayCommand& options, const LoadedLog& loaded) {
  if (options.to > loaded.last_tick()) {
    throw Failure(kExitUsage, "--to: " + options.log + " has only " +
                                  std::to_string(loaded.last_tick()) + " ticks");
  }
  if (options.to != 0 && options.to + 1 < loaded.first_tick()) {
    throw Failure(kExitUsage, "--to: " + options.log + " begins after tick " +
                                  std::to_string(loaded.first_tick() - 1));
  }
}

void print_words(const ReplayCommand& options, const LoadedLog& loaded, const Replayed& replayed) {
  print_blemish(loaded);
  if (replayed.divergence) {
    std::cerr << "cycloid: " << options.log << ": " << divergence_text(*replayed.divergence)
              << '\n';
  }
}

Exit replay_log(const ReplayCommand& options, bool json) {
  const LoadedLog loaded = load_log(options.log, options.loading);
  check_bounds(options, loaded);
  ReplayOptions replaying;
  if (options.to != 0) replaying.to = options.to;
  replaying.from = options.from_start ? 0 : options.to;
  replaying.workers = options.workers;
  replaying.lanes = options.lanes;
  replaying.on_tick = [&](std::uint64_t tick, std::uint64_t digest) {
    if (json || options.digest_every == 0 || tick % options.digest_every != 0) return;
    std::cout << tick << ' ' << hex16(digest) << '\n';
  };
  const Replayed replayed = replay(loaded, replaying);
  const Exit exit = replayed.divergence ? kExitDiverged : loaded.exit();
  print_words(options, loaded, replayed);
  if (json) {
    Json object = {{"log", options.log},          {"scene", loaded.log.header.scene_name},
                   {"from", replayed.from},       {"ticks", replayed.ticks},
                   {"tick", replayed.tick()},     {"digest", hex16(replayed.digest)},
                   {"blemish", loaded.blemish()}, {"diverged_at", nullptr}};
    if (replayed.divergence) object["diverged_at"] = replayed.divergence->tick;
    print_json(std::move(object), exit);
  } else if (!replayed.divergence) {
    std::cout << "replayed " << replayed.ticks << " ticks of "
              << visible(loaded.log.header.scene_name);
    if (replayed.from != 0) std::cout << " from the state after tick " << replayed.from;
    std::cout << ", all digests equal, last " << hex16(replayed.digest) << '\n';
  }
  return exit;
}

}  // namespace

void add_replay(CLI::App& app, Action& action) {
  auto options = std::make_shared<ReplayCommand>();
  CLI::App* command = add_command(
      app, "replay", "Step the match in a log and compare the digest of every tick", action);
  command->add_option("LOG", options->log, "A .cylog file")->required();
  CLI::Option* to =
      command
          ->add_option("--to", options->to,
                       "Go to this tick, from the last state in the log that is not after it")
          ->check(CLI::PositiveNumber);
  command->add_flag("--from-start", options->from_start, "With --to: step every tick before, too")
      ->needs(to);
  add_salvage_option(command, options->loading);
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
