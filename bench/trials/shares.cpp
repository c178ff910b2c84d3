#include "bench/trials/shares.hpp"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <sstream>
#include <vector>

#include "bench/trials/expected.hpp"
#include "bench/trials/methods.hpp"

namespace cycloid::trials {

static constexpr double kNoNumber = std::numeric_limits<double>::infinity();

static std::string number_text(double value) {
  if (value == kNoNumber) return "-";
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

Shares shares_of(std::span<const Outcome> outcomes) {
  Shares shares;
  std::vector<double> values;
  for (const Outcome& outcome : outcomes) {
    shares.stands += outcome.verdict == Verdict::kStands;
    shares.sags += outcome.verdict == Verdict::kSags;
    shares.fails += outcome.verdict == Verdict::kFails;
    const bool has_number = outcome.ended && std::isfinite(outcome.value);
    values.push_back(has_number ? outcome.value : kNoNumber);
  }
  // Stable: 0 and -0 are equal and print differently; the order of the runs is one everywhere.
  std::stable_sort(values.begin(), values.end());
  shares.median = number_text(values[values.size() / 2]);
  shares.worst = number_text(values.back());
  return shares;
}

std::string shares_words(const Shares& shares) {
  return std::to_string(shares.stands) + " " + std::to_string(shares.sags) + " " +
         std::to_string(shares.fails) + " " + shares.median + " " + shares.worst;
}

/// False where the word is more or less than a number without a sign.
template <typename Number>
static bool read_whole(const std::string& word, Number& number) {
  const char* end = word.data() + word.size();
  const auto [stopped, error] = std::from_chars(word.data(), end, number);
  return error == std::errc() && stopped == end && !word.empty();
}

static bool is_metric(const std::string& word) {
  if (word == "-") return true;
  std::istringstream stream(word);
  double value = 0.0;
  return stream >> value && stream.eof();
}

static std::vector<std::string> words_of(const std::string& line) {
  std::vector<std::string> words;
  std::istringstream stream(line);
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

/// @returns what is wrong with the first line that is no comment; "" where nothing is.
static std::string read_head(const std::vector<std::string>& words, ShareTable& table) {
  const bool good = words.size() == 4 && words[0] == "runs" && read_whole(words[1], table.runs) &&
                    table.runs > 0 && words[2] == "seed" && read_whole(words[3], table.seed);
  return good ? "" : "not of the form 'runs N seed S'";
}

static std::string read_row(const std::vector<std::string>& words, ShareTable& table) {
  Shares row;
  const bool good = words.size() == 7 && read_whole(words[2], row.stands) &&
                    read_whole(words[3], row.sags) && read_whole(words[4], row.fails) &&
                    is_metric(words[5]) && is_metric(words[6]);
  if (!good) return "not of the form 'trial method stands sags fails median worst'";
  row.median = words[5];
  row.worst = words[6];
  const std::uint64_t runs = std::uint64_t{row.stands} + row.sags + row.fails;
  if (runs != table.runs) return std::to_string(runs) + " runs, not " + std::to_string(table.runs);
  return table.shares.emplace(std::pair(words[0], words[1]), row).second ? "" : "said twice";
}

bool read_shares(std::string_view text, ShareTable& table, std::string& mistake) {
  ShareTable read;
  std::istringstream lines{std::string(text)};
  std::string line;
  int number = 0;
  while (std::getline(lines, line)) {
    ++number;
    if (line.empty() || line[0] == '#') continue;
    const std::vector<std::string> words = words_of(line);
    const std::string wrong = read.runs == 0 ? read_head(words, read) : read_row(words, read);
    if (wrong.empty()) continue;
    mistake = "line " + std::to_string(number) + ": " + wrong;
    return false;
  }
  if (read.runs == 0) {
    mistake = "line " + std::to_string(number + 1) + ": ends without 'runs N seed S'";
    return false;
  }
  table = std::move(read);
  return true;
}

std::string shares_text(const ShareTable& table) {
  std::string text =
      "# trial, method, runs that stand, sag and fail, median, worst: written by `cycloid trials\n"
      "# --perturb N --write`; docs/stability.md\n";
  text += "runs " + std::to_string(table.runs) + " seed " + std::to_string(table.seed) + "\n";
  for (const scenes::Trial& trial : scenes::trials())
    for (const Method& method : methods()) {
      const auto found = table.shares.find({trial.name, method.name});
      if (found == table.shares.end()) continue;
      text +=
          std::string(trial.name) + " " + method.name + " " + shares_words(found->second) + "\n";
    }
  return text;
}

/// "**20 / 0 / 0** 0.0133, 0.0145", bold where all runs stand.
static std::string shares_cell(const Shares& shares) {
  const std::string counts = std::to_string(shares.stands) + " / " + std::to_string(shares.sags) +
                             " / " + std::to_string(shares.fails);
  const bool all_stand = shares.sags == 0 && shares.fails == 0;
  return (all_stand ? "**" + counts + "**" : counts) + " " + shares.median + ", " + shares.worst;
}

std::string shares_markdown(const ShareTable& table) {
  std::map<TrialAndMethod, std::string> cells;
  for (const auto& [key, shares] : table.shares) cells[key] = shares_cell(shares);
  return table_markdown(cells);
}

}  // namespace cycloid::trials
