#include "bench/accuracy/chart_files.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <stdexcept>

#include "bench/accuracy/chart_figure.hpp"
#include "bench/figures/gnuplot.hpp"

namespace cycloid::accuracy {

/// Of a scene's name: names of files have an end.
static constexpr std::size_t kStemBytesMax = 100;

/// What a scene is called in names of files, as none of the others is: a file's path or a scene's
/// parameters are no name.
static std::string file_stem(const std::string& name, std::set<std::string>& taken) {
  std::string stem;
  for (const char c : name) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    stem += plain || c == '-' || c == '_' ? c : '-';
  }
  stem.resize(std::min(stem.size(), kStemBytesMax));
  while (!taken.insert(stem).second) stem += "-2";
  return stem;
}

static std::string file_in(const std::string& folder, const std::string& name) {
  return (std::filesystem::path(folder) / name).string();
}

std::string chart_csv_file(const std::string& folder) {
  return file_in(folder, "chart.csv");
}

void write_chart_text(const std::string& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text << std::flush;
  if (!stream) throw std::runtime_error(file + ": cannot be written");
}

/// As text: what gnuplot has drawn beside `file` is gone again.
static std::string drawn(const SceneChart& chart, const ErrorKind& error, FigureKind kind,
                         const std::string& svg_file) {
  const std::string file = svg_file + ".drawing";
  const std::string script = chart_script(chart, error, kind, file);
  if (const std::string why = figures::run_gnuplot(script, file); !why.empty())
    throw std::runtime_error(why);
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  std::error_code gone;
  std::filesystem::remove(file, gone);
  return text.str();
}

std::vector<std::string> write_chart_files(const ChartPlan& plan,
                                           const std::vector<const ErrorKind*>& errors,
                                           const std::string& folder, const ChartOrigin& origin,
                                           const TextWriter& write) {
  std::vector<std::string> files = {"chart.csv", "chart.html", "fronts.md"};
  write(chart_csv_file(folder), chart_csv(plan, *errors.front(), origin));
  write(file_in(folder, files[2]), chart_markdown(plan, *errors.front(), origin));
  std::vector<std::string> hovers;
  std::set<std::string> stems;
  for (const SceneChart& chart : plan.scenes) {
    const std::string stem = file_stem(chart.name, stems);
    for (const ErrorKind* error : errors) {
      files.push_back(stem + '-' + error->name + ".svg");
      const std::string still = file_in(folder, files.back());
      write(still, drawn(chart, *error, FigureKind::kStill, still));
      hovers.push_back(drawn(chart, *error, FigureKind::kHover, still));
    }
  }
  write(file_in(folder, files[1]), chart_page(plan, errors, hovers, origin));
  return files;
}

}  // namespace cycloid::accuracy
