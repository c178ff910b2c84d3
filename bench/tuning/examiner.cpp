#include "bench/tuning/examiner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scenes/catalogue.hpp"

namespace cycloid::tuning {

static constexpr int kTimingRounds = 3;

Examiner::Examiner(const scenes::Scene& scene, const accuracy::Setting& setting,
                   const NeedsRequest& request)
    : scene_(scene), setting_(setting), request_(request), base_(run(scene)) {
  options_.direct_rows_max = 0;  // The reference's errors are not asked for.
  options_.sleep = true;         // As the scene says.
  figures_ = figures_of(scene, base_);
}

RunFigures Examiner::figures_of(const scenes::Scene& scene, const Passage& passage) const {
  RunFigures figures;
  figures.rows_per_tick = passage.rows_per_tick;
  figures.turning_rows_per_sweep = passage.contact_rows_per_tick;
  figures.state_bytes = passage.state_bytes;
  const accuracy::Subject subject{scene, request_.ticks, nullptr};
  figures.error_m = accuracy::position_error_m(accuracy::measure(subject, setting_, options_));
  return figures;
}

/// Processor times of both, taken in turn so that noise hits both.
void Examiner::time_both(const scenes::Scene& without, PartNeed& need) const {
  const accuracy::Subject subjects[] = {{scene_, request_.ticks, nullptr},
                                        {without, request_.ticks, nullptr}};
  double least_ns[] = {std::numeric_limits<double>::infinity(),
                       std::numeric_limits<double>::infinity()};
  for (int round = 0; round < kTimingRounds; ++round)
    for (int i = 0; i < 2; ++i)
      least_ns[i] = std::min(least_ns[i], accuracy::time_ticks(subjects[i], setting_, options_));
  need.with.us_per_tick = 1.0e-3 * least_ns[0];
  need.without.us_per_tick = 1.0e-3 * least_ns[1];
}

/// How far the bodies go without; infinite where the scene is none then, or does not run.
double Examiner::moved_without(const scenes::Scene& without) const {
  if (!scenes::check(without).empty()) return std::numeric_limits<double>::infinity();
  const Passage passage = run(without);
  return passage.ended ? distance_max_m(base_, passage) : std::numeric_limits<double>::infinity();
}

/// Fills in all that running without tells, the verdict too.
void Examiner::compare(const Drop& drop, PartNeed& need) {
  scenes::Scene without = scene_;
  drop(without);
  need.moved_m = moved_without(without);
  need.verdict = is_needed(need.moved_m) ? PartVerdict::kNeeded : PartVerdict::kNotNeeded;
  if (std::isinf(need.moved_m)) return;
  need.measured = true;
  need.with = figures_;
  need.without = figures_of(without, run(without));
  time_both(without, need);
  if (need.verdict == PartVerdict::kNotNeeded) drops_.push_back(drop);
}

}  // namespace cycloid::tuning
