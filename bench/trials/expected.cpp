#include "bench/trials/expected.hpp"

#include <algorithm>
#include <sstream>
#include <vector>

#include "bench/trials/judges.hpp"
#include "bench/trials/methods.hpp"

namespace cycloid::trials {

/// Tells an outcome from what stands there in a table of shares.
static bool begins_with_verdict(const std::string& outcome) {
  const std::string word = outcome.substr(0, outcome.find(' '));
  for (const Verdict verdict : {Verdict::kStands, Verdict::kSags, Verdict::kFails})
    if (word == verdict_name(verdict)) return true;
  return false;
}

bool read_expected(std::string_view text, ExpectedTable& table, std::string& mistake) {
  ExpectedTable read;
  std::istringstream lines{std::string(text)};
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    std::string trial;
    std::string method;
    std::string outcome;
    words >> trial >> method >> std::ws;
    std::getline(words, outcome);
    const bool whole = !trial.empty() && !method.empty() && begins_with_verdict(outcome);
    if (whole && read.emplace(std::pair(trial, method), outcome).second) continue;
    mistake = "line " + std::to_string(number) +
              (whole ? ": said twice" : ": not of the form 'trial method outcome'");
    return false;
  }
  table = std::move(read);
  return true;
}

std::string expected_text(const ExpectedTable& table) {
  std::string text =
      "# trial, method, verdict, number: written by `cycloid trials --write`; docs/stability.md\n";
  for (const scenes::Trial& trial : scenes::trials())
    for (const Method& method : methods()) {
      const auto found = table.find({trial.name, method.name});
      if (found == table.end()) continue;
      text += std::string(trial.name) + " " + method.name + " " + found->second + "\n";
    }
  return text;
}

std::string outcome_cell(const std::string& outcome) {
  const std::size_t space = outcome.find(' ');
  const std::string verdict = outcome.substr(0, space);
  const std::string number = space == std::string::npos ? "-" : outcome.substr(space + 1);
  if (verdict == "stands") return "**" + number + "**";
  return verdict == "sags" ? number : "x " + number;
}

static bool has_method(const std::map<TrialAndMethod, std::string>& cells,
                       const std::string& method) {
  return std::any_of(cells.begin(), cells.end(),
                     [&](const auto& entry) { return entry.first.second == method; });
}

std::string table_markdown(const std::map<TrialAndMethod, std::string>& cells) {
  std::string text = "| row | trial | number |";
  std::string rule = "|---|---|---|";
  std::vector<std::string> columns;
  for (const Method& method : methods()) {
    if (!has_method(cells, method.name)) continue;
    columns.push_back(method.name);
    text += " " + columns.back() + " |";
    rule += "---|";
  }
  text += "\n" + rule + "\n";
  for (const scenes::Trial& trial : scenes::trials()) {
    std::string row;
    bool any = false;
    for (const std::string& method : columns) {
      const auto found = cells.find({trial.name, method});
      any = any || found != cells.end();
      row += " " + (found == cells.end() ? "" : found->second) + " |";
    }
    if (!any) continue;
    const std::string name = std::string(trial.name).substr(sizeof "trial-" - 1);
    text += "| " + std::to_string(trial.row) + " | " + name + " | " + judge_of(trial).metric +
            " |" + row + "\n";
  }
  return text;
}

std::string expected_markdown(const ExpectedTable& table) {
  std::map<TrialAndMethod, std::string> cells;
  for (const auto& [key, outcome] : table) cells[key] = outcome_cell(outcome);
  return table_markdown(cells);
}

}  // namespace cycloid::trials
