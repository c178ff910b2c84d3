#include "bench/tuning/choose.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "bench/tuning/asked_error.hpp"
#include "bench/tuning/passage.hpp"
#include "scenes/accuracy.hpp"

namespace cycloid::tuning {
namespace {

constexpr std::uint32_t kFinestSubsteps = 32;
/// Of a typical body's size: a body that ends further away than this is in another place.
constexpr double kElsewhereOfSize = 0.1;
constexpr std::array<const char*, 3> kFinestMethods = {"soft-step", "tgs-ngs", "soft-direct"};

Passage run_with(const scenes::Scene& scene, const accuracy::Setting& setting,
                 std::uint32_t ticks) {
  return run_passage(accuracy::with_setting(scene, setting), ticks);
}

/// Tries settings of one scene against one finest run.
class Chooser {
 public:
  Chooser(const scenes::Scene& scene, const TuneRequest& request)
      : request_(request), subject_{as_tried(scene, request.error_m), request.ticks, nullptr} {
    options_.direct_rows_max = 0;  // The reference's errors are not asked for.
  }

  FinestRun find_finest() {
    double least_m = std::numeric_limits<double>::infinity();
    bool is_driven = true;
    for (const char* method : kFinestMethods) {
      accuracy::Setting setting = accuracy::published(method);
      setting.substeps = kFinestSubsteps;
      accuracy::Setting half = setting;
      half.substeps /= 2;
      Passage fine = run_with(subject_.scene, setting, request_.ticks);
      const Passage coarser = run_with(subject_.scene, half, request_.ticks);
      if (!fine.ended || !coarser.ended) continue;
      const double spread_m = distance_at_end_m(fine, coarser);
      const accuracy::Measured measured = accuracy::measure(subject_, setting, options_);
      const double doubt_m = spread_m + accuracy::position_error_m(measured);
      if (!(doubt_m < least_m)) continue;
      least_m = doubt_m;
      is_driven = !measured.metrics.energy_gained_share;
      finest_ = {true, accuracy::name_of(setting), spread_m, 0.0,
                 measured.metrics.energy_gained_j.value_or(0.0)};
      finest_passage_ = std::move(fine);
    }
    finest_.tolerance_m = std::max({kElsewhereOfSize * typical_size_m(subject_.scene),
                                    2.0 * finest_.spread_m, request_.error_m});
    if (!is_driven) {
      energy_max_j_ = finest_.energy_gained_j;
      for (const MovingBody& body : finest_passage_.bodies)
        energy_max_j_ += body.weight_n * request_.error_m;
    }
    return finest_;
  }

  Tried try_one(const accuracy::Setting& setting) const {
    Tried tried;
    tried.measured = accuracy::measure(subject_, setting, options_);
    tried.tuning = accuracy::tuning_of(setting, subject_.scene.tuning);
    const Passage passage = run_with(subject_.scene, setting, request_.ticks);
    tried.digest = passage.digest;
    if (!tried.measured.ended || !passage.ended) return tried;
    tried.measured.price.ns_per_tick = accuracy::time_ticks(subject_, setting, options_);
    tried.error_m = accuracy::position_error_m(tried.measured);
    if (tried.error_m <= request_.error_m && subject_.scene.tuning.sleep_s > 0.0f) {
      // What falls asleep before it has settled stays as wrong as it is.
      accuracy::MeasureOptions as_it_runs = options_;
      as_it_runs.sleep = true;
      tried.error_m =
          std::max(tried.error_m,
                   accuracy::position_error_m(accuracy::measure(subject_, setting, as_it_runs)));
    }
    if (finest_.known) tried.moved_m = distance_at_end_m(finest_passage_, passage);
    tried.verdict = judge(tried);
    return tried;
  }

 private:
  TriedVerdict judge(const Tried& tried) const {
    if (!(tried.error_m <= request_.error_m)) return TriedVerdict::kTooCoarse;
    if (finest_.known && tried.measured.metrics.energy_gained_j > energy_max_j_)
      return TriedVerdict::kGainsEnergy;
    if (finest_.known && !(tried.moved_m <= finest_.tolerance_m)) return TriedVerdict::kElsewhere;
    const bool slow =
        request_.budget_us && tried.measured.price.ns_per_tick > 1.0e3 * *request_.budget_us;
    return slow ? TriedVerdict::kTooSlow : TriedVerdict::kMeets;
  }

  const TuneRequest& request_;
  accuracy::Subject subject_;
  accuracy::MeasureOptions options_;
  FinestRun finest_;
  Passage finest_passage_;
  double energy_max_j_ = std::numeric_limits<double>::infinity();
};

/// By key, and of equals as they were.
template <class T, class Key>
std::vector<T> in_order_of(const std::vector<T>& unsorted, const Key& key) {
  std::vector<std::size_t> order(unsorted.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  // Total order: no place is there twice.
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(key(unsorted[a]), a) < std::pair(key(unsorted[b]), b);
  });
  std::vector<T> sorted;
  for (const std::size_t place : order) sorted.push_back(unsorted[place]);
  return sorted;
}

std::uint64_t sweeps_of(const accuracy::Setting& setting) {
  return accuracy::sweeps_per_tick(accuracy::tuning_of(setting, {}));
}

std::vector<accuracy::Setting> in_order_of_sweeps(const TuneRequest& request) {
  accuracy::GridLists lists = request.lists;
  const accuracy::GridLists usual = usual_lists();
  if (lists.substeps.empty()) lists.substeps = usual.substeps;
  if (lists.sweeps.empty()) lists.sweeps = usual.sweeps;
  if (lists.relax_sweeps.empty()) lists.relax_sweeps = usual.relax_sweeps;
  return in_order_of<accuracy::Setting>(accuracy::grid(lists), sweeps_of);
}

/// Of the fewest rows per sweep that a method has shown, what it may still come down to: more
/// sweeps may lose contacts, and where islands are solved at once half of the substeps may be left
/// out.
constexpr double kRowsLeft = 0.5;

/// What settings cost at least, by those of their method before.
class LeastRows {
 public:
  void add(const Tried& tried) {
    if (tried.verdict == TriedVerdict::kFaulted) return;
    const accuracy::Setting& setting = tried.measured.setting;
    const double per_sweep =
        tried.measured.price.rows_per_tick / static_cast<double>(sweeps_of(setting));
    const auto [fewest, is_new] = per_sweep_.emplace(setting.method, per_sweep);
    if (!is_new) fewest->second = std::min(fewest->second, per_sweep);
  }
  /// 0 while nothing is known of the method.
  double of(const accuracy::Setting& setting) const {
    const auto fewest = per_sweep_.find(setting.method);
    if (fewest == per_sweep_.end()) return 0.0;
    return kRowsLeft * fewest->second * static_cast<double>(sweeps_of(setting));
  }

 private:
  std::map<std::string, double> per_sweep_;
};

/// How far a setting is from what is asked for; of two the nearer has the less.
std::pair<std::uint32_t, double> distance_from(const Tried& tried) {
  // What is too slow is right; what is too coarse is right but for the size of its errors.
  const bool slow = tried.verdict == TriedVerdict::kTooSlow;
  return {static_cast<std::uint32_t>(tried.verdict),
          slow ? tried.measured.price.ns_per_tick : tried.error_m};
}

}  // namespace

const char* name_of(TriedVerdict verdict) {
  switch (verdict) {
    case TriedVerdict::kMeets:
      return "meets";
    case TriedVerdict::kTooSlow:
      return "too slow";
    case TriedVerdict::kTooCoarse:
      return "too coarse";
    case TriedVerdict::kGainsEnergy:
      return "gains energy";
    case TriedVerdict::kElsewhere:
      return "elsewhere";
    case TriedVerdict::kFaulted:
      return "faulted";
  }
  return "unknown";
}

scenes::Scene as_tried(scenes::Scene scene, double error_m) {
  scene.tuning = scenes::tuning_of(scene);
  scene.accuracy = {};
  scene.tuning.slop = std::min(scene.tuning.slop, static_cast<float>(0.5 * error_m));
  return scene;
}

accuracy::GridLists usual_lists() {
  return {{}, {1, 2, 4, 8, 16}, {1, 2, 4, 8}, {0, 1}};
}

TuneResult choose(const scenes::Scene& scene, const TuneRequest& request) {
  Chooser chooser(scene, request);
  TuneResult result;
  const std::vector<accuracy::Setting> settings = in_order_of_sweeps(request);
  if (request.progress) request.progress(0, settings.size());
  result.finest = chooser.find_finest();
  LeastRows least_rows;
  double best_rows = std::numeric_limits<double>::infinity();
  for (const accuracy::Setting& setting : settings) {
    if (least_rows.of(setting) >= best_rows) continue;
    if (request.progress) request.progress(result.tried.size(), settings.size());
    const Tried& tried = result.tried.emplace_back(chooser.try_one(setting));
    least_rows.add(tried);
    if (tried.verdict == TriedVerdict::kMeets)
      best_rows = std::min(best_rows, tried.measured.price.rows_per_tick);
  }
  result.tried = in_order_of<Tried>(result.tried, [](const Tried& tried) {
    return std::pair(tried.measured.price.rows_per_tick, tried.error_m);
  });
  for (std::size_t i = 0; i < result.tried.size(); ++i) {
    if (result.tried[i].verdict == TriedVerdict::kMeets && !result.chosen) result.chosen = i;
    if (distance_from(result.tried[i]) < distance_from(result.tried[result.nearest]))
      result.nearest = i;
  }
  return result;
}

Tried try_setting(const scenes::Scene& scene, const TuneRequest& request,
                  const accuracy::Setting& setting) {
  Chooser chooser(scene, request);
  chooser.find_finest();
  return chooser.try_one(setting);
}

}  // namespace cycloid::tuning
