#include "bench/accuracy/chart_csv.hpp"

#include <algorithm>
#include <cinttypes>
#include <cstdio>

namespace cycloid::accuracy {

static std::string format(const char* pattern, double value) {
  char text[64];
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

std::string short_number(double value) {
  const double size = value < 0.0 ? -value : value;
  return format(size >= 100.0 && size < 1e7 ? "%.0f" : "%.3g", value);
}

static std::string number(std::optional<double> value) {
  return value ? format("%.9g", *value) : "";
}

static std::string whole(std::uint64_t value) {
  return std::to_string(value);
}

static std::string hexadecimal(std::uint64_t value) {
  char text[32];
  std::snprintf(text, sizeof text, "%016" PRIx64, value);
  return text;
}

/// A field with commas or quotes in it.
static std::string field(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + '"';
}

/// A row as it grows: names and fields are added together, so that they cannot part.
struct CsvRow {
  std::string names;
  std::string fields;
  void add(const std::string& name, const std::string& text) {
    names += (names.empty() ? "" : ",") + name;
    fields += (fields.empty() && names == name ? "" : ",") + text;
  }
};

static void add_spread(const std::string& name, const std::optional<Spread>& spread, CsvRow& row) {
  row.add(name + "_max_m", spread ? number(spread->max) : "");
  row.add(name + "_rms_m", spread ? number(spread->rms) : "");
  row.add(name + "_p95_m", spread ? number(spread->p95) : "");
}

static void add_setting(const SceneChart& chart, const ChartPoint& point, CsvRow& row) {
  const Setting& setting = point.measured.setting;
  row.add("scene", field(chart.name));
  row.add("ticks", whole(chart.subject.ticks));
  const bool plain = setting.method.find(',') == std::string::npos;
  row.add("method", plain ? setting.method : field(setting.method));
  row.add("substeps", whole(setting.substeps));
  row.add("sweeps", whole(setting.sweeps));
  row.add("relax_sweeps", whole(setting.relax_sweeps));
  row.add("ended", point.measured.ended ? "1" : "0");
  row.add("verdict", point.outcome ? trials::verdict_name(point.outcome->verdict) : "");
  row.add("failed", point.failed ? "1" : "0");
}

static void add_metrics(const Metrics& metrics, CsvRow& row) {
  row.add("natural_map", number(metrics.natural_map));
  row.add("complementarity_j", number(metrics.complementarity_j));
  row.add("impulse_error", number(metrics.impulse_error));
  row.add("wrench_error", number(metrics.wrench_error));
  row.add("velocity_error", number(metrics.velocity_error));
  add_spread("penetration_transient", metrics.penetration_transient_m, row);
  add_spread("penetration_steady", metrics.penetration_steady_m, row);
  add_spread("gap_transient", metrics.gap_transient_m, row);
  add_spread("gap_steady", metrics.gap_steady_m, row);
  row.add("energy_gained_j", number(metrics.energy_gained_j));
  row.add("energy_gained_share", number(metrics.energy_gained_share));
  row.add("momentum_drift", number(metrics.momentum_drift));
  row.add("angular_momentum_drift", number(metrics.angular_momentum_drift));
  row.add("cone_excess", number(metrics.cone_excess));
  row.add("stick_drift_mm_min", number(metrics.stick_drift_mm_min));
  row.add("jitter_m_s", number(metrics.jitter_m_s));
  row.add("moved_m", number(metrics.moved_m));
  row.add("consistency_m", number(metrics.consistency_m));
}

static bool holds(const std::vector<std::size_t>& front, std::size_t index) {
  return std::find(front.begin(), front.end(), index) != front.end();
}

/// A chart's fronts of one error, over rows and over time.
struct Fronts {
  std::vector<std::size_t> rows;
  std::vector<std::size_t> time;
};

static CsvRow row_of(const SceneChart& chart, std::size_t index, const Fronts& fronts,
                     const ChartOrigin& origin) {
  const ChartPoint& point = chart.points[index];
  const Price& price = point.measured.price;
  CsvRow row;
  add_setting(chart, point, row);
  add_metrics(point.measured.metrics, row);
  row.add("rows_per_tick", price.rows_per_tick > 0.0 ? number(price.rows_per_tick) : "");
  row.add("state_bytes", price.state_bytes > 0 ? whole(price.state_bytes) : "");
  row.add("digest", point.measured.digest != 0 ? hexadecimal(point.measured.digest) : "");
  row.add("on_rows_front", holds(fronts.rows, index) ? "1" : "0");
  row.add("ns_per_tick", point.times.empty() ? "" : number(price.ns_per_tick));
  row.add("on_time_front", !point.times.empty() && holds(fronts.time, index) ? "1" : "0");
  row.add("machine", field(origin.machine));
  row.add("compiler", field(origin.compiler));
  row.add("commit", field(origin.commit));
  row.add("date", origin.date);
  return row;
}

std::string chart_csv(const ChartPlan& plan, const ErrorKind& error, const ChartOrigin& origin) {
  std::string text;
  for (const SceneChart& chart : plan.scenes) {
    const Fronts fronts{pareto_front(chart, error, CostAxis::kRows),
                        pareto_front(chart, error, CostAxis::kTime)};
    for (std::size_t i = 0; i < chart.points.size(); ++i) {
      const CsvRow row = row_of(chart, i, fronts, origin);
      if (text.empty()) text = row.names + '\n';
      text += row.fields + '\n';
    }
  }
  return text;
}

/// A name as a cell, which neither a bar nor a new line may end.
static std::string markdown_cell(const std::string& name) {
  std::string cell;
  for (const char c : name) {
    if (c == '|') cell += '\\';
    cell += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return cell;
}

static std::string front_line(const SceneChart& chart, std::size_t index, const ErrorKind& error) {
  const ChartPoint& point = chart.points[index];
  std::string line =
      "| " + markdown_cell(chart.name) + " | " + name_of(point.measured.setting) + " | " +
      (point.measured.price.rows_per_tick > 0.0 ? short_number(point.measured.price.rows_per_tick)
                                                : "") +
      " | ";
  if (!point.times.empty()) line += short_number(1e-3 * point.measured.price.ns_per_tick);
  return line + " | " + short_number(error.of(point.measured).value_or(0.0)) + " |\n";
}

std::string chart_markdown(const ChartPlan& plan, const ErrorKind& error,
                           const ChartOrigin& origin) {
  std::string text = origin.machine + ", compiler " + origin.compiler + ", commit " +
                     origin.commit + ", " + origin.date + ".\n\n| scene | setting | rows | us | " +
                     error.label + " |\n|---|---|---:|---:|---:|\n";
  for (const SceneChart& chart : plan.scenes)
    for (const std::size_t index : pareto_front(chart, error, table_axis(chart)))
      text += front_line(chart, index, error);
  return text;
}

}  // namespace cycloid::accuracy
