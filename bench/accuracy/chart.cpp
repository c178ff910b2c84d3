#include "bench/accuracy/chart.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cycloid::accuracy {

/// Metrics::energy_gained_share beyond which a setting has failed.
static constexpr double kGainAllowed = 0.05;

/// Of measuring a run beside running it.
static constexpr double kMeasureWeight = 4.0;

/// About how much work a run is, beside other settings of the same scene.
static double weight_of(const SceneChart& chart, const Setting& setting) {
  const solver::Tuning tuning = with_setting(chart.subject.scene, setting).tuning;
  const double sweeps = tuning.sweeps + tuning.relax_sweeps + tuning.position_sweeps;
  const double bodies =
      static_cast<double>(chart.subject.scene.bodies.size() + chart.subject.scene.joints.size());
  return chart.subject.ticks * bodies * (4.0 + tuning.substeps * (1.0 + sweeps));
}

static double median_of(std::vector<double> values) {
  if (values.empty()) return 0.0;
  // Total order: times are finite numbers.
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

static ChartPoint measure_point(const SceneChart& chart, const Setting& setting,
                                const MeasureOptions& options) {
  ChartPoint point;
  point.measured = measure(chart.subject, setting, options);
  point.failed = !point.measured.ended;
  if (chart.moved_max_m > 0.0 && point.measured.metrics.moved_m > chart.moved_max_m)
    point.failed = true;
  if (!chart.trial) return point;
  const scenes::Scene scene = with_setting(chart.subject.scene, setting);
  point.verdict = trials::judge(*chart.trial, scene.tuning).verdict;
  if (point.verdict == trials::Verdict::kFails) point.failed = true;
  return point;
}

/// Energy from nowhere is no way to be accurate. What all settings gain lies in the scene: overlap
/// that it starts with lifts bodies as it is resolved.
static void fail_those_that_gain_energy(SceneChart& chart) {
  double least = std::numeric_limits<double>::infinity();
  for (const ChartPoint& point : chart.points)
    if (point.measured.ended)
      least = std::min(least, point.measured.metrics.energy_gained_share.value_or(0.0));
  for (ChartPoint& point : chart.points)
    if (point.measured.metrics.energy_gained_share.value_or(0.0) > least + kGainAllowed)
      point.failed = true;
}

void run_chart(ChartPlan& plan, const std::function<void(const ChartProgress&)>& tell) {
  double all = 0.0;
  for (const SceneChart& chart : plan.scenes)
    for (const Setting& setting : plan.settings)
      all += weight_of(chart, setting) * (kMeasureWeight + plan.repeats);
  double done = 0.0;
  const auto begin = [&](const SceneChart& chart, const Setting& setting, double weight) {
    tell({done / all, chart.name + ' ' + name_of(setting)});
    done += weight * weight_of(chart, setting);
  };
  for (SceneChart& chart : plan.scenes) {
    for (const Setting& setting : plan.settings) {
      begin(chart, setting, kMeasureWeight);
      chart.points.push_back(measure_point(chart, setting, plan.measure));
    }
    fail_those_that_gain_energy(chart);
  }
  for (std::uint32_t round = 0; round < plan.repeats; ++round)
    for (SceneChart& chart : plan.scenes)
      for (ChartPoint& point : chart.points) {
        begin(chart, point.measured.setting, 1.0);
        point.times.push_back(time_ticks(chart.subject, point.measured.setting, plan.measure));
      }
  for (SceneChart& chart : plan.scenes)
    for (ChartPoint& point : chart.points)
      point.measured.price.ns_per_tick = median_of(point.times);
}

double cost_of(const ChartPoint& point, CostAxis axis) {
  const Price& price = point.measured.price;
  return axis == CostAxis::kRows ? price.rows_per_tick : price.ns_per_tick;
}

std::vector<std::size_t> pareto_front(const SceneChart& chart, const ErrorKind& error,
                                      CostAxis axis) {
  struct Candidate {
    double cost;
    double error;
    std::size_t index;
  };
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < chart.points.size(); ++i) {
    const ChartPoint& point = chart.points[i];
    const std::optional<double> value = error.of(point.measured);
    if (point.failed || !value || !std::isfinite(*value)) continue;
    candidates.push_back({cost_of(point, axis), *value, i});
  }
  // Total order: cost, error, then the place, which no two share.
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    if (a.cost != b.cost) return a.cost < b.cost;
    return a.error != b.error ? a.error < b.error : a.index < b.index;
  });
  std::vector<std::size_t> front;
  double least = std::numeric_limits<double>::infinity();
  for (const Candidate& candidate : candidates) {
    if (!(candidate.error < least)) continue;
    least = candidate.error;
    front.push_back(candidate.index);
  }
  return front;
}

}  // namespace cycloid::accuracy
