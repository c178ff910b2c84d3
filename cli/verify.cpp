#include <algorithm>
#include <iostream>
#include <memory>
#include <vector>

#include "cli/commands.hpp"
#include "cli/files.hpp"
#include "cli/log_file.hpp"
#include "cli/output.hpp"

namespace cycloid::cli {
namespace {

struct VerifyOptions {
  std::vector<std::string> paths;
  bool allow_open = false;
  int workers = 1;
  int lanes = kLanesDefault;
};

struct Verdict {
  std::string file;
  Exit exit = kExitGood;
  std::uint64_t ticks = 0;
  std::string text;
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
  Verdict verdict{file, kExitGood, 0, "good"};
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
    verdict.text = std::string(failure.what()).substr(file.size() + 2);
  }
  return verdict;
}

Exit verify_logs(const VerifyOptions& options, bool json) {
  Exit worst = kExitGood;
  std::uint64_t good = 0;
  std::uint64_t ticks = 0;
  Json logs = Json::array();
  const std::vector<std::string> files = logs_of(options.paths);
  for (const std::string& file : files) {
    const Verdict verdict = verify_log(file, options);
    worst = std::max(worst, verdict.exit);
    good += verdict.exit == kExitGood ? 1 : 0;
    ticks += verdict.ticks;
    if (json) {
      logs.push_back({{"log", file},
                      {"good", verdict.exit == kExitGood},
                      {"ticks", verdict.ticks},
                      {"verdict", verdict.text},
                      {"exit", static_cast<int>(verdict.exit)}});
    } else {
      std::cout << file << ": " << verdict.text << ", " << verdict.ticks << " ticks\n";
    }
  }
  if (json) {
    print_json({{"logs", logs}, {"good", good}, {"bad", files.size() - good}, {"ticks", ticks}},
               worst);
  } else {
    std::cout << good << " of " << files.size() << " logs good, " << ticks << " ticks replayed\n";
  }
  return worst;
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
  command->callback([options, &action] {
    action.run = [=, &action] { return verify_logs(*options, action.json); };
  });
}

}  // namespace cycloid::cli
