#include "cli/trial_shares.hpp"

#include <filesystem>
#include <iomanip>
#include <iostream>

#include "bench/trials/expected.hpp"
#include "bench/trials/perturb.hpp"
#include "bench/trials/shares.hpp"
#include "cli/output.hpp"
#include "cli/side_by_side.hpp"
#include "cli/whole_file.hpp"

namespace cycloid::cli {
namespace {

std::string text_of(const std::string& file) {
  const std::vector<std::byte> bytes = read_file(file);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// @param option  which names the file. A table of other runs is refused: its rows say nothing of
/// these.
trials::ShareTable read_table(const std::string& option, const std::string& file,
                              const Sampling& sampling) {
  const std::string text = text_of(file);
  trials::ShareTable table;
  std::string mistake;
  if (!trials::read_shares(text, table, mistake)) {
    trials::ExpectedTable single;
    std::string other;
    if (trials::read_expected(text, single, other) && !single.empty())
      mistake = "is a table of single outcomes; leave --perturb out, or name a table of shares";
    throw Failure(kExitUsage, option + ": " + file + ": " + mistake);
  }
  if (table.runs != sampling.runs || table.seed != sampling.seed)
    throw Failure(kExitUsage, option + ": " + file + ": says --perturb " +
                                  std::to_string(table.runs) + " --seed " +
                                  std::to_string(table.seed) + "; say the same, or name another");
  return table;
}

/// One trial under all methods: runs of all of them side by side.
void run_trial(const scenes::Trial& trial, const std::vector<trials::Method>& methods,
               const Sampling& sampling, trials::ShareTable& table) {
  const std::size_t runs = sampling.runs;
  std::vector<trials::Outcome> outcomes(methods.size() * runs);
  side_by_side(outcomes.size(), sampling.jobs, [&](std::size_t i) {
    const trials::Start start{sampling.seed, static_cast<std::uint32_t>(i % runs)};
    outcomes[i] = trials::judge_from(trial, methods[i / runs].tuning, start);
  });
  for (std::size_t i = 0; i < methods.size(); ++i)
    table.shares[{trial.name, methods[i].name}] =
        trials::shares_of(std::span(outcomes).subspan(i * runs, runs));
}

void print_head(const Sampling& sampling) {
  std::cout << sampling.runs << " runs each, seed " << sampling.seed << ": the first as it is, "
            << "in the others velocities differ by up to " << trials::kPerturbationMax_um_s / 1000
            << " mm/s\n"
            << std::left << std::setw(16) << "" << std::right << std::setw(7) << "stands"
            << std::setw(7) << "sags" << std::setw(7) << "fails" << std::setw(11) << "median"
            << std::setw(11) << "worst" << '\n';
}

void print_trial(const scenes::Trial& trial, const std::vector<trials::Method>& methods,
                 const trials::ShareTable& table) {
  std::cout << trial.row << " " << trial.name << ": " << trials::judge_of(trial).metric << '\n';
  for (const trials::Method& method : methods) {
    const trials::Shares& shares = table.shares.at({trial.name, method.name});
    std::cout << "  " << std::left << std::setw(14) << method.name << std::right << std::setw(7)
              << shares.stands << std::setw(7) << shares.sags << std::setw(7) << shares.fails
              << std::setw(11) << shares.median << std::setw(11) << shares.worst << std::endl;
  }
}

/// @returns how many rows are not those of the file.
int compare(const trials::ShareTable& table, const trials::ShareTable& expected) {
  int different = 0;
  for (const auto& [key, shares] : table.shares) {
    const auto found = expected.shares.find(key);
    if (found != expected.shares.end() && found->second == shares) continue;
    ++different;
    std::cerr << key.first << " under " << key.second << ": " << shares_words(shares)
              << ", expected "
              << (found == expected.shares.end() ? "nothing" : shares_words(found->second)) << '\n';
  }
  return different;
}

Json number_json(const std::string& text) {
  return text == "-" ? Json(nullptr) : Json::parse(text);
}

Json json_of(const trials::ShareTable& table) {
  Json rows = Json::array();
  for (const auto& [key, shares] : table.shares)
    rows.push_back({{"trial", key.first},
                    {"method", key.second},
                    {"stands", shares.stands},
                    {"sags", shares.sags},
                    {"fails", shares.fails},
                    {"median", number_json(shares.median)},
                    {"worst", number_json(shares.worst)}});
  return rows;
}

}  // namespace

Exit run_shares(const std::vector<scenes::Trial>& trials,
                const std::vector<trials::Method>& methods, const Sampling& sampling,
                const TrialsOutput& output) {
  // Both files are read before the first run: a wrong one must not cost minutes.
  trials::ShareTable expected;
  if (!output.check.empty()) expected = read_table("--check", output.check, sampling);
  trials::ShareTable written;
  if (!output.write.empty() && std::filesystem::exists(output.write))
    written = read_table("--write", output.write, sampling);

  const bool prints = !output.json && !output.markdown;
  if (prints) print_head(sampling);
  trials::ShareTable table{sampling.runs, sampling.seed, {}};
  for (const scenes::Trial& trial : trials) {
    run_trial(trial, methods, sampling, table);
    if (prints) print_trial(trial, methods, table);
  }
  const int different = output.check.empty() ? 0 : compare(table, expected);
  if (!output.write.empty()) {
    trials::ShareTable whole = table;
    whole.shares.merge(written.shares);
    write_file(output.write, shares_text(whole));
  }
  const Exit exit = different == 0 ? kExitGood : kExitDiverged;
  if (output.json)
    print_json({{"runs", sampling.runs},
                {"seed", sampling.seed},
                {"shares", json_of(table)},
                {"different", different}},
               exit);
  if (output.markdown) std::cout << trials::shares_markdown(table);
  return exit;
}

}  // namespace cycloid::cli
