#include "bench/figures/gnuplot.hpp"

#include <stdio.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iomanip>
#include <sstream>

namespace cycloid::figures {

static bool is_control(char c) {
  return static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
}

// Between single quotes gnuplot reads everything as it stands, but for the quote itself and the end
// of the line: what follows that is a command.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text)
    result += c == '\'' ? std::string("''") : std::string(1, is_control(c) ? ' ' : c);
  return result + "'";
}

std::string gnuplot_script(const experiments::Figure& figure, const std::string& svg_file) {
  std::ostringstream script;
  script << std::setprecision(9);
  // noenhanced: '_' and '^' of names and formulas are letters.
  script << "set terminal svg size 720,440 noenhanced font 'sans,13' background '#ffffff'\n"
         << "set output " << quoted(svg_file) << '\n'
         << "set title " << quoted(figure.title) << '\n'
         << "set xlabel " << quoted(figure.x_label) << '\n'
         << "set ylabel " << quoted(figure.y_label) << '\n'
         << "set grid back lc rgb '#dddddd'\nset key outside right\n";
  if (figure.log_x) script << "set logscale x\n";
  if (figure.log_y) script << "set logscale y\n";
  for (std::size_t i = 0; i < figure.curves.size(); ++i) {
    script << "$curve" << i << " << END\n";
    for (const auto& [x, y] : figure.curves[i].points) script << x << ' ' << y << '\n';
    script << "END\n";
  }
  script << "plot";
  for (std::size_t i = 0; i < figure.curves.size(); ++i)
    script << (i == 0 ? " " : ", ") << "$curve" << i << " with linespoints pointsize 0.4 title "
           << quoted(figure.curves[i].name);
  script << '\n';
  return script.str();
}

bool has_gnuplot() {
  return std::system("gnuplot --version > /dev/null 2>&1") == 0;
}

std::string run_gnuplot(const std::string& script, const std::string& file) {
  if (std::any_of(file.begin(), file.end(), is_control))
    return file + ": has control characters in its name, which gnuplot cannot be told";
  FILE* gnuplot = popen("gnuplot -", "w");
  if (gnuplot == nullptr) return "gnuplot cannot be started";
  const bool written = fwrite(script.data(), 1, script.size(), gnuplot) == script.size();
  const int status = pclose(gnuplot);
  if (written && status == 0) return "";
  std::error_code error;
  std::filesystem::remove(file, error);
  return file + ": gnuplot did not draw it; is the package gnuplot-nox installed?";
}

std::string draw(const experiments::Figure& figure, const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return folder + ": cannot be made: " + error.message();
  const std::string file = (std::filesystem::path(folder) / (figure.name + ".svg")).string();
  const std::string drawing = file + ".drawing";
  if (const std::string why = run_gnuplot(gnuplot_script(figure, drawing), drawing); !why.empty())
    return why;
  std::filesystem::rename(drawing, file, error);
  return error ? file + ": cannot be written: " + error.message() : "";
}

}  // namespace cycloid::figures
