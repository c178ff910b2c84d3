// cycloid_rival_charts: error against cost of our methods and of other people's engines, in the
// same scenes, with the same rulers. `./dev rivals` builds and runs it; --help lists what it does.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "bench/accuracy/chart_files.hpp"
#include "bench/figures/machine.hpp"
#include "bench/rivals/program/native.hpp"
#include "bench/rivals/records.hpp"
#include "bench/rivals/table.hpp"
#include "scenes/catalogue.hpp"

namespace {

namespace accuracy = cycloid::accuracy;
namespace figures = cycloid::figures;
namespace rivals = cycloid::rivals;
namespace scenes = cycloid::scenes;
namespace trials = cycloid::trials;

constexpr int kExitFailed = 1;
constexpr int kExitUsage = 2;
constexpr std::uint32_t kTicksDefault = 300;

struct Command {
  std::vector<std::string> scenes;
  bool all_trials = false;
  std::string out;
  std::string table;
  std::string export_folder;
  std::string records;
  bool native = true;
  std::vector<std::string> methods;
  std::vector<std::uint32_t> substeps = {1, 2, 4, 8, 16};
  std::vector<std::uint32_t> sweeps = {1, 4};
  std::vector<std::uint32_t> peer_substeps = {1, 2, 4, 8, 16};
  std::vector<std::uint32_t> iterations = {5, 10, 20, 40};
  std::uint32_t repeats = 3;
  std::string commit = "unknown";
};

accuracy::SceneChart chart_of_trial(const scenes::Trial& trial) {
  accuracy::SceneChart chart;
  chart.trial = trial;
  chart.subject = {trial.make(), trial.ticks, trials::judge_of(trial).act};
  chart.name = trial.name;
  return chart;
}

/// A trial, or a scene of the catalogue. Exits where there is none of the name.
accuracy::SceneChart find_chart(const std::string& name) {
  for (const scenes::Trial& trial : scenes::trials())
    if (trial.name == name) return chart_of_trial(trial);
  const auto found = scenes::find(name);
  if (!found.scene) {
    std::fprintf(stderr, "cycloid_rival_charts: SCENE: there is no scene '%s'\n", name.c_str());
    std::exit(kExitUsage);
  }
  accuracy::SceneChart chart;
  chart.subject = {*found.scene, kTicksDefault, nullptr};
  chart.subject.scene.seats.clear();  // Nobody plays: not every engine has what they would do.
  chart.subject.scene.prefabs.clear();
  chart.name = found.scene->name;
  return chart;
}

std::vector<accuracy::SceneChart> charts_of(const Command& command) {
  std::vector<accuracy::SceneChart> charts;
  for (const std::string& name : command.scenes) charts.push_back(find_chart(name));
  for (const scenes::Trial& trial : scenes::trials())
    if (command.all_trials) charts.push_back(chart_of_trial(trial));
  return charts;
}

accuracy::ChartPlan plan_of(const Command& command) {
  accuracy::ChartPlan plan;
  plan.scenes = charts_of(command);
  // The records hold ours as they hold everyone else: as WebAssembly.
  if (command.native) {
    plan.settings = accuracy::grid({command.methods, command.substeps, command.sweeps, {}});
    plan.contenders = rivals::native_contenders(command.peer_substeps, command.iterations);
  }
  if (!command.records.empty())
    for (accuracy::Contender& contender : rivals::recorded_contenders(command.records))
      if (!command.native || !accuracy::is_method(contender.setting.method))
        plan.contenders.push_back(std::move(contender));
  plan.repeats = command.repeats;
  return plan;
}

void tell(const accuracy::ChartProgress& progress) {
  std::fprintf(stderr, "\r%3.0f %% %-60.60s", 100.0 * progress.done, progress.what.c_str());
}

void write_table(const std::string& file, const accuracy::ChartPlan& plan,
                 const accuracy::ChartOrigin& origin) {
  std::ofstream stream(file);
  stream << origin.machine << ", compiler " << origin.compiler << ", commit " << origin.commit
         << ", " << origin.date << ".\n\n"
         << rivals::outcome_table(plan) << std::flush;
  if (!stream) throw std::runtime_error(file + ": cannot be written");
}

void run(const Command& command) {
  if (!command.export_folder.empty()) {
    std::filesystem::create_directories(command.export_folder);
    rivals::export_runs(charts_of(command),
                        {accuracy::grid({command.methods, command.substeps, command.sweeps, {}}),
                         command.peer_substeps},
                        command.export_folder);
    return;
  }
  accuracy::ChartPlan plan = plan_of(command);
  run_chart(plan, tell);
  std::fputc('\n', stderr);
  const accuracy::ChartOrigin origin{figures::machine_text(), __VERSION__, command.commit,
                                     figures::date_text()};
  if (!command.table.empty()) write_table(command.table, plan, origin);
  if (command.out.empty()) return;
  std::filesystem::create_directories(command.out);
  write_chart_files(plan,
                    {accuracy::find_error_kind("position"), accuracy::find_error_kind("worst")},
                    command.out, origin);
}

void add_options(CLI::App& app, Command& command) {
  const auto list = [&](const char* name, auto& values, const char* help) {
    return app.add_option(name, values, help)->delimiter(',')->capture_default_str();
  };
  app.add_option("SCENE", command.scenes, "Trials, or scenes of the catalogue");
  app.add_flag("--trials", command.all_trials, "Every trial that is not large");
  app.add_option("--out", command.out, "Folder for the charts, as `cycloid chart` writes them");
  app.add_option("--table", command.table, "File for what the trials' judges say, as Markdown");
  app.add_option("--export", command.export_folder,
                 "Run nothing: write what bench/peers/node/record.mjs runs to this folder");
  app.add_option("--records", command.records, "The folder in which record.mjs has run it");
  app.add_flag("!--no-native", command.native, "The records alone");
  list("--methods", command.methods, "Ours; none: all")
      ->check(CLI::Validator(
          [](std::string& name) {
            return accuracy::is_method(name) ? std::string() : "there is no method " + name;
          },
          "METHOD"));
  list("--substeps", command.substeps, "Of ours in a tick")->check(CLI::Range(1, 64));
  list("--sweeps", command.sweeps, "Of ours in a substep")->check(CLI::Range(1, 256));
  list("--peer-substeps", command.peer_substeps, "Of every other engine in a tick")
      ->check(CLI::Range(1, 64));
  list("--iterations", command.iterations, "Of the distribution's engines in a substep; 0: theirs")
      ->check(CLI::Range(0, 1000));
  app.add_option("--repeats", command.repeats, "Rounds of timing; 0: none")
      ->capture_default_str()
      ->check(CLI::Range(0, 1000));
  app.add_option("--commit", command.commit, "Of the sources, to stand in the results");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Our methods and other engines: error against cost", "cycloid_rival_charts");
  Command command;
  add_options(app, command);
  try {
    app.parse(argc, argv);
    run(command);
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    std::fprintf(stderr, "cycloid_rival_charts: %s (see --help)\n", error.what());
    return kExitUsage;
  } catch (const std::runtime_error& error) {
    std::fprintf(stderr, "cycloid_rival_charts: %s\n", error.what());
    return kExitFailed;
  }
  return 0;
}
