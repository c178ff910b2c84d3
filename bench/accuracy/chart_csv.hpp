#pragma once

#include <string>

#include "bench/accuracy/chart.hpp"

namespace cycloid::accuracy {

/// What stands beside the numbers.
struct ChartOrigin {
  std::string machine;
  std::string compiler;
  std::string commit;  ///< Of the sources, or "unknown".
  std::string date;
};

/// A line of names, then a line for each setting of each scene. An absent number is an empty field.
/// What depends on the machine comes last: from the column "ns_per_tick" on. All before it is the
/// same every time. The fronts are those of `error`.
std::string chart_csv(const ChartPlan& plan, const ErrorKind& error, const ChartOrigin& origin);

/// Markdown: for each scene the settings on the front of error against cost (`table_axis`), the
/// cheapest first, what they cost and how wrong they are.
std::string chart_markdown(const ChartPlan& plan, const ErrorKind& error,
                           const ChartOrigin& origin);

/// "0.0112", "5120": three digits or all before the point; powers where those are too many.
std::string short_number(double value);

}  // namespace cycloid::accuracy
