#include <iomanip>
#include <iostream>
#include <memory>
#include <sstream>

#include "bench/experiments/experiment.hpp"
#include "bench/figures/gnuplot.hpp"
#include "cli/commands.hpp"
#include "cli/output.hpp"

namespace cycloid::cli {
namespace {

struct ExperimentsOptions {
  std::vector<std::string> names;
  std::string figures;
};

std::vector<experiments::Experiment> chosen(const std::vector<std::string>& names) {
  const auto all = experiments::all();
  if (names.empty()) return {all.begin(), all.end()};
  std::vector<experiments::Experiment> found;
  for (const std::string& name : names) {
    const std::size_t before = found.size();
    for (const experiments::Experiment& experiment : all)
      if (experiment.name == name) found.push_back(experiment);
    if (found.size() > before) continue;
    std::string known;
    for (const experiments::Experiment& experiment : all)
      known += (known.empty() ? "" : ", ") + std::string(experiment.name);
    throw Failure(kExitUsage, "there is no experiment '" + name + "'; there are " + known);
  }
  return found;
}

std::string number(double value) {
  std::ostringstream text;
  text << std::setprecision(6) << value;
  return text.str();
}

void print_report(const experiments::Experiment& experiment, const experiments::Report& report) {
  std::cout << experiment.name << ": " << experiment.summary << '\n';
  for (const experiments::Check& check : report.checks)
    std::cout << (check.within() ? "  ok    " : "  WRONG ") << std::left << std::setw(68)
              << check.claim << " expected " << std::setw(11) << number(check.expected)
              << " measured " << std::setw(11) << number(check.measured) << " +- "
              << number(check.tolerance) << "  [" << check.source << "]\n";
  std::cout << '\n';
}

Json json_of(const experiments::Experiment& experiment, const experiments::Report& report) {
  Json checks = Json::array();
  for (const experiments::Check& check : report.checks)
    checks.push_back({{"claim", check.claim},
                      {"source", check.source},
                      {"expected", check.expected},
                      {"measured", check.measured},
                      {"tolerance", check.tolerance},
                      {"within", check.within()}});
  Json figures = Json::array();
  for (const experiments::Figure& figure : report.figures)
    figures.push_back({{"name", figure.name}, {"title", figure.title}});
  return {{"experiment", experiment.name},
          {"summary", experiment.summary},
          {"checks", checks},
          {"figures", figures}};
}

Exit run_experiments(const ExperimentsOptions& options, bool json) {
  std::size_t checks = 0;
  std::size_t wrong = 0;
  Json reports = Json::array();
  for (const experiments::Experiment& experiment : chosen(options.names)) {
    const experiments::Report report = experiment.run();
    if (!json) print_report(experiment, report);
    reports.push_back(json_of(experiment, report));
    checks += report.checks.size();
    for (const experiments::Check& check : report.checks) wrong += check.within() ? 0 : 1;
    if (options.figures.empty()) continue;
    for (const experiments::Figure& figure : report.figures)
      if (const std::string why = figures::draw(figure, options.figures); !why.empty())
        throw Failure(kExitIo, why);
  }
  const Exit exit = wrong == 0 ? kExitGood : kExitDiverged;
  if (json)
    print_json({{"experiments", reports}, {"checks", checks}, {"wrong", wrong}}, exit);
  else
    std::cout << checks << " numbers, " << wrong << " out of tolerance\n";
  return exit;
}

}  // namespace

void add_experiments(CLI::App& app, Action& action) {
  auto options = std::make_shared<ExperimentsOptions>();
  CLI::App* command = add_command(
      app, "experiments",
      "Run the talks' experiments: claim, expected, measured; 1 if one is wrong", action);
  command->add_option("NAME", options->names, "Which; none: all");
  command->add_option("--figures", options->figures, "Also draw their figures into this folder");
  command->callback([options, &action] {
    action.run = [=, &action] { return run_experiments(*options, action.json); };
  });
}

}  // namespace cycloid::cli
