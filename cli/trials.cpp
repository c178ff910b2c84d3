#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <iterator>
#include <memory>

#include "bench/trials/expected.hpp"
#include "bench/trials/judges.hpp"
#include "bench/trials/methods.hpp"
#include "bench/trials/shares.hpp"
#include "cli/commands.hpp"
#include "cli/output.hpp"
#include "cli/trial_shares.hpp"
#include "cli/whole_file.hpp"

namespace cycloid::cli {
namespace {

struct TrialsOptions {
  std::vector<std::string> names;
  std::vector<std::string> methods;
  Sampling sampling;
  TrialsOutput output;
};

std::vector<scenes::Trial> chosen_trials(const TrialsOptions& options) {
  std::vector<scenes::Trial> found;
  if (options.names.empty()) found.assign(scenes::trials().begin(), scenes::trials().end());
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

/// @param option  which names the file.
trials::ExpectedTable read_table(const std::string& option, const std::string& file) {
  std::ifstream stream(file);
  if (!stream) throw Failure(kExitIo, file + " cannot be read");
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  trials::ExpectedTable table;
  std::string mistake;
  if (!trials::read_expected(text, table, mistake)) {
    trials::ShareTable shares;
    std::string other;
    if (trials::read_shares(text, shares, other))
      mistake = "is a table of shares; say --perturb " + std::to_string(shares.runs) +
                ", or name a table of single outcomes";
    throw Failure(kExitUsage, option + ": " + file + ": " + mistake);
  }
  return table;
}

/// @returns how many outcomes are not those of the file.
int compare(const trials::ExpectedTable& table, const trials::ExpectedTable& expected) {
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
void write_table(const trials::ExpectedTable& table, trials::ExpectedTable written,
                 const std::string& file) {
  trials::ExpectedTable whole = table;
  whole.merge(written);
  write_file(file, trials::expected_text(whole));
}

Json json_of(const trials::ExpectedTable& table) {
  Json outcomes = Json::array();
  for (const auto& [key, outcome] : table)
    outcomes.push_back({{"trial", key.first}, {"method", key.second}, {"outcome", outcome}});
  return outcomes;
}

Exit run_single(const std::vector<scenes::Trial>& chosen,
                const std::vector<trials::Method>& methods, const TrialsOutput& output) {
  // Both files are read before the first run: a wrong one must not cost minutes.
  trials::ExpectedTable expected;
  if (!output.check.empty()) expected = read_table("--check", output.check);
  trials::ExpectedTable written;
  if (!output.write.empty() && std::filesystem::exists(output.write))
    written = read_table("--write", output.write);

  trials::ExpectedTable table;
  const bool prints = !output.json && !output.markdown;
  for (const scenes::Trial& trial : chosen) {
    if (prints)
      std::cout << trial.row << " " << trial.name << ": " << trials::judge_of(trial).metric << '\n';
    for (const trials::Method& method : methods) {
      const std::string outcome = outcome_text(trials::judge(trial, method.tuning));
      table[{trial.name, method.name}] = outcome;
      if (prints)
        std::cout << "  " << std::left << std::setw(14) << method.name << outcome << std::endl;
    }
  }
  const int different = output.check.empty() ? 0 : compare(table, expected);
  if (!output.write.empty()) write_table(table, std::move(written), output.write);
  const Exit exit = different == 0 ? kExitGood : kExitDiverged;
  if (output.json) print_json({{"outcomes", json_of(table)}, {"different", different}}, exit);
  if (output.markdown) std::cout << trials::expected_markdown(table);
  return exit;
}

Exit run_trials(const TrialsOptions& options, bool json) {
  if (json && options.output.markdown)
    throw Failure(kExitUsage, "--json and --markdown: one of them, not both");
  TrialsOutput output = options.output;
  output.json = json;
  const std::vector<scenes::Trial> chosen = chosen_trials(options);
  const std::vector<trials::Method> methods = chosen_methods(options);
  if (options.sampling.runs == 0) return run_single(chosen, methods, output);
  return run_shares(chosen, methods, options.sampling, output);
}

}  // namespace

void add_trials(CLI::App& app, Action& action) {
  auto options = std::make_shared<TrialsOptions>();
  CLI::App* command = add_command(
      app, "trials",
      "Run the scenes in which methods fail, under every method; 1 if --check differs", action);
  command->add_option("NAME", options->names, "Which; none: all");
  command->add_option("--method", options->methods, "Only these methods");
  action.files.reads(command->add_option("--check", options->output.check,
                                         "Compare with this table of outcomes, or of shares"));
  action.files.writes(command->add_option("--write", options->output.write,
                                          "Write the outcomes, or shares, into this table"));
  command->add_flag("--markdown", options->output.markdown,
                    "Print a table as in docs/stability.md");
  Sampling& sampling = options->sampling;
  CLI::Option* perturb =
      command
          ->add_option("--perturb", sampling.runs,
                       "Run each so often, all but the first with every velocity changed by up to "
                       "1 mm/s; count what stands, sags and fails")
          ->check(CLI::Range(1, 100'000));
  command->add_option("--seed", sampling.seed, "Of the changes of --perturb")
      ->capture_default_str()
      ->needs(perturb);
  command->add_option("--jobs", sampling.jobs, "Runs of --perturb side by side")
      ->capture_default_str()
      ->check(CLI::Range(1, 256))
      ->needs(perturb);
  command->callback([options, &action] {
    action.run = [=, &action] { return run_trials(*options, action.json); };
  });
}

}  // namespace cycloid::cli
