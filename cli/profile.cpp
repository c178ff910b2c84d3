#include <algorithm>
#include <array>
#include <iomanip>
#include <iostream>
#include <memory>

#include "cli/commands.hpp"
#include "cli/match.hpp"
#include "cli/output.hpp"
#include "cli/steady_time.hpp"
#include "scenes/reasons.hpp"
#include "scenes/stage_profile.hpp"

namespace cycloid::cli {
namespace {

struct ProfileCommand {
  std::string scene;
  int warm_ticks = 60;
  int ticks = 300;
  int rounds = 5;
  StepSetting setting;
};

std::vector<scenes::SeatInput> script_of(const scenes::Scene& scene,
                                         const scenes::Simulation& simulation) {
  std::vector<scenes::SeatInput> inputs(static_cast<std::size_t>(simulation.seats()));
  for (std::size_t seat = 0; seat < inputs.size(); ++seat)
    inputs[seat] = scenes::scripted_input(scene, static_cast<int>(seat), simulation.tick() + 1);
  return inputs;
}

void require(const solver::Error& error, const std::string& scene) {
  if (!error.ok())
    throw Failure(kExitDiverged,
                  scene + ": " + std::string(error.field) + " " + scenes::reason_of(error));
}

/// Times of `ticks` ticks: the least of each over the rounds, all of which do the same, because
/// what else the machine does only adds.
struct LeastTimes {
  std::array<std::uint64_t, solver::kPhases> stage_ns{};
  std::array<std::uint64_t, solver::kPhases> calls{};
  std::uint64_t after_ns = 0;  ///< After the last phase.
  std::uint64_t plain_ns = 0;  ///< Of steps without a profile.
};

void take_least(std::uint64_t value, int round, std::uint64_t& into) {
  into = round == 0 ? value : std::min(into, value);
}

void time_plain_steps(const ProfileCommand& options, const scenes::Scene& scene, int round,
                      scenes::Simulation& simulation, LeastTimes& least) {
  std::uint64_t time_ns = 0;
  for (int i = 0; i < options.ticks; ++i) {
    const auto inputs = script_of(scene, simulation);
    const std::uint64_t start_ns = steady_ns();
    require(simulation.step(inputs), options.scene);
    time_ns += steady_ns() - start_ns;
  }
  take_least(time_ns, round, least.plain_ns);
}

void time_stages(const ProfileCommand& options, const scenes::Scene& scene, int round,
                 scenes::Simulation& simulation, LeastTimes& least) {
  scenes::StageProfile profile(steady_ns);
  for (int i = 0; i < options.ticks; ++i)
    require(profile.step(simulation, script_of(scene, simulation)), options.scene);
  for (std::uint32_t i = 0; i < solver::kPhases; ++i) {
    const scenes::StageProfile::Stage& stage = profile.stage(solver::Phase(i));
    take_least(stage.time_ns, round, least.stage_ns[i]);
    least.calls[i] = stage.calls;
  }
  take_least(profile.rest_ns(), round, least.after_ns);
}

LeastTimes time_rounds(const ProfileCommand& options, const scenes::Scene& scene,
                       scenes::Simulation& simulation) {
  LeastTimes least;
  scenes::Simulation::Saved start;
  simulation.save(start);
  for (int round = 0; round < options.rounds; ++round) {
    simulation.restore(start);
    time_plain_steps(options, scene, round, simulation, least);
    simulation.restore(start);
    time_stages(options, scene, round, simulation, least);
  }
  return least;
}

Json to_json(const ProfileCommand& options, const LeastTimes& least) {
  Json stages = Json::array();
  std::uint64_t total_ns = least.after_ns;
  for (std::uint32_t i = 0; i < solver::kPhases; ++i) {
    if (least.calls[i] == 0) continue;
    total_ns += least.stage_ns[i];
    stages.push_back({{"stage", solver::phase_name(solver::Phase(i))},
                      {"time_ns", least.stage_ns[i]},
                      {"calls", least.calls[i]}});
  }
  return {{"steps", options.ticks}, {"rounds", options.rounds},   {"total_ns", total_ns},
          {"stages", stages},       {"after_ns", least.after_ns}, {"plain_ns", least.plain_ns}};
}

void print_line(const std::string& name, double time_ns, double calls, double total_ns,
                double steps) {
  std::cout << std::left << std::setw(12) << name << std::right << std::fixed
            << std::setprecision(2) << std::setw(10) << 1e-3 * time_ns / steps
            << std::setprecision(1) << std::setw(8) << 100.0 * time_ns / total_ns << std::setw(8)
            << calls / steps << '\n';
}

void print_table(const Json& profile) {
  const auto steps = profile["steps"].get<double>();
  const auto total_ns = profile["total_ns"].get<double>();
  std::cout << "stage         us/tick  share %   calls\n";
  for (const Json& stage : profile["stages"])
    print_line(stage["stage"].get<std::string>(), stage["time_ns"].get<double>(),
               stage["calls"].get<double>(), total_ns, steps);
  print_line("after", profile["after_ns"].get<double>(), steps, total_ns, steps);
  print_line("whole", total_ns, steps, total_ns, steps);
  std::cout << "a step without the clock: " << std::setprecision(2)
            << 1e-3 * profile["plain_ns"].get<double>() / steps << " us\n";
}

Exit profile(const ProfileCommand& options, bool json) {
  const scenes::Scene scene = load_scene(options.scene);
  auto created = scenes::Simulation::create(scene);
  if (!created.ok()) throw Failure(kExitCorrupt, options.scene + ": " + created.error().field);
  scenes::Simulation& simulation = created.value();
  require(simulation.set_workers(options.setting.workers), options.scene);
  require(simulation.set_lanes(options.setting.lanes), options.scene);
  for (int i = 0; i < options.warm_ticks; ++i)
    require(simulation.step(script_of(scene, simulation)), options.scene);
  Json result = {{"scene", scene.name}};
  result.update(to_json(options, time_rounds(options, scene, simulation)));
  result["digest"] = hex16(simulation.digest());
  if (json)
    print_json(result, kExitGood);
  else
    print_table(result);
  return kExitGood;
}

}  // namespace

void add_profile(CLI::App& app, Action& action) {
  auto options = std::make_shared<ProfileCommand>();
  CLI::App* command =
      add_command(app, "profile", "Print where the time of a scene's steps goes", action);
  command->add_option("SCENE", options->scene, "A scene file or a catalogue name")->required();
  command->add_option("--warm", options->warm_ticks, "Ticks before the clock starts")
      ->capture_default_str()
      ->check(CLI::Range(0, 1000000));
  command->add_option("--ticks", options->ticks, "Ticks that are timed")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000000));
  command->add_option("--rounds", options->rounds, "How often they are; the least time counts")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  command->add_option("--workers", options->setting.workers, "Threads; changes no bit")
      ->capture_default_str()
      ->check(CLI::Range(1, 64));
  add_lanes_option(command, options->setting.lanes);
  command->callback(
      [options, &action] { action.run = [=, &action] { return profile(*options, action.json); }; });
}

}  // namespace cycloid::cli
