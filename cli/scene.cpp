#include <iomanip>
#include <iostream>
#include <memory>
#include <vector>

#include "cli/commands.hpp"
#include "cli/output.hpp"
#include "cli/visible.hpp"
#include "cli/whole_file.hpp"

namespace cycloid::cli {
namespace {

Exit list_scenes(bool json) {
  Json entries = Json::array();
  for (const scenes::CatalogueEntry& entry : scenes::catalogue()) {
    if (json) {
      entries.push_back(
          {{"name", entry.name}, {"summary", entry.summary}, {"parameters", entry.parameters}});
      continue;
    }
    std::cout << std::left << std::setw(18) << entry.name << entry.summary;
    if (!entry.parameters.empty()) std::cout << " [" << entry.parameters << ']';
    std::cout << '\n';
  }
  if (json) print_json({{"scenes", entries}}, kExitGood);
  return kExitGood;
}

/// Why a file cannot be read, or "".
std::string unreadable(const std::string& file) {
  try {
    read_file(file);
  } catch (const Failure& failure) {
    return failure.what();
  }
  return "";
}

Exit check_file(const std::string& file, bool json, Json& results) {
  Json mistakes = Json::array();
  Exit exit = kExitGood;
  if (const std::string reason = unreadable(file); !reason.empty()) {
    exit = kExitIo;
    mistakes.push_back({{"path", ""}, {"reason", reason}});
    std::cerr << "cycloid: " << visible(reason) << '\n';
  } else if (const scenes::Loaded loaded = scenes::load_file(file); !loaded.scene) {
    exit = kExitCorrupt;
    for (const scenes::Mistake& mistake : loaded.mistakes) {
      mistakes.push_back({{"path", mistake.path}, {"reason", mistake.reason}});
      if (!json) std::cout << mistakes_text(file, {mistake}) << '\n';
    }
  } else if (!json) {
    std::cout << visible(file) << ": good\n";
  }
  results.push_back({{"file", file}, {"good", exit == kExitGood}, {"mistakes", mistakes}});
  return exit;
}

Exit check_files(const std::vector<std::string>& files, bool json) {
  Exit worst = kExitGood;
  Json results = Json::array();
  for (const std::string& file : files) worst = std::max(worst, check_file(file, json, results));
  if (json) print_json({{"files", results}}, worst);
  return worst;
}

struct ExportOptions {
  std::string scene;
  bool binary = false;
  std::string file;
};

Exit export_scene(const ExportOptions& options, bool json) {
  if (json && options.file.empty()) throw Failure(kExitUsage, "--json: needs -o for the scene");
  const scenes::Scene scene = load_scene(options.scene);
  std::string bytes = options.binary ? "" : scenes::to_json(scene);
  if (options.binary) {
    const std::vector<std::byte> binary = scenes::to_binary(scene);
    bytes.assign(reinterpret_cast<const char*>(binary.data()), binary.size());
  } else if (!bytes.empty() && bytes.back() != '\n') {
    bytes += '\n';
  }
  if (options.file.empty()) {
    std::cout << bytes;
    return kExitGood;
  }
  write_file(options.file, bytes);
  if (json) {
    print_json({{"scene", scene.name},
                {"scene_digest", hex16(scenes::scene_digest(scene))},
                {"file", options.file},
                {"bytes", bytes.size()}},
               kExitGood);
  }
  return kExitGood;
}

}  // namespace

void add_scene(CLI::App& app, Action& action) {
  CLI::App* scene = app.add_subcommand("scene", "List, check and export scenes");
  scene->footer(kExitCodesText);

  CLI::App* list = add_command(*scene, "list", "The catalogue, one line each", action);
  list->callback([&action] { action.run = [&action] { return list_scenes(action.json); }; });

  auto files = std::make_shared<std::vector<std::string>>();
  CLI::App* check = add_command(
      *scene, "check", "Name every mistake in scene files as 'FILE: path: reason'", action);
  check->add_option("FILE", *files, "Scene files, JSON or binary")->required();
  check->callback(
      [files, &action] { action.run = [=, &action] { return check_files(*files, action.json); }; });

  auto options = std::make_shared<ExportOptions>();
  CLI::App* exporting = add_command(*scene, "export", "Write a scene as JSON or binary", action);
  action.files.reads(
      exporting->add_option("NAME", options->scene, "A catalogue name or a scene file")
          ->required());
  exporting->add_flag("--binary", options->binary, "The binary form instead of JSON");
  action.files.writes(
      exporting->add_option("-o", options->file, "The file to write; stdout without it"));
  exporting->callback([options, &action] {
    action.run = [=, &action] { return export_scene(*options, action.json); };
  });
}

}  // namespace cycloid::cli
