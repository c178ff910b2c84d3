#include <algorithm>
#include <chrono>
#include <memory>
#include <vector>

#include "cli/commands.hpp"
#include "cli/files.hpp"
#include "cli/log_file.hpp"
#include "cli/report.hpp"
#include "cli/side_by_side.hpp"

namespace cycloid::cli {
namespace {

struct VerifyOptions {
  std::vector<std::string> paths;
  bool allow_open = false;
  int workers = 1;
  int lanes = kLanesDefault;
  int jobs = 1;
  ReportOptions report;
};

/// The files named, and of each folder the *.cylog anywhere in it, by name.
std::vector<std::string> logs_of(const std::vector<std::string>& paths) {
  std::vector<std::string> files;
  for (const std::string& path : paths) {
    if (!kind_of(path).is_folder) {
      files.push_back(path);
      continue;
    }
    const std::vector<std::string> found = files_below(path, ".cylog");
    files.insert(files.end(), found.begin(), found.end());
  }
  if (files.empty()) throw Failure(kExitIo, paths.front() + ": no log (*.cylog) found");
  return files;
}

Verdict verify_log(const std::string& file, const VerifyOptions& options) {
  Verdict verdict;
  verdict.name = file;
  const auto start = std::chrono::steady_clock::now();
  try {
    const LoadedLog loaded = load_log(file);
    ReplayOptions replaying;
    replaying.workers = options.workers;
    replaying.lanes = options.lanes;
    const Replayed replayed = replay(loaded, replaying);
    const bool open = loaded.log.state == protocol::LogState::kOpen;
    verdict.ticks = replayed.ticks;
    if (replayed.divergence) {
      verdict.exit = kExitDiverged;
      verdict.text = divergence_text(*replayed.divergence);
    } else if (const std::string blemish = loaded.blemish(); !blemish.empty()) {
      verdict.exit = open && options.allow_open ? kExitGood : kExitCorrupt;
      verdict.text = blemish;
    }
  } catch (const Failure& failure) {  // One bad log must not hide the verdict on the others.
    verdict.exit = failure.exit;
    verdict.text = failure.what();
    if (verdict.text.starts_with(file + ": ")) verdict.text.erase(0, file.size() + 2);
  }
  verdict.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return verdict;
}

Exit verify_logs(const VerifyOptions& options, bool json) {
  const std::vector<std::string> files = logs_of(options.paths);
  Report report{"cycloid verify", "log", std::vector<Verdict>(files.size())};
  side_by_side(files.size(), options.jobs,
               [&](std::size_t i) { report.verdicts[i] = verify_log(files[i], options); });
  return publish(report, options.report, json);
}

}  // namespace

void add_verify(CLI::App& app, Action& action) {
  auto options = std::make_shared<VerifyOptions>();
  CLI::App* command =
      add_command(app, "verify",
                  "Replay logs and say of each whether it is good; exits with the worst", action);
  command->add_option("LOG", options->paths, "Logs, or folders to search for *.cylog")->required();
  command->add_flag("--allow-open", options->allow_open,
                    "A log without its end, such as of a killed server, is good");
  command->add_option("--workers", options->workers, "Threads; changes no bit")
      ->capture_default_str()
      ->check(CLI::Range(1, 64));
  add_lanes_option(command, options->lanes);
  command->add_option("--jobs", options->jobs, "Logs side by side")
      ->capture_default_str()
      ->check(CLI::Range(1, 256));
  add_report_options(command, options->report);
  command->callback([options, &action] {
    action.run = [=, &action] {
      Verdict subject;
      subject.name = options->paths.front();
      return publish_failure(subject, "cycloid verify", options->report, action.json,
                             [&] { return verify_logs(*options, action.json); });
    };
  });
}

}  // namespace cycloid::cli
