#pragma once

#include <functional>
#include <string>

#include "bench/accuracy/chart_csv.hpp"

namespace cycloid::accuracy {

/// Writes a text to a file, or throws.
using TextWriter = std::function<void(const std::string& file, const std::string& text)>;
void write_chart_text(const std::string& file, const std::string& text);

/// Where the numbers go.
std::string chart_csv_file(const std::string& folder);

/// Writes the plan's scenes to a folder that is there and draws them: chart.csv, chart.html,
/// fronts.md and SCENE-ERROR.svg for each scene and error; letters, digits, '-' and '_' of a
/// scene's name are kept, as far as there is room. Fronts of the CSV and of fronts.md are those of
/// the first error. Throws std::runtime_error that names the file where one cannot be written, or
/// gnuplot is missing; the numbers, chart.csv and fronts.md, are written before anything is drawn.
/// @returns the names of the files.
std::vector<std::string> write_chart_files(const ChartPlan& plan,
                                           const std::vector<const ErrorKind*>& errors,
                                           const std::string& folder, const ChartOrigin& origin,
                                           const TextWriter& write = write_chart_text);

}  // namespace cycloid::accuracy
