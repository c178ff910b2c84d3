#pragma once

#include <string>

#include "bench/accuracy/chart_csv.hpp"

namespace cycloid::accuracy {

enum class FigureKind {
  kStill,  ///< For a page of text: points alone.
  kHover,  ///< A program within: what lies under the pointer says what it is.
};

/// The program that draws error against rows and, where the chart is timed, against time into
/// `svg_file`, for gnuplot: log-log; a colour for each method; crosses for settings that failed;
/// the front as a line; the closed form where it applies. Errors of 0 are drawn at 1e-7, those of
/// settings that failed at most ten times above all others.
std::string chart_script(const SceneChart& chart, const ErrorKind& error, FigureKind kind,
                         const std::string& svg_file);

/// One page that needs nothing else: for each scene and error the figure of kHover, and the fronts.
/// @param svgs  what the programs of `chart_script` have drawn, scene after scene and in each one
///              error after error.
std::string chart_page(const ChartPlan& plan, const std::vector<const ErrorKind*>& errors,
                       const std::vector<std::string>& svgs, const ChartOrigin& origin);

}  // namespace cycloid::accuracy
