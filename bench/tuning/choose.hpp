#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "bench/accuracy/measure.hpp"

namespace cycloid::tuning {

/// What is asked of a setting.
struct TuneRequest {
  double error_m = 0.0;             ///< At most so much overlap and gap, steady, 95th percentile.
  std::optional<double> budget_us;  ///< Processor time of a tick at most, on this machine.
  std::uint32_t ticks = 300;        ///< How long a setting is watched.
  accuracy::GridLists lists;        ///< What is tried; empty lists: `usual_lists()`.
  /// Called before each setting with how many were tried and how many there are at most.
  std::function<void(std::size_t tried, std::size_t of)> progress;
};

enum class TriedVerdict : std::uint32_t {
  kMeets,
  kTooSlow,    ///< It meets the error, and not the budget.
  kTooCoarse,  ///< Overlaps or gaps are larger than what is asked for.
  /// More than the finest run does, by what lifts all bodies by the error; only of scenes in which
  /// gravity alone brings any in.
  kGainsEnergy,
  kElsewhere,  ///< Something fell over, fell through or flew off: the bodies end in other places.
  kFaulted     ///< The world did not step to the end.
};

/// "meets", "too slow", ...
const char* name_of(TriedVerdict verdict);

/// A setting, and what came of it.
struct Tried {
  accuracy::Measured measured;  ///< Without sleep, so that rest shows its price.
  solver::Tuning tuning;        ///< The setting as the world has it.
  /// accuracy::position_error_m, of the scene as it runs or, if more, without sleep.
  double error_m = std::numeric_limits<double>::infinity();
  /// From where the finest settings take the bodies, see FinestRun; nothing where they are not
  /// known or the world faulted.
  std::optional<double> moved_m;
  /// Of the scene as it runs, after the last tick: what `cycloid run` prints for it.
  std::uint64_t digest = 0;
  TriedVerdict verdict = TriedVerdict::kFaulted;
};

/// Where the bodies belong at the end, by the most work that is spent on them: of three methods
/// with 32 substeps the one with the least doubt, which is its error and the way from where it ends
/// with
/// 16. Overlap alone would not do, since what has fallen down overlaps nothing.
struct FinestRun {
  bool known = false;     ///< False: every one of them faulted, and no setting is judged by it.
  std::string setting;    ///< Whose.
  double spread_m = 0.0;  ///< How far the same method with half the substeps ends from it.
  /// A setting that ends further away than this ends elsewhere: a tenth of a typical body, the
  /// error that is asked for, or twice the spread where the scene itself is unsteadier than that.
  double tolerance_m = 0.0;
  double energy_gained_j = 0.0;  ///< Metrics::energy_gained_j: by seats, motors and springs too.
};

/// What was tried, and what is best.
struct TuneResult {
  FinestRun finest;
  std::vector<Tried> tried;           ///< By rows per tick; of equals the less wrong first.
  std::optional<std::size_t> chosen;  ///< The first of `tried` that meets what is asked for.
  std::size_t nearest = 0;            ///< Where none does: the one that comes closest to it.
};

/// The scene as it is tried: without what it asks for, and with no more overlap left alone
/// (tuning.slop) than half of the error. @pre error_m > 0
scenes::Scene as_tried(scenes::Scene scene, double error_m);

/// Up to 16 substeps, 8 sweeps and 1 relax sweep of every method.
accuracy::GridLists usual_lists();

/// The cheapest setting that meets the request, by counted rows per tick: so that the same build
/// chooses the same everywhere, unless there is a budget. Settings are tried in the order of their
/// sweeps per tick, without those that would have as many rows as the best so far even with half
/// as many per sweep as any tried one of their method. A cheaper one is missed only where it has
/// fewer than that; of a method that faults in each, all are tried.
///
/// It is the scene `as_tried` that is measured.
/// @pre the scene has no mistake but that it lacks a choice; request.error_m > 0; all methods
/// exist.
TuneResult choose(const scenes::Scene& scene, const TuneRequest& request);

/// Measures one setting for the request, as `choose` does. @pre as for `choose`.
Tried try_setting(const scenes::Scene& scene, const TuneRequest& request,
                  const accuracy::Setting& setting);

}  // namespace cycloid::tuning
