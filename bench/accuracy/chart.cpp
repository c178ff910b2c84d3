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
  double sweeps = setting.sweeps + setting.relax_sweeps;
  if (is_method(setting.method))
    sweeps += with_setting(chart.subject.scene, setting).tuning.position_sweeps;
  const double bodies =
      static_cast<double>(chart.subject.scene.bodies.size() + chart.subject.scene.joints.size());
  return chart.subject.ticks * bodies * (4.0 + setting.substeps * (1.0 + sweeps));
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
  if (chart.trial) {
    const scenes::Scene scene = with_setting(chart.subject.scene, setting);
    point.outcome = trials::judge(*chart.trial, scene.tuning);
  }
  return point;
}

static bool has_failed(const SceneChart& chart, const ChartPoint& point) {
  const double moved_m = point.measured.metrics.moved_m.value_or(0.0);
  const bool fell = point.outcome && point.outcome->verdict == trials::Verdict::kFails;
  return !point.measured.ended || fell || (chart.moved_max_m > 0.0 && moved_m > chart.moved_max_m);
}

/// Energy from nowhere is no way to be accurate. What all settings gain lies in the scene: overlap
/// that it starts with lifts bodies as it is resolved.
static void fail_those_that_gain_energy(SceneChart& chart) {
  const auto gained = [](const ChartPoint& point) {
    return point.measured.metrics.energy_gained_share.value_or(0.0);
  };
  double least = std::numeric_limits<double>::infinity();
  for (const ChartPoint& point : chart.points)
    if (point.measured.ended) least = std::min(least, gained(point));
  for (ChartPoint& point : chart.points)
    if (gained(point) > least + kGainAllowed) point.failed = true;
}

/// Of every run that is to come, what measuring it and timing it weighs.
static double weight_of(const ChartPlan& plan) {
  double all = 0.0;
  for (const SceneChart& chart : plan.scenes) {
    for (const Setting& setting : plan.settings) all += weight_of(chart, setting);
    for (const Contender& contender : plan.contenders) all += weight_of(chart, contender.setting);
  }
  return all * (kMeasureWeight + plan.repeats);
}

static double time_point(const ChartPlan& plan, const SceneChart& chart, const ChartPoint& point,
                         std::uint32_t round) {
  if (point.contender < 0) return time_ticks(chart.subject, point.measured.setting, plan.measure);
  return plan.contenders[static_cast<std::size_t>(point.contender)].time_ticks(chart, round);
}

void run_chart(ChartPlan& plan, const std::function<void(const ChartProgress&)>& tell) {
  const double all = weight_of(plan);
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
    for (std::size_t i = 0; i < plan.contenders.size(); ++i) {
      begin(chart, plan.contenders[i].setting, kMeasureWeight);
      auto point = plan.contenders[i].measure(chart, plan.measure);
      if (!point) continue;
      point->contender = static_cast<int>(i);
      chart.points.push_back(std::move(*point));
    }
    for (ChartPoint& point : chart.points) point.failed = has_failed(chart, point);
    fail_those_that_gain_energy(chart);
  }
  for (std::uint32_t round = 0; round < plan.repeats; ++round)
    for (SceneChart& chart : plan.scenes)
      for (ChartPoint& point : chart.points) {
        begin(chart, point.measured.setting, 1.0);
        point.times.push_back(time_point(plan, chart, point, round));
      }
  for (SceneChart& chart : plan.scenes)
    for (ChartPoint& point : chart.points)
      point.measured.price.ns_per_tick = median_of(point.times);
}

double cost_of(const ChartPoint& point, CostAxis axis) {
  const Price& price = point.measured.price;
  return axis == CostAxis::kRows ? price.rows_per_tick : price.ns_per_tick;
}

CostAxis table_axis(const SceneChart& chart) {
  for (const ChartPoint& point : chart.points)
    if (point.contender >= 0) return CostAxis::kTime;
  return CostAxis::kRows;
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
    const double cost = cost_of(point, axis);
    if (point.failed || !value || !std::isfinite(*value) || cost <= 0.0) continue;
    candidates.push_back({cost, *value, i});
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
