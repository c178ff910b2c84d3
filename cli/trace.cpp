#include <algorithm>
#include <iomanip>
#include <iostream>
#include <memory>
#include <optional>

#include "cli/commands.hpp"
#include "cli/trace_text.hpp"

namespace cycloid::cli {
namespace {

struct TraceCommand {
  std::string match;
  std::uint64_t tick = 0;
  std::optional<std::uint64_t> ticks;
  TraceDetail detail;
  std::string phase;
  StepSetting setting;
  LoadOptions loading;
};

Exit print_course(const TraceCommand& options, bool json) {
  const Match match = open_match(options.match, options.loading);
  const Course course = run_course(match, match.stepped_to(options.ticks), options.setting);
  const Exit exit = course.fault.empty() ? match.exit() : kExitDiverged;
  Json digests = Json::array();
  for (std::uint64_t tick = course.begin; tick <= course.last_tick(); ++tick) {
    const std::string digest = hex16(course.at(tick));
    if (json) digests.push_back({{"tick", tick}, {"digest", digest}});
    if (!json) std::cout << tick << ' ' << digest << '\n';
  }
  if (json) print_json({{"digests", digests}, {"fault", course.fault}}, exit);
  if (!course.fault.empty()) {
    std::cerr << "cycloid: " << match.name << ": the world does not step to tick "
              << course.last_tick() << ": " << course.fault << '\n';
  }
  return exit;
}

void print_phase(const solver::TracedPhase& phase) {
  std::cout << std::left << std::setw(32) << point_text(phase.at) << hex16(phase.digest) << '\n';
  for (const solver::TracedObject& object : phase.objects)
    std::cout << "  " << std::left << std::setw(30) << object.name << hex16(object.digest) << '\n';
  for (const solver::TracedField& field : phase.fields)
    std::cout << "    " << field.object << ": " << field.name << ": " << field.value << '\n';
}

Exit print_tick(const TraceCommand& options, bool json) {
  const Match match = open_match(options.match, options.loading);
  TickTrace trace = trace_tick(match, options.tick, options.detail, options.setting);
  if (!options.phase.empty()) {
    const std::optional<solver::Phase> wanted = phase_of(options.phase);
    if (!wanted) throw Failure(kExitUsage, "--phase: there is no " + options.phase);
    std::erase_if(trace.phases, [&](const auto& phase) { return phase.at.phase != *wanted; });
  }
  const auto has_fields = [](const auto& phase) { return !phase.fields.empty(); };
  if (!options.detail.object.empty() && std::ranges::none_of(trace.phases, has_fields)) {
    throw Failure(kExitUsage, "--object: no phase of tick " + std::to_string(options.tick) +
                                  " knows a " + options.detail.object);
  }
  const Exit exit = trace.fault.empty() ? match.exit() : kExitDiverged;
  if (json) {
    Json object = {{"match", match.name}, {"tick", options.tick}};
    object.update(to_json(trace));
    print_json(std::move(object), exit);
    return exit;
  }
  for (const solver::TracedPhase& phase : trace.phases) print_phase(phase);
  if (trace.fault.empty())
    std::cout << "tick " << options.tick << ": " << hex16(trace.digest) << '\n';
  else
    std::cout << "tick " << options.tick << " cannot be made: " << trace.fault << '\n';
  return exit;
}

}  // namespace

void add_trace(CLI::App& app, Action& action) {
  auto options = std::make_shared<TraceCommand>();
  CLI::App* command = add_command(
      app, "trace", "Print the digest of every tick, or of every phase of one tick", action);
  command->add_option("MATCH", options->match, "A log, a scene file or a catalogue name")
      ->required();
  CLI::Option* tick =
      command->add_option("--tick", options->tick, "The tick to look into; 0: the start");
  add_salvage_option(command, options->loading);
  command->add_option("--ticks", options->ticks,
                      "Without --tick: how many [all of a log, 600 of a scene]");
  command->add_flag("--objects", options->detail.objects, "Also the digest of every object")
      ->needs(tick);
  command->add_option("--object", options->detail.object, "And the fields of one: 'contact 7'")
      ->needs(tick);
  command->add_option("--phase", options->phase, "Only phases of this name: 'collide'")
      ->needs(tick);
  command->add_option("--workers", options->setting.workers, "Threads; changes no bit")
      ->capture_default_str()
      ->check(CLI::Range(1, 64));
  add_lanes_option(command, options->setting.lanes);
  command->callback([options, tick, &action] {
    const bool one_tick = tick->count() > 0;
    action.run = [=, &action] {
      return one_tick ? print_tick(*options, action.json) : print_course(*options, action.json);
    };
  });
}

}  // namespace cycloid::cli
