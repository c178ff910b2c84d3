// cycloid_bench: our solver beside those of other people, on scenes made by code. `./dev bench`
// builds and runs it; --help lists what it does.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/runner/growth.hpp"
#include "bench/runner/heaps.hpp"
#include "bench/runner/measure.hpp"
#include "bench/runner/report.hpp"
#include "scenes/catalogue.hpp"

namespace {

namespace bench = cycloid::bench;
namespace worlds = cycloid::worlds;

constexpr int kExitFailed = 1;
constexpr int kExitUsage = 2;
constexpr int kQuickRuns = 1;
constexpr int kAllRuns = 5;

struct Command {
  std::vector<std::string> scenes;
  std::vector<std::string> groups;
  bool all = false;
  bool list = false;
  int heaps = 0;  ///< Starts; 0: the scenes are measured instead.
  std::string csv;
  std::string markdown;  ///< The file whose sections are replaced.
  std::string figures;   ///< The folder of the growth chart.
  std::string export_folder;
  bench::MeasureOptions options;
};

struct GroupName {
  const char* name;
  worlds::Group group;
};
constexpr GroupName kGroups[] = {{"small", worlds::Group::kSmall},
                                 {"plane", worlds::Group::kPlane},
                                 {"space", worlds::Group::kSpace},
                                 {"growth", worlds::Group::kGrowth}};

const char* name_of(worlds::Group group) {
  return kGroups[static_cast<std::size_t>(group)].name;
}

/// What a look of a few minutes takes: all small worlds and all of space, and of the large worlds
/// a pile, joints and one that keeps moving.
bool is_quick(const worlds::BenchWorld& world) {
  return world.group == worlds::Group::kSmall || world.group == worlds::Group::kSpace ||
         world.name == "large-pyramid" || world.name == "joint-grid" || world.name == "tumbler";
}

/// Exits where a name is unknown.
std::vector<worlds::BenchWorld> chosen(const Command& command) {
  std::vector<worlds::BenchWorld> found;
  for (const std::string& name : command.scenes) {
    const auto world = worlds::find_bench_world(name);
    if (!world) {
      std::fprintf(stderr, "cycloid_bench: --scene %s: there is no such scene; see --list\n",
                   name.c_str());
      std::exit(kExitUsage);
    }
    found.push_back(*world);
  }
  for (const worlds::BenchWorld& world : worlds::bench_worlds()) {
    const bool in_group = std::find(command.groups.begin(), command.groups.end(),
                                    name_of(world.group)) != command.groups.end();
    const bool by_default = command.scenes.empty() && command.groups.empty() && is_quick(world);
    if (command.all || in_group || by_default) found.push_back(world);
  }
  return found;
}

int write_scenes(const std::vector<worlds::BenchWorld>& scenes, const std::string& folder) {
  std::filesystem::create_directories(folder);
  for (const worlds::BenchWorld& world : scenes) {
    const std::string file = folder + "/" + world.name + ".json";
    std::FILE* stream = std::fopen(file.c_str(), "w");
    const std::string json = cycloid::scenes::to_json(worlds::make_scene(world));
    const bool written = stream != nullptr && std::fputs(json.c_str(), stream) >= 0;
    if (stream == nullptr || std::fclose(stream) != 0 || !written) {
      std::fprintf(stderr, "cycloid_bench: %s: cannot be written\n", file.c_str());
      return kExitFailed;
    }
    std::printf("%s\n", file.c_str());
  }
  return 0;
}

/// Says why, where there is a why. @returns the exit code.
int report(const std::string& why) {
  if (why.empty()) return 0;
  std::fprintf(stderr, "cycloid_bench: %s\n", why.c_str());
  return kExitFailed;
}

int write_reports(const Command& command, const std::vector<bench::SceneResult>& results) {
  int exit = 0;
  if (!command.csv.empty()) exit |= report(bench::write_csv(results, command.csv));
  for (const GroupName& group : kGroups) {
    std::vector<bench::SceneResult> of_group;
    for (const bench::SceneResult& result : results)
      if (result.world.group == group.group) of_group.push_back(result);
    if (of_group.empty()) continue;
    if (!command.markdown.empty())
      exit |= report(
          bench::replace_section(command.markdown, group.name, bench::markdown_tables(of_group)));
    if (!command.figures.empty() && group.group == worlds::Group::kGrowth)
      exit |= report(bench::draw_growth(of_group, command.figures));
  }
  return exit;
}

/// How far heaps overlap in each engine, instead of how long they take.
int run_heaps(const Command& command) {
  const std::string table =
      bench::heaps_markdown(bench::measure_heaps<2>(command.heaps), "heaps of 40 to 400 bodies") +
      "\n" +
      bench::heaps_markdown(bench::measure_heaps<2>(command.heaps, 100.0f),
                            "of the same heaps, half of whose bodies are 100 times as heavy") +
      "\n" +
      bench::heaps_markdown(bench::measure_heaps<3>(command.heaps),
                            "pits of 150 balls in space (`ball-pit-3d`)");
  std::printf("%s", table.c_str());
  if (command.markdown.empty()) return 0;
  return report(bench::replace_section(command.markdown, "heaps", table));
}

int run(const Command& command) {
  if (command.heaps > 0) return run_heaps(command);
  const std::vector<worlds::BenchWorld> scenes = chosen(command);
  if (command.list) {
    for (const worlds::BenchWorld& world : worlds::bench_worlds())
      std::printf("%-8s %-18s %s\n", name_of(world.group), world.name.c_str(),
                  worlds::make_scene(world).summary.c_str());
    return 0;
  }
  const bool whole_groups = command.scenes.empty() && (command.all || !command.groups.empty());
  if (!whole_groups && (!command.markdown.empty() || !command.figures.empty())) {
    std::fprintf(stderr,
                 "cycloid_bench: --markdown and --figures: tables hold whole groups; say "
                 "--all or --group, and no --scene\n");
    return kExitUsage;
  }
  if (!command.export_folder.empty()) return write_scenes(scenes, command.export_folder);
  std::printf("%s\n", bench::machine_text().c_str());
  std::printf(
      "time per step; ours over it; contacts; deepest overlap / widest gap of a joint; "
      "memory; digest\n");
  std::vector<bench::SceneResult> results;
  for (const worlds::BenchWorld& world : scenes) {
    results.push_back(bench::measure_scene(world, command.options));
    bench::print_result(results.back());
  }
  return write_reports(command, results);
}

void add_options(CLI::App& app, Command& command) {
  bench::MeasureOptions& options = command.options;
  app.add_option("--scene", command.scenes, "One scene, of --list or of the catalogue; repeatable");
  app.add_option("--group", command.groups, "All scenes of small, plane, space or growth")
      ->check(CLI::IsMember({"small", "plane", "space", "growth"}));
  app.add_flag("--all", command.all, "Every scene, five runs each");
  app.add_flag("--list", command.list, "Print the scenes and what they are");
  app.add_option("--heaps", command.heaps,
                 "Drop so many heaps in each engine, and say how far they overlap")
      ->check(CLI::Range(2, 100000));
  app.add_option("--runs", options.runs, "Repetitions of each scene; the median counts")
      ->check(CLI::Range(1, 1000));
  app.add_option("--worlds", options.worlds, "Worlds in rotation; by default the scene's")
      ->check(CLI::Range(1, 10000));
  app.add_option("--lanes", options.lanes,
                 "Of ours: contacts an instruction; 0: what suits each step")
      ->capture_default_str()
      ->check(CLI::IsMember({0, 1, 4, 8, 16}));
  app.add_option("--workers", options.workers, "Also ours with so many threads; time of the wall")
      ->check(CLI::Range(1, 64));
  app.add_option("--substeps", options.substeps, "Of ours; by default the scene's")
      ->check(CLI::Range(1, 64));
  app.add_flag("--sleep", options.sleep, "Let bodies at rest sleep, in every engine");
  app.add_flag("!--no-peers", options.peers, "Ours alone");
  app.add_option("--csv", command.csv, "Write every number to this file");
  app.add_option("--markdown", command.markdown, "Replace the tables of this file");
  app.add_option("--figures", command.figures,
                 "Draw the chart of the growth scenes to this folder");
  app.add_option("--export", command.export_folder,
                 "Measure nothing: write the scenes as JSON to this folder");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Our solver beside others, tick for tick in one process", "cycloid_bench");
  Command command;
  command.options.runs = 0;
  add_options(app, command);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    std::fprintf(stderr, "cycloid_bench: %s (see --help)\n", error.what());
    return kExitUsage;
  }
  if (command.options.runs == 0) command.options.runs = command.all ? kAllRuns : kQuickRuns;
  return run(command);
}
