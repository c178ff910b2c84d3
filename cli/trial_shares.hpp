#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/trials/methods.hpp"
#include "cli/exit_codes.hpp"
#include "scenes/trials.hpp"

namespace cycloid::cli {

/// `--perturb`: how often each trial is run, and from which starts.
struct Sampling {
  std::uint32_t runs = 0;  ///< 0: the option is not given.
  std::uint64_t seed = 1;
  int jobs = 1;  ///< Runs side by side; changes no number.
};

/// Where the outcomes of `cycloid trials` go.
struct TrialsOutput {
  std::string check;  ///< A table to compare with; "": none.
  std::string write;  ///< A table to put them into; "": none.
  bool markdown = false;
  bool json = false;
};

/// Runs each trial under each method many times from starts that differ by little, and says how
/// many of the runs stand, sag and fail. kExitDiverged where a row is not that of the file.
Exit run_shares(const std::vector<scenes::Trial>& trials,
                const std::vector<trials::Method>& methods, const Sampling& sampling,
                const TrialsOutput& output);

}  // namespace cycloid::cli
