#include <iostream>
#include <memory>

#include "bench/tuning/choose.hpp"
#include "bench/tuning/needs.hpp"
#include "cli/commands.hpp"
#include "cli/files.hpp"
#include "cli/output.hpp"
#include "cli/tune_text.hpp"
#include "cli/whole_file.hpp"
#include "scenes/accuracy.hpp"

namespace cycloid::cli {
namespace {

struct TuneOptions {
  std::string scene;
  std::string error;
  std::optional<double> budget_us;
  std::uint32_t ticks = 300;
  std::vector<std::string> methods;
  bool write = false;
  std::string file;
  bool no_needs = false;
  bool progress = false;
};

tuning::AskedError asked_error(const TuneOptions& options, const scenes::Scene& scene) {
  if (options.error.empty()) {
    if (const std::optional<tuning::AskedError> asked = tuning::asked_by(scene)) return *asked;
    throw Failure(kExitUsage, options.scene +
                                  ": states no accuracy: say --error 1mm, or give the scene the "
                                  "key 'accuracy'");
  }
  std::string mistake;
  const std::optional<tuning::AskedError> asked = tuning::read_asked_error(options.error, mistake);
  if (!asked) throw Failure(kExitUsage, "--error: " + mistake);
  return *asked;
}

tuning::TuneRequest request_of(const TuneOptions& options, const tuning::AskedError& asked,
                               const scenes::Scene& scene) {
  tuning::TuneRequest request;
  request.error_m = tuning::error_of(asked, scene);
  if (!(request.error_m > 0.0))
    throw Failure(kExitUsage, options.scene + ": " + tuning::text_of(asked) +
                                  " of nothing: no body moves, so none has a typical size; ask "
                                  "for a length");
  request.budget_us = options.budget_us;
  request.ticks = options.ticks;
  request.lists.methods = options.methods;
  for (const std::string& method : options.methods)
    if (!accuracy::is_method(method))
      throw Failure(kExitUsage, "--methods: there is no method '" + method +
                                    "'; docs/stability.md has their names");
  if (options.progress)
    request.progress = [](std::size_t tried, std::size_t of) {
      std::cerr << "tried " << tried << " of at most " << of << '\n';
    };
  return request;
}

/// The file that the choice goes to, or "".
std::string target_of(const TuneOptions& options) {
  if (!options.write) return options.file;
  if (!kind_of(options.scene).is_file)
    throw Failure(kExitUsage, "--write: '" + options.scene + "' is no file; say -o FILE");
  check_output(options.scene);
  return options.scene;
}

bool is_json(const std::string& file) {
  if (!kind_of(file).is_file) return true;
  const std::vector<std::byte> bytes = read_file(file);
  for (const std::byte byte : bytes) {
    const char letter = static_cast<char>(byte);
    if (letter != ' ' && letter != '\t' && letter != '\r' && letter != '\n') return letter == '{';
  }
  return false;
}

/// The scene with what was asked for and chosen, in the form it came in.
void write_choice(const TuneOptions& options, scenes::Scene scene, const TuneReport& report,
                  const std::string& file) {
  const solver::Tuning& tuning = report.best().tuning;
  scene.tuning = scenes::tuning_of(scene);
  scene.accuracy = {
      static_cast<float>(report.asked.length_m), static_cast<float>(report.asked.percent), {}};
  scenes::store_choice(scene, tuning);
  const std::vector<scenes::Mistake> mistakes = scenes::check(scene);
  if (!mistakes.empty()) throw Failure(kExitCorrupt, mistakes_text(file, mistakes));
  std::string bytes;
  if (is_json(options.scene)) {
    bytes = scenes::to_json(scene);
  } else {
    const std::vector<std::byte> binary = scenes::to_binary(scene);
    bytes.assign(reinterpret_cast<const char*>(binary.data()), binary.size());
  }
  write_file(file, bytes);
}

Exit tune(const TuneOptions& options, bool json) {
  const scenes::Scene scene = load_scene(options.scene, scenes::Untuned::kAllowed);
  const std::string target = target_of(options);
  TuneReport report;
  report.scene = scene.name.empty() ? options.scene : scene.name;
  report.has_cloths = !scene.cloths.empty();
  report.asked = asked_error(options, scene);
  report.request = request_of(options, report.asked, scene);
  report.result = tuning::choose(scene, report.request);
  if (!options.no_needs && report.best().verdict != tuning::TriedVerdict::kFaulted)
    report.needs = tuning::find_needs(tuning::as_tried(scene, report.request.error_m),
                                      report.best().measured.setting,
                                      {report.request.error_m, report.request.ticks});
  const Exit exit = report.result.chosen ? kExitGood : kExitIo;
  if (exit == kExitGood && !target.empty()) {
    write_choice(options, scene, report, target);
    report.written = target;
  }
  if (exit != kExitGood) std::cerr << "cycloid: " << unmet_text(report) << '\n';
  if (json)
    print_json(tune_json(report), exit);
  else
    print_tune(report);
  return exit;
}

void add_options(CLI::App* command, TuneOptions& options, FileOptions& files) {
  files.reads(
      command->add_option("SCENE", options.scene, "A catalogue name or a scene file")->required());
  command->add_option("--error", options.error,
                      "How far shapes may overlap and joints gape (95th percentile of the last "
                      "second): 1mm, 0.5cm, 0.002m, or 1% of a typical body's size; without it "
                      "what the scene asks for");
  command
      ->add_option("--budget-us", options.budget_us,
                   "Processor time of a tick at most. Depends on the machine; without it counted "
                   "rows decide alone")
      ->check(CLI::PositiveNumber);
  command->add_option("--ticks", options.ticks, "How long each setting is watched")
      ->capture_default_str()
      ->check(CLI::Range(60, 36000));
  command->add_option("--methods", options.methods, "Which are tried; all without it")
      ->delimiter(',');
  CLI::Option* write =
      command->add_flag("--write", options.write, "Store the choice in the scene's file");
  files.writes(
      command->add_option("-o", options.file, "Write the scene with the choice to this file")
          ->excludes(write));
  command->add_flag("--no-needs", options.no_needs, "Do not look for what the scene does not need");
  command->add_flag("--progress", options.progress, "A line on stderr for every setting");
}

}  // namespace

void add_tune(CLI::App& app, Action& action) {
  auto options = std::make_shared<TuneOptions>();
  CLI::App* command = add_command(
      app, "tune", "Choose the cheapest setting that meets an accuracy, and show why", action);
  add_options(command, *options, action.files);
  command->callback(
      [options, &action] { action.run = [=, &action] { return tune(*options, action.json); }; });
}

}  // namespace cycloid::cli
