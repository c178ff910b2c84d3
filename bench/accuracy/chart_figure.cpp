#include "bench/accuracy/chart_figure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <sstream>

#include "bench/figures/gnuplot.hpp"
#include "bench/trials/methods.hpp"

namespace cycloid::accuracy {

/// Where errors of 0 are drawn.
static constexpr double kLeast = 1e-7;

static constexpr std::array kColors = {"#1f77b4", "#17becf", "#2ca02c", "#d62728", "#ff7f0e",
                                       "#9467bd", "#8c564b", "#e377c2", "#7f7f7f", "#bcbd22"};

/// Of other engines, in the order in which they come.
static constexpr std::array kContenderColors = {"#000000", "#b8860b", "#00838f", "#ad1457"};

/// How the marks of a method look: squares for those of other engines.
struct MarkStyle {
  const char* color;
  const char* held;
};

/// One for each of the methods.
static std::vector<MarkStyle> styles_of(const std::vector<std::string>& methods) {
  std::vector<MarkStyle> styles;
  std::size_t contenders = 0;
  for (const std::string& method : methods) {
    std::size_t place = 0;
    for (const trials::Method& each : trials::methods()) {
      if (method == each.name) break;
      ++place;
    }
    if (place < trials::methods().size())
      styles.push_back({kColors[place % kColors.size()], "pt 7"});
    else
      styles.push_back({kContenderColors[contenders++ % kContenderColors.size()], "pt 5"});
  }
  return styles;
}

static std::vector<std::string> methods_of(const SceneChart& chart) {
  std::vector<std::string> methods;
  for (const ChartPoint& point : chart.points)
    if (std::find(methods.begin(), methods.end(), point.measured.setting.method) == methods.end())
      methods.push_back(point.measured.setting.method);
  return methods;
}

static bool is_timed(const SceneChart& chart) {
  return !chart.points.empty() && !chart.points.front().times.empty();
}

/// Whether anybody counts the rows of these points: of a method's, or of all where it is "".
static bool is_counted(const SceneChart& chart, const std::string& method = "") {
  for (const ChartPoint& point : chart.points)
    if (cost_of(point, CostAxis::kRows) > 0.0 &&
        (method.empty() || method == point.measured.setting.method))
      return true;
  return false;
}

/// What the chart has panels for.
static std::vector<CostAxis> axes_of(const SceneChart& chart) {
  if (!is_timed(chart)) return {CostAxis::kRows};
  if (!is_counted(chart)) return {CostAxis::kTime};
  return {CostAxis::kRows, CostAxis::kTime};
}

/// What the pointer is told. gnuplot reads "\n" within double quotes as the end of a line.
static std::string label_of(const ChartPoint& point, double value) {
  const Measured& measured = point.measured;
  std::string text = name_of(measured.setting) + "\\nerror " + short_number(value);
  if (measured.price.rows_per_tick > 0.0)
    text += "\\n" + short_number(measured.price.rows_per_tick) + " rows a tick";
  if (!point.times.empty())
    text += "\\n" + short_number(1e-3 * measured.price.ns_per_tick) + " us a tick";
  const Metrics& metrics = measured.metrics;
  if (metrics.penetration_steady_m)
    text += "\\noverlap " + short_number(metrics.penetration_steady_m->max) + " m";
  if (metrics.gap_steady_m) text += ", gap " + short_number(metrics.gap_steady_m->max) + " m";
  if (metrics.energy_gained_j)
    text += "\\nenergy gained " + short_number(*metrics.energy_gained_j) + " J";
  if (point.outcome) text += "\\n" + trials::outcome_text(*point.outcome);
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

  /// Those of one method. @returns how many, as `write_front` does.
  int write(const std::string& block, const std::string& method, bool failed,
            std::ostream& script) {
    int count = 0;
    script << block << " << END\n";
    for (const ChartPoint& point : chart_.points)
      if (point.measured.setting.method == method && point.failed == failed)
        count += write_point(point, script);
    script << "END\n";
    return count;
  }
  int write_front(const std::string& block, CostAxis axis, std::ostream& script) {
    int count = 0;
    script << block << " << END\n";
    for (const std::size_t index : pareto_front(chart_, error_, axis))
      count += write_point(chart_.points[index], script);
    script << "END\n";
    return count;
  }
  /// What is drawn along the axis of rows, of us or of the error, each value once.
  const std::set<std::string>& costs(CostAxis axis) const {
    return axis == CostAxis::kRows ? rows_ : times_;
  }
  const std::set<std::string>& errors() const { return errors_; }

 private:
  int write_point(const ChartPoint& point, std::ostream& script) {
    const std::optional<double> value = error_.of(point.measured);
    if (!value || std::isnan(*value)) return 0;
    double drawn = std::max(*value, kLeast);
    if (point.failed) drawn = std::min(drawn, 10.0 * std::max(highest_, kLeast));
    const double rows = point.measured.price.rows_per_tick;
    const double us = 1e-3 * point.measured.price.ns_per_tick;
    if (rows > 0.0) rows_.insert(short_number(rows));
    if (us > 0.0) times_.insert(short_number(us));
    errors_.insert(short_number(drawn));
    script << (rows > 0.0 ? short_number(rows) : "NaN") << ' ' << short_number(us) << ' '
           << short_number(drawn);
    if (kind_ == FigureKind::kHover) script << " \"" << label_of(point, *value) << '"';
    script << '\n';
    return 1;
  }

  const SceneChart& chart_;
  const ErrorKind& error_;
  FigureKind kind_;
  double highest_ = 0.0;
  std::set<std::string> rows_;
  std::set<std::string> times_;
  std::set<std::string> errors_;
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
  /// Where there is nothing to draw, a panel that gnuplot takes all the same.
  std::string text() const { return text_.empty() ? "plot [1:10] [1:10] NaN notitle" : text_; }

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
  const std::size_t panels = axes_of(chart).size();
  script << "set terminal svg size " << (panels == 2 ? 1000 : 640) << ",420 noenhanced "
         << (kind == FigureKind::kHover ? "mouse standalone " : "")
         << "font 'sans,12' background '#ffffff'\nset output " << figures::quoted(svg_file)
         << "\nset multiplot layout 1," << panels << " title " << figures::quoted(chart.name)
         << "\nset logscale xy\nset format y '%g'\nset grid back lc rgb '#dddddd'\nset ylabel "
         << figures::quoted(error.label) << '\n';
}

/// Writes the marks of every method and adds them to the panels.
/// @returns what the key says of them.
static std::string add_marks(const SceneChart& chart, ChartData& data, Plot (&panels)[2],
                             std::ostream& script) {
  const std::vector<std::string> methods = methods_of(chart);
  const std::vector<MarkStyle> styles = styles_of(methods);
  std::string keys;
  for (std::size_t i = 0; i < methods.size(); ++i) {
    const std::string color = std::string(" lc rgb '") + styles[i].color + "'";
    for (const bool failed : {true, false}) {
      const std::string block = (failed ? "$failed" : "$held") + std::to_string(i);
      if (data.write(block, methods[i], failed, script) == 0) continue;
      const std::string style = (failed ? "pt 2" : styles[i].held) + (" ps 0.4" + color);
      if (is_counted(chart, methods[i])) panels[0].points(block, "1", style);
      panels[1].points(block, "2", style);
    }
    keys += ", NaN with points " + (styles[i].held + (" ps 0.6" + color)) + " title " +
            figures::quoted(methods[i]);
  }
  return keys;
}

static void add_fronts(ChartData& data, Plot (&panels)[2], std::ostream& script) {
  const CostAxis axes[2] = {CostAxis::kRows, CostAxis::kTime};
  for (int i = 0; i < 2; ++i) {
    const std::string block = "$front" + std::to_string(i);
    if (data.write_front(block, axes[i], script) == 0) continue;
    panels[i].add(block + " using " + std::to_string(i + 1) +
                  ":3 with linespoints lc rgb '#000000' pt 6 ps 0.8 title 'Pareto front'");
  }
}

/// @returns whether there are lines.
static bool add_closed_form(const SceneChart& chart, const ErrorKind& error, Plot& panel,
                            std::ostream& script) {
  if (std::string_view(error.name) != "worst") return false;
  const auto form = closed_form(chart.subject);
  if (!form) return false;
  write_line("$sweeps", form->by_sweeps, script);
  write_line("$substeps", form->by_substeps, script);
  panel.add("$sweeps with lines lc rgb '#888888' dt 2 title 'closed form, sweeps'");
  panel.add("$substeps with lines lc rgb '#888888' dt 4 title 'closed form, substeps'");
  return true;
}

/// Of one value alone gnuplot makes no axis without a warning: it gets room to both sides.
static std::string range_of(const char* axis, const std::set<std::string>& values) {
  if (values.size() != 1) return std::string("set autoscale ") + axis + '\n';
  const std::string& value = *values.begin();
  return std::string("set ") + axis + "range [0.5*" + value + ":2*" + value + "]\n";
}

std::string chart_script(const SceneChart& chart, const ErrorKind& error, FigureKind kind,
                         const std::string& svg_file) {
  std::ostringstream script;
  write_head(chart, error, kind, svg_file, script);
  ChartData data(chart, error, kind);
  Plot panels[2] = {Plot(kind), Plot(kind)};
  const std::string keys = add_marks(chart, data, panels, script);
  add_fronts(data, panels, script);
  const bool lines = add_closed_form(chart, error, panels[0], script);
  const std::vector<CostAxis> axes = axes_of(chart);
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const bool last = i + 1 == axes.size();
    const bool rows = axes[i] == CostAxis::kRows;
    script << (last            ? "set key on outside right\n"
               : rows && lines ? "set key top right\n"
                               : "set key off\n")
           << "set xlabel '" << (rows ? "rows a tick" : "us a tick") << "'\n"
           << (rows && lines ? "set autoscale xy\n"
                             : range_of("x", data.costs(axes[i])) + range_of("y", data.errors()))
           << panels[rows ? 0 : 1].text() << (last ? keys : "") << "\nunset ylabel\n";
  }
  script << "unset multiplot\n";
  return script.str();
}

}  // namespace cycloid::accuracy
