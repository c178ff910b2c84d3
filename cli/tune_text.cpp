#include "cli/tune_text.hpp"

#include <iomanip>
#include <iostream>
#include <optional>
#include <sstream>

#include "bench/accuracy/settings.hpp"
#include "cli/visible.hpp"
#include "solver/version.hpp"

namespace cycloid::cli {
namespace {

using tuning::length_text;
using tuning::PartNeed;
using tuning::Tried;

std::string setting_text(const Tried& tried) {
  return accuracy::name_of(tried.measured.setting);
}

/// What nobody has measured is a dash.
std::string number_text(std::optional<double> value, int digits) {
  if (!value) return "-";
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << *value;
  return text.str();
}

/// Of a tick; a setting that faulted is not timed.
std::optional<double> time_us(const Tried& tried) {
  if (tried.verdict == tuning::TriedVerdict::kFaulted) return {};
  return 1.0e-3 * tried.measured.price.ns_per_tick;
}

void print_tried(const Tried& tried, bool chosen) {
  const bool faulted = tried.verdict == tuning::TriedVerdict::kFaulted;
  std::cout << std::left << std::setw(22) << setting_text(tried) << std::right << std::fixed
            << std::setprecision(1) << std::setw(12) << tried.measured.price.rows_per_tick
            << std::setw(10) << number_text(time_us(tried), 1) << std::setw(12)
            << (faulted ? "-" : length_text(tried.error_m)) << std::setw(12)
            << (tried.moved_m ? length_text(*tried.moved_m) : "-") << std::setw(11)
            << number_text(tried.measured.metrics.energy_gained_j, 3) << "  " << hex16(tried.digest)
            << "  " << tuning::name_of(tried.verdict) << (chosen ? " <- chosen" : "") << '\n';
}

void print_change(const char* what, double with, double without, int digits) {
  std::cout << "  " << what << ' ' << std::setprecision(digits) << with << " -> " << without;
}

void print_need(const PartNeed& need) {
  std::cout << std::left << std::setw(12) << need.part << std::setw(11)
            << tuning::name_of(need.verdict) << need.finding << '\n';
  const std::string margin(23, ' ');
  if (!need.change.empty()) std::cout << margin << need.change << '\n';
  if (!need.measured) return;
  std::cout << margin << "with -> without:" << std::fixed;
  print_change("rows", need.with.rows_per_tick, need.without.rows_per_tick, 1);
  print_change("turning", need.with.turning_rows_per_sweep, need.without.turning_rows_per_sweep, 1);
  print_change("us", need.with.us_per_tick, need.without.us_per_tick, 2);
  std::cout << "  bytes " << need.with.state_bytes << " -> " << need.without.state_bytes << '\n'
            << margin << "error " << length_text(need.with.error_m) << " -> "
            << length_text(need.without.error_m) << ", bodies at most " << length_text(need.moved_m)
            << " from where they were\n";
}

Json setting_json(const accuracy::Setting& setting) {
  return {{"method", setting.method},
          {"substeps", setting.substeps},
          {"sweeps", setting.sweeps},
          {"relax_sweeps", setting.relax_sweeps}};
}

/// What nobody has measured is null.
Json measured_or_null(std::optional<double> value) {
  return value ? Json(*value) : Json();
}

Json tried_json(const Tried& tried) {
  Json object = setting_json(tried.measured.setting);
  object["verdict"] = tuning::name_of(tried.verdict);
  object["rows_per_tick"] = tried.measured.price.rows_per_tick;
  const bool faulted = tried.verdict == tuning::TriedVerdict::kFaulted;
  object["ns_per_tick"] = faulted ? Json() : Json(tried.measured.price.ns_per_tick);
  object["state_bytes"] = tried.measured.price.state_bytes;
  object["error_m"] = faulted ? Json() : Json(tried.error_m);
  object["moved_m"] = measured_or_null(tried.moved_m);
  object["energy_gained_j"] = measured_or_null(tried.measured.metrics.energy_gained_j);
  object["digest"] = hex16(tried.digest);
  return object;
}

Json figures_json(const tuning::RunFigures& figures) {
  return {{"rows_per_tick", figures.rows_per_tick},
          {"turning_rows_per_sweep", figures.turning_rows_per_sweep},
          {"state_bytes", figures.state_bytes},
          {"us_per_tick", figures.us_per_tick},
          {"error_m", figures.error_m}};
}

Json need_json(const PartNeed& need) {
  Json object = {
      {"part", need.part}, {"verdict", tuning::name_of(need.verdict)}, {"finding", need.finding}};
  if (!need.change.empty()) object["change"] = need.change;
  if (!need.measured) return object;
  object["with"] = figures_json(need.with);
  object["without"] = figures_json(need.without);
  object["moved_m"] = need.moved_m;
  return object;
}

}  // namespace

std::string unmet_text(const TuneReport& report) {
  const Tried& nearest = report.best();
  std::string text = report.scene + ": of " + std::to_string(report.result.tried.size()) +
                     " settings none meets " + tuning::text_of(report.asked);
  if (report.request.budget_us) text += " within " + Json(*report.request.budget_us).dump() + " us";
  text += "; the nearest is " + setting_text(nearest) + ": " + tuning::name_of(nearest.verdict);
  if (nearest.verdict == tuning::TriedVerdict::kFaulted) return text;
  text += ", error " + length_text(nearest.error_m);
  if (report.request.budget_us)
    text += ", " + Json(1.0e-3 * nearest.measured.price.ns_per_tick).dump() + " us";
  return text;
}

void print_tune(const TuneReport& report) {
  const tuning::TuneResult& result = report.result;
  std::cout << visible(report.scene) << ": error " << tuning::text_of(report.asked);
  if (report.asked.percent > 0.0) std::cout << " = " << length_text(report.request.error_m);
  std::cout << ", " << report.request.ticks << " ticks";
  if (result.finest.known)
    std::cout << "; bodies belong within " << length_text(result.finest.tolerance_m) << " of where "
              << result.finest.setting << " takes them";
  std::cout << "\n\nsetting                  rows/tick   us/tick       error       moved   energy J"
            << "  digest            verdict\n";
  for (std::size_t i = 0; i < result.tried.size(); ++i)
    print_tried(result.tried[i], result.chosen == i);
  std::cout << '\n';
  if (result.chosen) std::cout << "chosen: " << setting_text(report.best()) << "\n\n";
  if (!report.needs.empty()) std::cout << "what the scene needs, for its script:\n";
  for (const PartNeed& need : report.needs) print_need(need);
  if (report.has_cloths)
    std::cout
        << "cloths are solved apart: tuning/particle_substeps and particle_sweeps stay as they "
           "are\n";
  if (!report.written.empty()) std::cout << "written: " << report.written << '\n';
}

Json tune_json(const TuneReport& report) {
  const tuning::TuneResult& result = report.result;
  Json tried = Json::array();
  for (const Tried& one : result.tried) tried.push_back(tried_json(one));
  Json needs = Json::array();
  for (const PartNeed& need : report.needs) needs.push_back(need_json(need));
  Json object = {{"scene", report.scene},
                 {"asked", tuning::text_of(report.asked)},
                 {"error_m", report.request.error_m},
                 {"ticks", report.request.ticks},
                 {"solver_version", solver::kSolverVersion},
                 {"finest", nullptr},
                 {"tried", tried},
                 {"chosen", nullptr},
                 {"nearest", nullptr},
                 {"needs", needs}};
  if (report.request.budget_us) object["budget_us"] = *report.request.budget_us;
  if (result.finest.known)
    object["finest"] = {{"setting", result.finest.setting},
                        {"spread_m", result.finest.spread_m},
                        {"tolerance_m", result.finest.tolerance_m},
                        {"energy_gained_j", result.finest.energy_gained_j}};
  object[result.chosen ? "chosen" : "nearest"] = tried_json(report.best());
  if (!report.written.empty()) object["written"] = report.written;
  return object;
}

}  // namespace cycloid::cli
