#include "bench/accuracy/chart_figure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "bench/figures/gnuplot.hpp"
#include "bench/trials/methods.hpp"

namespace cycloid::accuracy {

/// Where errors of 0 are drawn.
static constexpr double kLeast = 1e-7;

static constexpr std::array kColors = {"#1f77b4", "#17becf", "#2ca02c", "#d62728", "#ff7f0e",
                                       "#9467bd", "#8c564b", "#e377c2", "#7f7f7f", "#bcbd22"};

static const char* color_of(const std::string& method) {
  std::size_t place = 0;
  for (const trials::Method& each : trials::methods()) {
    if (method == each.name) break;
    ++place;
  }
  return kColors[place % kColors.size()];
}

static bool is_timed(const SceneChart& chart) {
  return !chart.points.empty() && !chart.points.front().times.empty();
}

/// What the pointer is told. gnuplot reads "\n" within double quotes as the end of a line.
static std::string label_of(const ChartPoint& point, double value) {
  const Measured& measured = point.measured;
  std::string text = name_of(measured.setting) + "\\nerror " + short_number(value) + "\\n" +
                     short_number(measured.price.rows_per_tick) + " rows a tick";
  if (!point.times.empty())
    text += "\\n" + short_number(1e-3 * measured.price.ns_per_tick) + " us a tick";
  text += "\\noverlap " + short_number(measured.metrics.penetration_steady_m.max) + " m";
  if (measured.metrics.gap_steady_m)
    text += ", gap " + short_number(measured.metrics.gap_steady_m->max) + " m";
  text += "\\nenergy gained " + short_number(measured.metrics.energy_gained_j) + " J";
  if (point.verdict) text += std::string("\\n") + trials::verdict_name(*point.verdict);
  if (!measured.ended) text += "\\ndid not end";
  return text;
}

/// The points of a chart as gnuplot's blocks of data: rows, us, error and, to hover, a label.
class ChartData {
 public:
  ChartData(const SceneChart& chart, const ErrorKind& error, FigureKind kind)
      : chart_(chart), error_(error), kind_(kind) {
    for (const ChartPoint& point : chart.points)
      if (const auto value = error.of(point.measured);
          value && !point.failed && std::isfinite(*value))
        highest_ = std::max(highest_, *value);
  }

  /// Those of one method. @returns how many.
  int write(const std::string& block, const std::string& method, bool failed,
            std::ostream& script) const {
    int count = 0;
    script << block << " << END\n";
    for (const ChartPoint& point : chart_.points)
      if (point.measured.setting.method == method && point.failed == failed)
        count += write_point(point, script);
    script << "END\n";
    return count;
  }
  void write_front(const std::string& block, CostAxis axis, std::ostream& script) const {
    script << block << " << END\n";
    for (const std::size_t index : pareto_front(chart_, error_, axis))
      write_point(chart_.points[index], script);
    script << "END\n";
  }

 private:
  int write_point(const ChartPoint& point, std::ostream& script) const {
    const std::optional<double> value = error_.of(point.measured);
    if (!value || std::isnan(*value)) return 0;
    double drawn = std::max(*value, kLeast);
    if (point.failed) drawn = std::min(drawn, 10.0 * std::max(highest_, kLeast));
    script << short_number(point.measured.price.rows_per_tick) << ' '
           << short_number(1e-3 * point.measured.price.ns_per_tick) << ' ' << short_number(drawn);
    if (kind_ == FigureKind::kHover) script << " \"" << label_of(point, *value) << '"';
    script << '\n';
    return 1;
  }

  const SceneChart& chart_;
  const ErrorKind& error_;
  FigureKind kind_;
  double highest_ = 0.0;
};

/// What a panel draws, one after the other.
class Plot {
 public:
  explicit Plot(FigureKind kind) : kind_(kind) {}
  void points(const std::string& block, const char* column, const std::string& style) {
    const std::string with =
        kind_ == FigureKind::kHover ? ":3:4 with labels hypertext point " : ":3 with points ";
    add(block + " using " + column + with + style + " notitle");
  }
  void add(const std::string& what) { text_ += (text_.empty() ? "plot " : ", ") + what; }
  const std::string& text() const { return text_; }

 private:
  FigureKind kind_;
  std::string text_;
};

static void write_line(const std::string& block, const Line& line, std::ostream& script) {
  script << block << " << END\n";
  for (const auto& [rows, error] : line)
    script << short_number(rows) << ' ' << short_number(error) << '\n';
  script << "END\n";
}

static void write_head(const SceneChart& chart, const ErrorKind& error, FigureKind kind,
                       const std::string& svg_file, std::ostream& script) {
  script << "set terminal svg size " << (is_timed(chart) ? 1000 : 640) << ",420 noenhanced "
         << (kind == FigureKind::kHover ? "mouse standalone " : "")
         << "font 'sans,12' background '#ffffff'\nset output " << figures::quoted(svg_file)
         << "\nset multiplot layout 1," << (is_timed(chart) ? 2 : 1) << " title "
         << figures::quoted(chart.name)
         << "\nset logscale xy\nset format y '%g'\nset grid back lc rgb '#dddddd'\nset ylabel "
         << figures::quoted(error.label) << '\n';
}

std::string chart_script(const SceneChart& chart, const ErrorKind& error, FigureKind kind,
                         const std::string& svg_file) {
  std::ostringstream script;
  write_head(chart, error, kind, svg_file, script);
  const ChartData data(chart, error, kind);
  Plot panels[2] = {Plot(kind), Plot(kind)};
  std::vector<std::string> methods;
  for (const ChartPoint& point : chart.points)
    if (std::find(methods.begin(), methods.end(), point.measured.setting.method) == methods.end())
      methods.push_back(point.measured.setting.method);
  std::string keys;
  for (std::size_t i = 0; i < methods.size(); ++i) {
    const std::string color = std::string(" lc rgb '") + color_of(methods[i]) + "'";
    for (const bool failed : {true, false}) {
      const std::string block = (failed ? "$failed" : "$held") + std::to_string(i);
      if (data.write(block, methods[i], failed, script) == 0) continue;
      const std::string style = (failed ? "pt 2 ps 0.4" : "pt 7 ps 0.4") + color;
      panels[0].points(block, "1", style);
      panels[1].points(block, "2", style);
    }
    keys += ", NaN with points pt 7 ps 0.6" + color + " title " + figures::quoted(methods[i]);
  }
  const CostAxis axes[2] = {CostAxis::kRows, CostAxis::kTime};
  for (int i = 0; i < 2; ++i) {
    const std::string block = "$front" + std::to_string(i);
    data.write_front(block, axes[i], script);
    panels[i].add(block + " using " + std::to_string(i + 1) +
                  ":3 with linespoints lc rgb '#000000' pt 6 ps 0.8 title 'Pareto front'");
  }
  const auto form = std::string_view(error.name) == "worst" ? closed_form(chart.subject)
                                                            : std::optional<ClosedForm>();
  if (form) {
    write_line("$sweeps", form->by_sweeps, script);
    write_line("$substeps", form->by_substeps, script);
    panels[0].add("$sweeps with lines lc rgb '#888888' dt 2 title 'closed form, sweeps'");
    panels[0].add("$substeps with lines lc rgb '#888888' dt 4 title 'closed form, substeps'");
  }
  const bool timed = is_timed(chart);
  script << (timed && !form ? "set key off\n"
             : timed        ? "set key top right\n"
                            : "set key outside\n")
         << "set xlabel 'rows a tick'\n"
         << panels[0].text() << (timed ? "" : keys) << '\n';
  if (timed)
    script << "set key on outside right\nset xlabel 'us a tick'\nunset ylabel\n"
           << panels[1].text() << keys << '\n';
  script << "unset multiplot\n";
  return script.str();
}

}  // namespace cycloid::accuracy
