#include "bench/runner/report.hpp"

#include <cinttypes>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "bench/figures/machine.hpp"

namespace cycloid::bench {

/// printf to a string.
template <class... Values>
static std::string format(const char* text, Values... values) {
  const int size = std::snprintf(nullptr, 0, text, values...);
  std::string result(static_cast<std::size_t>(size), '\0');
  std::snprintf(result.data(), result.size() + 1, text, values...);
  return result;
}

/// Three digits that mean something.
static std::string rounded(double value) {
  if (value <= 0.0) return "0";
  const int digits = 2 - static_cast<int>(std::floor(std::log10(value)));
  return format("%.*f", std::max(0, digits), value);
}

static std::string accuracy_text(const SceneResult& scene, const EngineResult& engine) {
  if (!engine.accuracy.finite) return "lost";
  std::string text = format("%.1f", 1e3 * static_cast<double>(engine.accuracy.overlap_m));
  if (scene.joints > 0) text += format(" / %.1f", 1e3 * static_cast<double>(engine.accuracy.gap_m));
  return text;
}

void print_result(const SceneResult& result) {
  std::printf("%s: %u bodies, %u joints, %d x %d runs\n", result.world.name.c_str(), result.bodies,
              result.joints, result.world.worlds, result.runs);
  for (const EngineResult& engine : result.engines) {
    if (!engine.why_not.empty()) {
      std::printf("  %-16s not measured: %s\n", engine.engine.c_str(), engine.why_not.c_str());
      continue;
    }
    std::printf("  %-16s %10s us %6.2f  %6u contacts  %10s mm  %8.0f kB", engine.engine.c_str(),
                rounded(engine.step_us).c_str(), engine.ratio, engine.contacts,
                accuracy_text(result, engine).c_str(), 1e-3 * engine.bytes);
    if (engine.digest != 0) std::printf("  %016" PRIx64, engine.digest);
    std::printf("\n");
  }
  std::fflush(stdout);
}

std::string write_csv(const std::vector<SceneResult>& results, const std::string& file) {
  std::ofstream stream(file);
  stream << "scene,worlds,runs,bodies,joints,engine,step_us,least_us,ratio,contacts,overlap_mm,"
            "gap_mm,finite,bytes,digest,why_not\n";
  for (const SceneResult& scene : results)
    for (const EngineResult& engine : scene.engines)
      stream << scene.world.name << ',' << scene.world.worlds << ',' << scene.runs << ','
             << scene.bodies << ',' << scene.joints << ',' << '"' << engine.engine << '"'
             << format(",%.4f,%.4f,%.4f,%u,%.4f,%.4f,%d,%.0f,%016" PRIx64, engine.step_us,
                       engine.least_us, engine.ratio, engine.contacts,
                       1e3 * static_cast<double>(engine.accuracy.overlap_m),
                       1e3 * static_cast<double>(engine.accuracy.gap_m),
                       engine.accuracy.finite ? 1 : 0, engine.bytes, engine.digest)
             << ",\"" << engine.why_not << "\"\n";
  stream.flush();
  return stream ? "" : file + ": cannot be written";
}

static std::string row_of(const SceneResult& scene) {
  std::string row = "| " + scene.world.name;
  if (scene.world.worlds > 1) row += format(" x %d", scene.world.worlds);
  row += format(" | %u | ", scene.bodies);
  for (const EngineResult& engine : scene.engines) {
    if (!engine.why_not.empty()) {
      row += "| | | ";
      continue;
    }
    row += rounded(engine.step_us) + " | ";
    if (&engine != &scene.engines[0]) row += format("%.2f | ", engine.ratio);
    row += accuracy_text(scene, engine) + " | " + format("%.0f | ", 1e-3 * engine.bytes);
  }
  return row + format("%016" PRIx64 " |\n", scene.engines[0].digest);
}

static std::string head_of(const SceneResult& scene) {
  std::string head = "| scene | bodies | ";
  std::string rule = "|---|---|";
  for (const EngineResult& engine : scene.engines) {
    head += engine.engine + ", µs | ";
    rule += "---|";
    if (&engine != &scene.engines[0]) {
      head += "ours / it | ";
      rule += "---|";
    }
    head += "mm | kB | ";
    rule += "---|---|";
  }
  return head + "digest |\n" + rule + "---|\n";
}

std::string markdown_tables(const std::vector<SceneResult>& results) {
  std::map<std::string, std::string> tables;  // By head.
  std::vector<std::string> heads;
  for (const SceneResult& scene : results) {
    const std::string head = head_of(scene);
    if (!tables.contains(head)) heads.push_back(head);
    tables[head] += row_of(scene);
  }
  std::string text = machine_text() + ". At most " +
                     std::to_string(results.empty() ? 0 : results[0].runs) +
                     " runs of each scene.\n";
  for (const std::string& head : heads) text += "\n" + head + tables[head];
  return text;
}

std::string machine_text() {
  return figures::machine_text() + ", compiler " + __VERSION__ + ", " + figures::date_text();
}

std::string replace_section(const std::string& file, const std::string& name,
                            const std::string& text) {
  std::ifstream stream(file);
  std::stringstream content;
  content << stream.rdbuf();
  if (!stream) return file + ": cannot be read";
  std::string whole = content.str();
  const std::string begin = "<!-- begin " + name + " -->\n";
  const std::string end = "<!-- end " + name + " -->\n";
  const std::size_t from = whole.find(begin);
  const std::size_t until = whole.find(end);
  if (from == std::string::npos || until == std::string::npos || until < from)
    return file + ": has no section " + name;
  whole.replace(from + begin.size(), until - from - begin.size(), text);
  std::ofstream out(file);
  out << whole;
  out.flush();
  return out ? "" : file + ": cannot be written";
}

}  // namespace cycloid::bench
