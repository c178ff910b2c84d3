#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>

#include "bench/accuracy/chart_files.hpp"
#include "bench/figures/gnuplot.hpp"
#include "bench/figures/machine.hpp"
#include "cli/commands.hpp"
#include "cli/files.hpp"
#include "cli/output.hpp"
#include "cli/visible.hpp"
#include "cli/whole_file.hpp"
#include "solver/validate.hpp"

namespace cycloid::cli {
namespace {

constexpr std::uint32_t kTicksDefault = 300;
constexpr std::uint32_t kTicksQuick = 90;

struct ChartOptions {
  std::vector<std::string> scenes;
  std::string out;
  accuracy::GridLists lists{{}, {1, 2, 4, 8, 16}, {1, 2, 4, 8}, {}};
  std::vector<std::string> errors = {"position", "worst"};
  std::uint32_t ticks = 0;
  std::uint32_t repeats = 3;
  double moved_max_m = 0.0;
  bool consistency = false;
  bool sleep = false;
  bool quick = false;
  std::string commit = "unknown";
};

std::optional<scenes::Trial> trial_named(const std::string& name) {
  for (const scenes::Trial& trial : scenes::trials())
    if (trial.name == name) return trial;
  return {};
}

/// What `cycloid run` takes; or a trial as `cycloid trials` takes it, where that is no scene's
/// name.
accuracy::SceneChart open_chart(const std::string& what, const ChartOptions& options) {
  accuracy::SceneChart chart;
  chart.trial = trial_named(what);
  if (!chart.trial && !kind_of(what).exists && !scenes::find(what).scene)
    chart.trial = trial_named("trial-" + what);
  if (chart.trial)
    chart.subject = {chart.trial->make(), chart.trial->ticks, trials::judge_of(*chart.trial).act};
  else
    chart.subject = {load_scene(what), kTicksDefault, nullptr};
  chart.name = chart.subject.scene.name;
  if (chart.name.empty()) chart.name = std::filesystem::path(what).stem().string();
  // The judge of a trial knows when it is over; fewer ticks would judge another scene.
  if (options.ticks != 0) chart.subject.ticks = options.ticks;
  if (options.quick && !chart.trial)
    chart.subject.ticks = std::min(chart.subject.ticks, kTicksQuick);
  if (chart.trial && chart.subject.ticks != chart.trial->ticks) chart.trial.reset();
  chart.moved_max_m = options.moved_max_m;
  return chart;
}

std::vector<const accuracy::ErrorKind*> chosen_errors(const ChartOptions& options) {
  std::vector<const accuracy::ErrorKind*> errors;
  for (const std::string& name : options.errors) {
    const accuracy::ErrorKind* kind = accuracy::find_error_kind(name);
    if (kind != nullptr) {
      if (std::find(errors.begin(), errors.end(), kind) == errors.end()) errors.push_back(kind);
      continue;
    }
    std::string known;
    for (const accuracy::ErrorKind& each : accuracy::error_kinds())
      known += (known.empty() ? "" : ", ") + std::string(each.name);
    throw Failure(kExitUsage, "--error: there is no error '" + name + "'; there are " + known);
  }
  return errors;
}

void check_methods(const ChartOptions& options) {
  for (const std::string& name : options.lists.methods) {
    if (accuracy::is_method(name)) continue;
    std::string known;
    for (const accuracy::Setting& each : accuracy::grid({}))
      known += (known.empty() ? "" : ", ") + each.method;
    throw Failure(kExitUsage, "--methods: there is no method '" + name + "'; there are " + known);
  }
}

/// No world takes more sweeps than that, which would end the run at such a setting.
void check_sweeps(const std::vector<accuracy::Setting>& settings) {
  for (const accuracy::Setting& setting : settings) {
    const std::uint64_t sweeps = accuracy::sweeps_per_tick(accuracy::tuning_of(setting, {}));
    if (sweeps <= solver::kSweepsMax) continue;
    throw Failure(kExitUsage, "--substeps, --sweeps, --relax: '" + name_of(setting) + "' makes " +
                                  std::to_string(sweeps) + " sweeps in a tick; at most " +
                                  std::to_string(solver::kSweepsMax) + " are allowed");
  }
}

accuracy::ChartPlan make_plan(const ChartOptions& options) {
  check_methods(options);
  accuracy::ChartPlan plan;
  accuracy::GridLists lists = options.lists;
  if (options.quick) {
    lists.substeps = {1, 4};
    lists.sweeps = {1, 4};
  }
  plan.settings = accuracy::grid(lists);
  check_sweeps(plan.settings);
  plan.repeats = options.quick ? std::min(options.repeats, 1u) : options.repeats;
  plan.measure.consistency = options.consistency;
  plan.measure.sleep = options.sleep;
  for (const std::string& what : options.scenes) {
    plan.scenes.push_back(open_chart(what, options));
    for (std::size_t i = 0; i + 1 < plan.scenes.size(); ++i)
      if (plan.scenes[i].name == plan.scenes.back().name)
        throw Failure(kExitUsage, "SCENE: '" + plan.scenes.back().name + "' is there twice");
  }
  return plan;
}

/// A bar on a terminal; elsewhere nothing.
class ProgressBar {
 public:
  void tell(const accuracy::ChartProgress& progress) {
    if (!shown_) return;
    static constexpr int kWidth = 30;
    const int full = static_cast<int>(progress.done * kWidth);
    std::string line = "\r[" + std::string(static_cast<std::size_t>(full), '#') +
                       std::string(static_cast<std::size_t>(kWidth - full), '.') + "] " +
                       std::to_string(static_cast<int>(100.0 * progress.done)) + " %" +
                       left(progress.done) + ' ' + visible(progress.what);
    line.resize(100, ' ');
    std::cerr << line << std::flush;
  }
  void end() {
    if (shown_) std::cerr << '\r' << std::string(100, ' ') << '\r' << std::flush;
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::string left(double done) const {
    const double spent_s = std::chrono::duration<double>(Clock::now() - begin_).count();
    if (done < 0.01 || spent_s < 1.0) return "";
    const int left_s = static_cast<int>(spent_s * (1.0 - done) / done) + 1;
    return ", " + std::to_string(left_s / 60) + " min " + std::to_string(left_s % 60) + " s left";
  }
  bool shown_ = isatty(STDERR_FILENO) != 0;
  Clock::time_point begin_ = Clock::now();
};

/// Else it would be missed after the run.
void check_gnuplot() {
  if (!figures::has_gnuplot())
    throw Failure(kExitIo,
                  "gnuplot, which draws the figures, cannot be run; is the package gnuplot-nox "
                  "installed?");
}

void make_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw Failure(kExitIo, "--out: " + folder + ": cannot be made: " + error.message());
}

/// @returns the names of the files written.
std::vector<std::string> write_chart(const accuracy::ChartPlan& plan, const ChartOptions& options) {
  const accuracy::ChartOrigin origin{figures::machine_text(), __VERSION__, options.commit,
                                     figures::date_text()};
  const auto errors = chosen_errors(options);
  try {
    return write_chart_files(plan, errors, options.out, origin, write_file);
  } catch (const Failure&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw Failure(kExitIo, error.what());
  }
}

Json json_of(const accuracy::ChartPlan& plan, const accuracy::ErrorKind& error) {
  Json charts = Json::array();
  for (const accuracy::SceneChart& chart : plan.scenes) {
    Json front = Json::array();
    for (const std::size_t index : pareto_front(chart, error, accuracy::CostAxis::kRows)) {
      const accuracy::Measured& measured = chart.points[index].measured;
      front.push_back({{"setting", name_of(measured.setting)},
                       {"rows_per_tick", measured.price.rows_per_tick},
                       {"error", error.of(measured).value_or(0.0)},
                       {"digest", hex16(measured.digest)}});
    }
    charts.push_back({{"scene", chart.name}, {"settings", chart.points.size()}, {"front", front}});
  }
  return charts;
}

Exit run_chart_command(const ChartOptions& options, bool json) {
  const auto errors = chosen_errors(options);
  accuracy::ChartPlan plan = make_plan(options);
  check_gnuplot();
  make_folder(options.out);
  check_output(accuracy::chart_csv_file(options.out));
  ProgressBar bar;
  run_chart(plan, [&](const accuracy::ChartProgress& progress) { bar.tell(progress); });
  bar.end();
  const std::vector<std::string> files = write_chart(plan, options);
  if (json) {
    print_json({{"charts", json_of(plan, *errors.front())}, {"files", files}}, kExitGood);
    return kExitGood;
  }
  for (const accuracy::SceneChart& chart : plan.scenes) {
    std::cout << visible(chart.name) << ": " << chart.points.size() << " settings; the front of "
              << errors.front()->name << " over rows:\n";
    for (const std::size_t index :
         pareto_front(chart, *errors.front(), accuracy::CostAxis::kRows)) {
      const accuracy::Measured& measured = chart.points[index].measured;
      std::cout << "  " << name_of(measured.setting) << ": "
                << accuracy::short_number(measured.price.rows_per_tick) << " rows, error "
                << accuracy::short_number(errors.front()->of(measured).value_or(0.0)) << '\n';
    }
  }
  std::cout << "wrote " << files.size() << " files to " << options.out << '\n';
  return kExitGood;
}

}  // namespace

void add_chart(CLI::App& app, Action& action) {
  auto options = std::make_shared<ChartOptions>();
  CLI::App* command = add_command(
      app, "chart", "Error against cost: scenes under every method and many settings", action);
  command->add_option("SCENE", options->scenes, "Catalogue names, scene files or names of trials")
      ->required();
  command
      ->add_option(
          "--out", options->out,
          "Folder for chart.csv, fronts.md, chart.html and the figures, which gnuplot draws")
      ->required();
  const auto list = [&](const char* name, auto& values, const char* help) {
    return command->add_option(name, values, help)->delimiter(',')->capture_default_str();
  };
  list("--methods", options->lists.methods, "Which methods; none: all");
  list("--substeps", options->lists.substeps, "Substeps of a tick")->check(CLI::Range(1, 64));
  list("--sweeps", options->lists.sweeps, "Sweeps of a substep")->check(CLI::Range(1, 256));
  list("--relax", options->lists.relax_sweeps, "Relax sweeps; none: as the method is published")
      ->check(CLI::Range(0, 64));
  list("--error", options->errors, "What is drawn, the first one in the tables and fronts too");
  command->add_option("--ticks", options->ticks, "How many; 0: 300, or what a trial takes")
      ->capture_default_str()
      ->check(CLI::Range(0, 100000));
  command->add_option("--repeats", options->repeats, "Rounds of timing; 0: none")
      ->capture_default_str()
      ->check(CLI::Range(0, 1000));
  command
      ->add_option("--moved-max", options->moved_max_m,
                   "m from its start beyond which a body has fallen; 0: it may")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  command->add_option("--commit", options->commit, "Of the sources, to stand in the results")
      ->capture_default_str();
  command->add_flag("--consistency", options->consistency, "Also against 16 times smaller steps");
  command->add_flag("--sleep", options->sleep, "Let bodies sleep as the scene says");
  command->add_flag("--quick", options->quick,
                    "1 and 4 substeps and sweeps, one round; at most 90 ticks, but all of a trial");
  command->callback([options, &action] {
    action.run = [=, &action] { return run_chart_command(*options, action.json); };
  });
}

}  // namespace cycloid::cli
