#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>
#include <vector>

#include "cli/commands.hpp"
#include "cli/output.hpp"
#include "client/replica/sync_test.hpp"

namespace cycloid::cli {
namespace {

struct SyncTestCommand {
  std::string scene;
  bool catalogue = false;
  std::uint32_t distance = 0;
  std::uint64_t ticks = 120;
};

struct Tested {
  std::string scene;
  std::uint64_t ticks = 0;
  std::uint64_t steps = 0;
  std::optional<client::SyncFailure> failure;
};

Tested test_scene(const std::string& name, const scenes::Scene& scene,
                  const SyncTestCommand& command) {
  Tested tested;
  tested.scene = name;
  client::RewindableScene world(scene);
  client::SyncTest test(world, {command.distance});
  while (tested.ticks < command.ticks && !tested.failure) {
    tested.failure = test.advance();
    ++tested.ticks;
  }
  tested.steps = test.steps();
  return tested;
}

Json to_json(const Tested& tested) {
  Json object = {{"scene", tested.scene},
                 {"ticks", tested.ticks},
                 {"steps", tested.steps},
                 {"good", !tested.failure},
                 {"failure", nullptr}};
  if (!tested.failure) return object;
  const client::SyncFailure& failure = *tested.failure;
  object["failure"] = {{"tick", failure.tick},
                       {"from_tick", failure.from_tick},
                       {"digest", hex16(failure.digest)},
                       {"digest_again", hex16(failure.digest_again)},
                       {"difference", failure.difference},
                       {"error", failure.error}};
  return object;
}

void print(const Tested& tested) {
  std::cout << tested.scene;
  if (!tested.failure) {
    std::cout << " good, " << tested.ticks << " ticks, " << tested.steps << " steps\n";
    return;
  }
  const client::SyncFailure& failure = *tested.failure;
  std::cout << " DIVERGED at tick " << failure.tick << ", stepped again from tick "
            << failure.from_tick << ": ";
  if (!failure.error.empty()) {
    std::cout << failure.error << '\n';
    return;
  }
  std::cout << hex16(failure.digest) << " and then " << hex16(failure.digest_again);
  if (!failure.difference.empty()) std::cout << ", " << failure.difference;
  std::cout << '\n';
}

Exit sync_test(const SyncTestCommand& command, bool json) {
  if (command.catalogue == !command.scene.empty()) {
    throw Failure(kExitUsage, "SCENE or --catalogue: one of the two is required");
  }
  std::vector<std::string> names;
  if (!command.catalogue) names.push_back(command.scene);
  if (command.catalogue) {
    for (const auto& entry : scenes::catalogue()) names.push_back(entry.name);
  }
  Json rows = Json::array();
  Exit exit = kExitGood;
  for (const std::string& name : names) {
    const Tested tested = test_scene(name, load_scene(name), command);
    if (tested.failure) exit = kExitDiverged;
    if (json) rows.push_back(to_json(tested));
    if (!json) print(tested);
  }
  if (json) {
    print_json({{"distance", command.distance}, {"ticks", command.ticks}, {"scenes", rows}}, exit);
  }
  return exit;
}

}  // namespace

void add_synctest(CLI::App& app, Action& action) {
  auto options = std::make_shared<SyncTestCommand>();
  CLI::App* command = add_command(
      app, "synctest", "Step, go back, step again: the state must come out the same", action);
  command->add_option("SCENE", options->scene, "A catalogue name or a scene file");
  command->add_flag("--catalogue", options->catalogue, "Every scene of the catalogue");
  command->add_option("--distance", options->distance, "Ticks to go back; 0: 1 to 8 in turn")
      ->capture_default_str()
      ->check(CLI::Range(0u, client::kSyncDistanceMax));
  command->add_option("--ticks", options->ticks, "How many ticks of each scene")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  command->callback([options, &action] {
    action.run = [=, &action] { return sync_test(*options, action.json); };
  });
}

}  // namespace cycloid::cli
