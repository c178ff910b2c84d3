#include <algorithm>
#include <array>
#include <iomanip>
#include <iostream>
#include <map>
#include <memory>
#include <mutex>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/commands.hpp"
#include "cli/output.hpp"
#include "cli/side_by_side.hpp"
#include "cli/sim/world.hpp"

namespace cycloid::cli {
namespace {

struct SimCommand {
  std::uint64_t seed = 1;
  std::uint64_t seeds = 1;
  std::uint64_t from = 1;
  std::uint64_t ticks = 0;  ///< 0: as the seed says.
  std::string scene;        ///< "": likewise.
  std::string plant = "none";
  int jobs = 1;
  bool many = false;
  bool verbose = false;
};

std::vector<std::string> plant_names() {
  std::vector<std::string> names;
  for (int plant = 0; plant < static_cast<int>(sim::Plant::kCount); ++plant) {
    names.emplace_back(sim::plant_name(static_cast<sim::Plant>(plant)));
  }
  return names;
}

sim::Settings settings_of(const SimCommand& command, std::uint64_t seed) {
  sim::Settings settings = sim::draw_settings(seed);
  if (command.ticks != 0) settings.ticks = command.ticks;
  if (!command.scene.empty()) settings.scene = command.scene;
  const std::vector<std::string> names = plant_names();
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i] == command.plant) settings.plant = static_cast<sim::Plant>(i);
  }
  return settings;
}

/// As a shell takes it for one word.
std::string shell_word(const std::string& text) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view("-_./:=,+@%").find(c) != std::string_view::npos;
  };
  if (!text.empty() && std::ranges::all_of(text, plain)) return text;
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

/// What repeats a run.
std::string line_of(const SimCommand& command, std::uint64_t seed) {
  std::string line = "cycloid sim --seed " + std::to_string(seed);
  if (command.ticks != 0) line += " --ticks " + std::to_string(command.ticks);
  if (!command.scene.empty()) line += " --scene " + shell_word(command.scene);
  if (command.plant != "none") line += " --plant " + command.plant;
  return line;
}

std::string seconds(std::int64_t ns) {
  const std::string ms = std::to_string(ns / 1'000'000 % 1000 + 1000);
  return std::to_string(ns / 1'000'000'000) + "." + ms.substr(1) + " s";
}

void print_violation(const SimCommand& command, const sim::SimReport& report) {
  std::cout << line_of(command, report.seed) << "\n  "
            << sim::invariant_name(report.violation->invariant) << " at "
            << seconds(report.violation->at_ns) << ": " << report.violation->text << std::endl;
}

Json violation_json(const SimCommand& command, const sim::SimReport& report) {
  return {{"line", line_of(command, report.seed)},
          {"seed", report.seed},
          {"invariant", sim::invariant_name(report.violation->invariant)},
          {"at_ms", report.violation->at_ns / 1'000'000},
          {"text", report.violation->text}};
}

/// What the runs met, in sum.
using Met = std::array<std::uint64_t, static_cast<std::size_t>(sim::Event::kCount)>;

void add(const sim::SimReport& report, Met& met) {
  for (std::size_t i = 0; i < met.size(); ++i) {
    met[i] += report.chronicle.counted(static_cast<sim::Event>(i));
  }
}

void print_met(const Met& met) {
  for (std::size_t i = 0; i < met.size(); ++i) {
    std::cout << "  " << std::left << std::setw(18) << sim::event_name(static_cast<sim::Event>(i))
              << met[i] << '\n';
  }
}

Json met_json(const Met& met) {
  Json object = Json::object();
  for (std::size_t i = 0; i < met.size(); ++i) {
    object[sim::event_name(static_cast<sim::Event>(i))] = met[i];
  }
  return object;
}

Exit run_one(const SimCommand& command, bool json) {
  sim::Narrator narrate;
  if (command.verbose) {
    std::ostream& out = json ? std::cerr : std::cout;
    narrate = [&out](std::int64_t now_ns, const std::string& line) {
      out << std::right << std::setw(12) << seconds(now_ns) << "  " << line << '\n';
    };
  }
  const sim::Settings settings = settings_of(command, command.seed);
  const sim::SimReport report = sim::simulate(settings, narrate);
  const Exit exit = report.passed() ? kExitGood : kExitDiverged;
  Met met{};
  add(report, met);
  if (json) {
    Json object = {{"seed", report.seed},
                   {"scene", settings.scene},
                   {"passed", report.passed()},
                   {"violation", nullptr},
                   {"digest", hex16(report.digest)},
                   {"ticks", report.ticks},
                   {"virtual_ms", report.virtual_ns / 1'000'000},
                   {"convergence_ms", nullptr},
                   {"met", met_json(met)}};
    if (report.convergence_ns) object["convergence_ms"] = *report.convergence_ns / 1'000'000;
    if (!report.passed()) object["violation"] = violation_json(command, report);
    print_json(object, exit);
    return exit;
  }
  std::cout << "scene " << settings.scene << ", rooms " << settings.rooms << ", ticks "
            << report.ticks << ", virtual time " << seconds(report.virtual_ns);
  if (report.convergence_ns)
    std::cout << ", in sync " << seconds(*report.convergence_ns) << " after the faults";
  std::cout << '\n';
  print_met(met);
  std::cout << "digest " << hex16(report.digest) << '\n';
  if (report.passed()) std::cout << "passed\n";
  if (!report.passed()) print_violation(command, report);
  return exit;
}

Exit run_many(const SimCommand& command, bool json) {
  Met met{};
  std::vector<std::uint64_t> digests(command.seeds);
  std::int64_t virtual_ns = 0;
  std::map<std::uint64_t, Json> failed;  // By seed, whichever thread was done first.
  std::mutex mutex;
  side_by_side(command.seeds, command.jobs, [&](std::size_t i) {
    const std::uint64_t seed = command.from + i;
    const sim::SimReport report = sim::simulate(settings_of(command, seed));
    const std::scoped_lock lock(mutex);
    digests[i] = report.digest;
    virtual_ns += report.virtual_ns;
    add(report, met);
    if (report.passed()) return;
    failed.emplace(seed, violation_json(command, report));
    if (!json) print_violation(command, report);
  });
  std::uint64_t digest = 0;
  for (const std::uint64_t one : digests) digest = sim::scramble(digest ^ one);
  const Exit exit = failed.empty() ? kExitGood : kExitDiverged;
  if (json) {
    Json violations = Json::array();
    for (const auto& [seed, violation] : failed) violations.push_back(violation);
    print_json({{"from", command.from},
                {"seeds", command.seeds},
                {"failed", std::move(violations)},
                {"digest", hex16(digest)},
                {"virtual_ms", virtual_ns / 1'000'000},
                {"met", met_json(met)}},
               exit);
    return exit;
  }
  print_met(met);
  std::cout << "digest " << hex16(digest) << '\n'
            << command.seeds << " seeds from " << command.from << ", " << seconds(virtual_ns)
            << " of virtual time: " << failed.size() << " failed\n";
  return exit;
}

Exit run_sim(const SimCommand& command, bool json) {
  if (!command.scene.empty() && command.scene != "tiny") (void)load_scene(command.scene);
  return command.many ? run_many(command, json) : run_one(command, json);
}

}  // namespace

void add_sim(CLI::App& app, Action& action) {
  auto options = std::make_shared<SimCommand>();
  CLI::App* command = add_command(
      app, "sim",
      "Play rooms, clients, network and disk under a seed, with faults, and check invariants",
      action);
  CLI::Option* seed =
      command->add_option("--seed", options->seed, "The run to play")->capture_default_str();
  CLI::Option* seeds =
      command->add_option("--seeds", options->seeds, "Play so many runs instead, one per seed")
          ->check(CLI::Range(1, 10'000'000))
          ->excludes(seed);
  command->add_option("--from", options->from, "First of --seeds")
      ->capture_default_str()
      ->needs(seeds);
  command->add_option("--jobs", options->jobs, "Runs of --seeds side by side")
      ->capture_default_str()
      ->check(CLI::Range(1, 256))
      ->needs(seeds);
  command->add_option("--ticks", options->ticks, "With faults, instead of what the seed says")
      ->check(CLI::Range(1, 1'000'000));
  command->add_option("--scene", options->scene,
                      "'tiny', a catalogue name or a scene file, instead of what the seed says");
  command->add_option("--plant", options->plant, "A bug to play with, to see that it is found")
      ->capture_default_str()
      ->check(CLI::IsMember(plant_names()));
  command
      ->add_flag("-v,--verbose", options->verbose,
                 "Every line of what happens in a run (with --json on stderr)")
      ->excludes(seeds);
  command->callback([options, seeds, &action] {
    options->many = seeds->count() != 0;
    action.run = [=, &action] { return run_sim(*options, action.json); };
  });
}

}  // namespace cycloid::cli
