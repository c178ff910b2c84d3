#pragma once

#include <optional>
#include <vector>

#include "bench/tuning/asked_error.hpp"
#include "bench/tuning/choose.hpp"
#include "bench/tuning/needs.hpp"
#include "cli/output.hpp"

namespace cycloid::cli {

/// All that `cycloid tune` has found.
struct TuneReport {
  std::string scene;
  tuning::AskedError asked;
  tuning::TuneRequest request;
  tuning::TuneResult result;
  std::vector<tuning::PartNeed> needs;  ///< At the chosen setting, or else at the nearest.
  bool has_cloths = false;              ///< Whose settings are not chosen.
  std::string written;                  ///< The file with the choice, or "".

  const tuning::Tried& best() const {
    return result.tried.at(result.chosen.value_or(result.nearest));
  }
};

/// What was tried, in order of cost, then what is chosen and what the scene does not need.
void print_tune(const TuneReport& report);

Json tune_json(const TuneReport& report);

/// Why nothing was chosen, and what comes nearest.
std::string unmet_text(const TuneReport& report);

}  // namespace cycloid::cli
