#include "scenes/golden.hpp"

#include <algorithm>
#include <chrono>
#include <iostream>
#include <limits>
#include <memory>
#include <set>

#include "cli/commands.hpp"
#include "cli/files.hpp"
#include "cli/replaying.hpp"
#include "cli/report.hpp"
#include "cli/side_by_side.hpp"
#include "cli/whole_file.hpp"
#include "solver/version.hpp"

namespace cycloid::cli {
namespace {

struct PlayOptions {
  int workers = 1;
  int lanes = kLanesDefault;
  int jobs = 1;
};

struct MakeOptions {
  std::vector<std::string> scenes;
  bool catalogue = false;
  std::string file;
  std::uint64_t ticks = 0;  ///< 0: the last of `at`.
  std::vector<std::uint64_t> at;
  PlayOptions play;
};

struct CheckOptions {
  std::string file;
  std::uint64_t ticks = std::numeric_limits<std::uint64_t>::max();
  std::vector<std::string> scenes;
  PlayOptions play;
  ReportOptions report;
};

scenes::GoldenWalk start_walk(const scenes::Scene& scene, const PlayOptions& play) {
  return {scene, make_simulation(scene, play.workers, play.lanes)};
}

/// The ticks to list, rising; the last is the last that is played.
std::vector<std::uint64_t> listed_ticks(const MakeOptions& options) {
  std::set<std::uint64_t> listed(options.at.begin(), options.at.end());
  if (options.at.empty()) listed = {1, 10, 100, 600};
  if (options.ticks != 0) {
    if (!options.at.empty() && *listed.rbegin() > options.ticks)
      throw Failure(kExitUsage, "--at: " + std::to_string(*listed.rbegin()) + " is behind --ticks");
    listed.erase(listed.upper_bound(options.ticks), listed.end());
    listed.insert(options.ticks);
  }
  return {listed.begin(), listed.end()};
}

/// How a golden file names a scene that the command line names: the file may move with its folder,
/// and nothing depends on the folder that the program is called in.
std::string name_in(const std::string& golden, const std::string& scene) {
  if (!kind_of(scene).exists) return scene;
  const std::string name = path_from(golden.empty() ? "x" : golden, scene);
  return scenes::is_path(name) ? name : "./" + name;
}

scenes::GoldenScene make_scene(const std::string& what, const std::string& name,
                               const std::vector<std::uint64_t>& listed, const PlayOptions& play) {
  const scenes::Scene scene = load_scene(what);
  scenes::GoldenWalk walk = start_walk(scene, play);
  scenes::GoldenScene golden;
  golden.name = name;
  golden.ticks = listed.back();
  golden.scene_digest = scenes::scene_digest(scene);
  golden.inputs_digest = scenes::inputs_digest(scene, golden.ticks);
  for (const std::uint64_t tick : listed) {
    const solver::Result<scenes::GoldenRow> row = walk.walk_to(tick);
    if (!row.ok()) {
      throw Failure(kExitDiverged, what + ": the world does not step to tick " +
                                       std::to_string(walk.tick() + 1) + ": " +
                                       error_text(row.error()));
    }
    golden.rows.push_back(row.value());
  }
  return golden;
}

Exit make_golden(const MakeOptions& options, bool json) {
  if (json && options.file.empty()) throw Failure(kExitUsage, "--json: needs -o for the goldens");
  std::vector<std::string> scenes = options.scenes;
  if (options.catalogue)
    for (const auto& entry : scenes::catalogue()) scenes.push_back(entry.name);
  if (scenes.empty()) throw Failure(kExitUsage, "SCENE: name at least one, or --catalogue");
  std::set<std::string> names;
  for (const std::string& scene : scenes)
    if (!names.insert(name_in(options.file, scene)).second)
      throw Failure(kExitUsage, "SCENE: " + scene + " is named twice");

  const std::vector<std::uint64_t> listed = listed_ticks(options);
  scenes::GoldenFile file;
  file.solver_version = solver::kSolverVersion;
  file.scenes.resize(scenes.size());
  side_by_side(scenes.size(), options.play.jobs, [&](std::size_t i) {
    file.scenes[i] = make_scene(scenes[i], name_in(options.file, scenes[i]), listed, options.play);
  });
  const std::string text = scenes::to_golden_text(file);
  if (options.file.empty()) {
    std::cout << text;
    return kExitGood;
  }
  write_file(options.file, text);
  const std::size_t rows = listed.size() * scenes.size();
  if (json) {
    print_json({{"golden", options.file},
                {"solver_version", file.solver_version},
                {"scenes", scenes.size()},
                {"rows", rows}},
               kExitGood);
  } else {
    std::cout << options.file << ": " << rows << " rows of " << scenes.size() << " scenes\n";
  }
  return kExitGood;
}

scenes::GoldenFile load_golden(const std::string& file, Verdict& subject) {
  const std::vector<std::byte> bytes = read_file(file);
  scenes::ParsedGolden parsed =
      scenes::parse_golden({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  if (parsed.file) return std::move(*parsed.file);
  subject.line = parsed.mistake.line;
  throw Failure(parsed.mistake.other_format ? kExitIncompatible : kExitCorrupt,
                file + ":" + std::to_string(subject.line) + ": " + parsed.mistake.reason);
}

/// A Failure where the scene is not, or is not the one that the goldens were made of.
scenes::Scene scene_of(const scenes::GoldenScene& golden, const std::string& file) {
  std::string what = golden.name;
  if (scenes::is_path(golden.name)) {
    what = path_to(file, golden.name);
    read_file(what);
  } else if (!scenes::find(golden.name).scene) {
    throw Failure(kExitIncompatible, "this program has no scene of this name");
  }
  scenes::Loaded loaded =
      scenes::is_path(golden.name) ? scenes::load_file(what) : scenes::find(what);
  if (!loaded.scene) throw Failure(kExitCorrupt, mistakes_text(what, loaded.mistakes));
  const std::uint64_t digest = scenes::scene_digest(*loaded.scene);
  if (digest != golden.scene_digest) {
    throw Failure(kExitIncompatible, "the scene has changed: its digest is " + hex16(digest) +
                                         ", the goldens are of " + hex16(golden.scene_digest));
  }
  const std::uint64_t inputs = scenes::inputs_digest(*loaded.scene, golden.ticks);
  if (inputs != golden.inputs_digest) {
    throw Failure(kExitIncompatible, "the scene's script has changed: its digest is " +
                                         hex16(inputs) + ", the goldens are of " +
                                         hex16(golden.inputs_digest));
  }
  return std::move(*loaded.scene);
}

Verdict check_scene(const scenes::GoldenScene& golden, const CheckOptions& options) {
  Verdict verdict;
  verdict.name = golden.name;
  verdict.file = options.file;
  verdict.line = golden.line;
  const auto start = std::chrono::steady_clock::now();
  try {
    if (golden.rows.front().tick > options.ticks) {
      throw Failure(kExitIo, "no row to compare: the first is of tick " +
                                 std::to_string(golden.rows.front().tick));
    }
    const scenes::Scene scene = scene_of(golden, options.file);
    scenes::GoldenWalk walk = start_walk(scene, options.play);
    if (const auto mismatch = scenes::compare_golden(golden, walk, options.ticks)) {
      verdict.exit = kExitDiverged;
      verdict.line = mismatch->expected.line;
      verdict.ticks = mismatch->first - 1;
      verdict.text = scenes::mismatch_text(*mismatch);
    } else {
      verdict.ticks = walk.tick();
    }
  } catch (const Failure& failure) {  // One bad scene must not hide the verdict on the others.
    verdict.exit = failure.exit;
    verdict.text = failure.what();
  }
  verdict.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return verdict;
}

/// Those of the file that the command line names, in the file's order; all where it names none.
std::vector<scenes::GoldenScene> chosen(scenes::GoldenFile file, const CheckOptions& options) {
  if (options.scenes.empty()) return std::move(file.scenes);
  std::set<std::string> wanted(options.scenes.begin(), options.scenes.end());
  std::vector<scenes::GoldenScene> scenes;
  for (scenes::GoldenScene& scene : file.scenes)
    if (wanted.erase(scene.name) != 0) scenes.push_back(std::move(scene));
  if (!wanted.empty()) {
    throw Failure(kExitUsage,
                  "--scene: " + options.file + " has no scene '" + *wanted.begin() + "'");
  }
  return scenes;
}

Exit check_golden(const CheckOptions& options, Verdict& subject, bool json) {
  scenes::GoldenFile file = load_golden(options.file, subject);
  if (file.solver_version != solver::kSolverVersion) {
    subject.line = 2;
    throw Failure(kExitIncompatible, options.file + ": the goldens are of solver version " +
                                         std::to_string(file.solver_version) +
                                         ", this program is of " +
                                         std::to_string(solver::kSolverVersion));
  }
  const std::vector<scenes::GoldenScene> scenes = chosen(std::move(file), options);
  for (const scenes::GoldenScene& scene : scenes)
    if (scenes::is_path(scene.name))
      refuse_report_on(path_to(options.file, scene.name), "FILE", options.report);
  Report report{"cycloid golden check", "scene", std::vector<Verdict>(scenes.size())};
  side_by_side(scenes.size(), options.play.jobs,
               [&](std::size_t i) { report.verdicts[i] = check_scene(scenes[i], options); });
  return publish(report, options.report, json);
}

void add_play_options(CLI::App* command, PlayOptions& play) {
  command->add_option("--workers", play.workers, "Threads of a world; changes no bit")
      ->capture_default_str()
      ->check(CLI::Range(1, 64));
  add_lanes_option(command, play.lanes);
  command->add_option("--jobs", play.jobs, "Scenes side by side")
      ->capture_default_str()
      ->check(CLI::Range(1, 256));
}

}  // namespace

void add_golden(CLI::App& app, Action& action) {
  CLI::App* golden = app.add_subcommand("golden", "Make and check files of expected digests");
  golden->footer(kExitCodesText);
  golden->require_subcommand(1);

  auto making = std::make_shared<MakeOptions>();
  CLI::App* make = add_command(
      *golden, "make", "Play scenes by their scripts and write what to expect of them", action);
  action.files.reads(make->add_option("SCENE", making->scenes, "Catalogue names or scene files"));
  make->add_flag("--catalogue", making->catalogue, "Every scene of the catalogue");
  action.files.writes(make->add_option("-o", making->file, "The file to write; stdout without it"));
  make->add_option("--ticks", making->ticks, "How many ticks; the last is always listed [600]")
      ->check(CLI::Range(std::uint64_t{1}, scenes::kGoldenTicksMax));
  make->add_option("--at", making->at, "The ticks to list, by commas [1,10,100,600]")
      ->delimiter(',')
      ->check(CLI::Range(std::uint64_t{1}, scenes::kGoldenTicksMax));
  add_play_options(make, making->play);
  make->callback([making, &action] {
    action.run = [=, &action] { return make_golden(*making, action.json); };
  });

  auto checking = std::make_shared<CheckOptions>();
  CLI::App* check = add_command(*golden, "check",
                                "Play the scenes of a golden file and compare every tick; exits "
                                "with the worst",
                                action);
  action.files.reads(check->add_option("FILE", checking->file, "A golden file")->required());
  check->add_option("--ticks", checking->ticks, "Compare the rows up to this tick only")
      ->check(CLI::PositiveNumber);
  check->add_option("--scene", checking->scenes, "Only this scene of the file; may be repeated");
  add_play_options(check, checking->play);
  add_report_options(check, checking->report, action.files);
  check->callback([checking, &action] {
    action.run = [=, &action] {
      Verdict subject;
      subject.name = checking->file;
      return publish_failure(subject, "cycloid golden check", checking->report, action.json,
                             [&] { return check_golden(*checking, subject, action.json); });
    };
  });
}

}  // namespace cycloid::cli
