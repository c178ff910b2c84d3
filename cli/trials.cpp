#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <iterator>
#include <memory>

#include "bench/trials/expected.hpp"
#include "bench/trials/judges.hpp"
#include "bench/trials/methods.hpp"
#include "cli/commands.hpp"
#include "cli/output.hpp"

namespace cycloid::cli {
namespace {

struct TrialsOptions {
  std::vector<std::string> names;
  std::vector<std::string> methods;
  std::string check;
  std::string write;
  bool large = false;
  bool markdown = false;
};

std::vector<scenes::Trial> chosen_trials(const TrialsOptions& options) {
  std::vector<scenes::Trial> found;
  for (const scenes::Trial& trial : scenes::trials())
    if (options.names.empty() && (options.large || !trial.large)) found.push_back(trial);
  for (const std::string& name : options.names) {
    const std::size_t before = found.size();
    for (const scenes::Trial& trial : scenes::trials())
      if (trial.name == name || trial.name == "trial-" + name) found.push_back(trial);
    if (found.size() > before) continue;
    std::string known;
    for (const scenes::Trial& trial : scenes::trials())
      known += (known.empty() ? "" : ", ") + std::string(trial.name);
    throw Failure(kExitUsage, "there is no trial '" + name + "'; there are " + known);
  }
  return found;
}

std::vector<trials::Method> chosen_methods(const TrialsOptions& options) {
  const auto all = trials::methods();
  if (options.methods.empty()) return {all.begin(), all.end()};
  std::vector<trials::Method> found;
  for (const std::string& name : options.methods) {
    const std::size_t before = found.size();
    for (const trials::Method& method : all)
      if (method.name == name) found.push_back(method);
    if (found.size() > before) continue;
    std::string known;
    for (const trials::Method& method : all)
      known += (known.empty() ? "" : ", ") + std::string(method.name);
    throw Failure(kExitUsage, "there is no method '" + name + "'; there are " + known);
  }
  return found;
}

trials::ExpectedTable read_table(const std::string& file) {
  std::ifstream stream(file);
  if (!stream) throw Failure(kExitIo, file + " cannot be read");
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  trials::ExpectedTable table;
  std::string mistake;
  if (!trials::read_expected(text, table, mistake))
    throw Failure(kExitUsage, file + ": " + mistake);
  return table;
}

/// @returns how many outcomes are not those of the file.
int compare(const trials::ExpectedTable& table, const std::string& file) {
  const trials::ExpectedTable expected = read_table(file);
  int different = 0;
  for (const auto& [key, outcome] : table) {
    const auto found = expected.find(key);
    if (found != expected.end() && found->second == outcome) continue;
    ++different;
    std::cerr << key.first << " under " << key.second << ": " << outcome << ", expected "
              << (found == expected.end() ? "nothing" : found->second) << '\n';
  }
  return different;
}

/// The file's outcomes with these in place of those of the same trial and method.
void write_table(const trials::ExpectedTable& table, const std::string& file) {
  trials::ExpectedTable whole = table;
  if (std::filesystem::exists(file)) whole.merge(read_table(file));
  std::ofstream stream(file, std::ios::trunc);
  stream << trials::expected_text(whole);
  if (!stream.flush()) throw Failure(kExitIo, file + " cannot be written");
}

Json json_of(const trials::ExpectedTable& table) {
  Json outcomes = Json::array();
  for (const auto& [key, outcome] : table)
    outcomes.push_back({{"trial", key.first}, {"method", key.second}, {"outcome", outcome}});
  return outcomes;
}

Exit run_trials(const TrialsOptions& options, bool json) {
  trials::ExpectedTable table;
  const auto methods = chosen_methods(options);
  const bool prints = !json && !options.markdown;
  for (const scenes::Trial& trial : chosen_trials(options)) {
    if (prints)
      std::cout << trial.row << " " << trial.name << ": " << trials::judge_of(trial).metric << '\n';
    for (const trials::Method& method : methods) {
      const std::string outcome = outcome_text(trials::judge(trial, method.tuning));
      table[{trial.name, method.name}] = outcome;
      if (prints)
        std::cout << "  " << std::left << std::setw(14) << method.name << outcome << std::endl;
    }
  }
  const int different = options.check.empty() ? 0 : compare(table, options.check);
  if (!options.write.empty()) write_table(table, options.write);
  const Exit exit = different == 0 ? kExitGood : kExitDiverged;
  if (json) print_json({{"outcomes", json_of(table)}, {"different", different}}, exit);
  if (options.markdown) std::cout << trials::expected_markdown(table);
  return exit;
}

}  // namespace

void add_trials(CLI::App& app, Action& action) {
  auto options = std::make_shared<TrialsOptions>();
  CLI::App* command = add_command(
      app, "trials",
      "Run the scenes in which methods fail, under every method; 1 if --check differs", action);
  command->add_option("NAME", options->names, "Which; none: all");
  command->add_option("--method", options->methods, "Only these methods");
  command->add_option("--check", options->check, "Compare with this table of outcomes");
  command->add_option("--write", options->write, "Write the outcomes into this table");
  command->add_flag("--large", options->large, "Also those that take minutes");
  command->add_flag("--markdown", options->markdown, "Print the table of docs/stability.md");
  command->callback([options, &action] {
    action.run = [=, &action] { return run_trials(*options, action.json); };
  });
}

}  // namespace cycloid::cli
