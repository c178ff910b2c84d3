#pragma once

#include <string>

#include "bench/experiments/experiment.hpp"

namespace cycloid::figures {

/// The program that draws a figure into `svg_file`, for gnuplot, with the data in it: equal figures
/// give equal text.
std::string gnuplot_script(const experiments::Figure& figure, const std::string& svg_file);

/// Text between quotes that gnuplot reads as it stands, with spaces for control characters.
std::string quoted(const std::string& text);

/// Whether a gnuplot is installed and runs.
bool has_gnuplot();

/// Runs a program that writes `file`, with the gnuplot that is installed.
/// @returns "" or why it could not; then no half-drawn file is left.
std::string run_gnuplot(const std::string& script, const std::string& file);

/// Draws into FOLDER/NAME.svg with the gnuplot that is installed.
/// @returns "" or why it could not; then no half-drawn file is left.
std::string draw(const experiments::Figure& figure, const std::string& folder);

}  // namespace cycloid::figures
