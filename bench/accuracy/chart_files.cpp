#include "bench/accuracy/chart_files.hpp"

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "bench/accuracy/chart_figure.hpp"
#include "bench/figures/gnuplot.hpp"

namespace cycloid::accuracy {

/// What a scene is called in names of files: a file's path or a scene's parameters are no name.
static std::string file_stem(const std::string& name) {
  std::string stem;
  for (const char c : name) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    stem += plain || c == '-' || c == '_' ? c : '-';
  }
  return stem;
}

static std::string file_in(const std::string& folder, const std::string& name) {
  return (std::filesystem::path(folder) / name).string();
}

static void write_text(const std::string& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text << std::flush;
  if (!stream) throw std::runtime_error(file + ": cannot be written");
}

static void draw(const std::string& script, const std::string& file) {
  if (const std::string why = figures::run_gnuplot(script, file); !why.empty())
    throw std::runtime_error(why);
}

/// What the pointer moves over, as text; its file is gone again.
static std::string hover_figure(const SceneChart& chart, const ErrorKind& error,
                                const std::string& file) {
  draw(chart_script(chart, error, FigureKind::kHover, file), file);
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  std::error_code gone;
  std::filesystem::remove(file, gone);
  return text.str();
}

std::vector<std::string> write_chart_files(const ChartPlan& plan,
                                           const std::vector<const ErrorKind*>& errors,
                                           const std::string& folder, const ChartOrigin& origin) {
  std::vector<std::string> files = {"chart.csv", "chart.html", "fronts.md"};
  std::vector<std::string> hovers;
  for (const SceneChart& chart : plan.scenes)
    for (const ErrorKind* error : errors) {
      files.push_back(file_stem(chart.name) + '-' + error->name + ".svg");
      const std::string still = file_in(folder, files.back());
      draw(chart_script(chart, *error, FigureKind::kStill, still), still);
      hovers.push_back(hover_figure(chart, *error, still + ".hover"));
    }
  write_text(file_in(folder, files[0]), chart_csv(plan, origin));
  write_text(file_in(folder, files[1]), chart_page(plan, errors, hovers, origin));
  write_text(file_in(folder, files[2]), chart_markdown(plan, *errors.front(), origin));
  return files;
}

}  // namespace cycloid::accuracy
