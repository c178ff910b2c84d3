#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <vector>

#include "cli/commands.hpp"
#include "cli/files.hpp"
#include "cli/output.hpp"
#include "cli/replaying.hpp"
#include "cli/report.hpp"
#include "cli/shard.hpp"
#include "cli/side_by_side.hpp"

namespace cycloid::cli {
namespace {

struct VerifyOptions {
  std::vector<std::string> paths;
  bool allow_open = false;
  LoadOptions loading;
  std::string shard;
  double timeout_s = 0.0;
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

/// Those of the files that are for this job. Bytes decide, not names, so every job has to read all:
/// a small part of what replaying them takes.
std::vector<std::string> part_of(const std::vector<std::string>& files, const std::string& shard) {
  if (shard.empty()) return files;
  const Shard part = shard_of(shard, system_environment());
  std::vector<std::string> mine;
  for (const std::string& file : files) {
    bool is_mine = part.number == 1;  // What cannot be read is for one to complain about.
    try {
      is_mine = part.holds(read_log_bytes(file));
    } catch (const Failure&) {
    }
    if (is_mine) mine.push_back(file);
  }
  return mine;
}

/// What a log that was replayed without a difference is, by its end.
void judge_end(const LoadedLog& loaded, bool allow_open, Verdict& verdict) {
  const std::string blemish = loaded.blemish();
  if (blemish.empty()) return;
  const bool open = loaded.log.state == protocol::LogState::kOpen;
  verdict.exit = (open && allow_open) || loaded.salvaged ? kExitGood : kExitCorrupt;
  verdict.text = blemish;
}

using Deadline = std::optional<std::chrono::steady_clock::time_point>;

/// How a file is verified: in as many threads as `jobs`.
struct Verifying {
  const VerifyOptions& options;
  Deadline deadline;
  int jobs = 1;
};

void verify_log(const std::string& file, const Verifying& how, Verdict& verdict) {
  const VerifyOptions& options = how.options;
  const LoadedLog loaded = load_log(file, options.loading);
  ReplayOptions replaying;
  replaying.workers = options.workers;
  replaying.lanes = options.lanes;
  replaying.deadline = how.deadline;
  const Replayed replayed = replay_in_parts(loaded, replaying, how.jobs);
  verdict.ticks = replayed.ticks;
  if (replayed.divergence) {
    verdict.exit = kExitDiverged;
    verdict.text = divergence_text(*replayed.divergence);
  } else if (replayed.timed_out) {
    verdict.exit = kExitTimeout;
    verdict.text = "out of time at tick " + std::to_string(replayed.tick()) + " of " +
                   std::to_string(loaded.last_tick());
  } else {
    judge_end(loaded, options.allow_open, verdict);
  }
}

Verdict verdict_on(const std::string& file, const Verifying& how) {
  using Clock = std::chrono::steady_clock;
  Verdict verdict;
  verdict.name = file;
  const auto start = Clock::now();
  try {
    if (how.deadline && start >= *how.deadline) {
      verdict.exit = kExitTimeout;
      verdict.text = "out of time before it was begun";
    } else {
      verify_log(file, how, verdict);
    }
  } catch (const Failure& failure) {  // One bad log must not hide the verdict on the others.
    verdict.exit = failure.exit;
    verdict.text = failure.what();
    if (verdict.text.starts_with(file + ": ")) verdict.text.erase(0, file.size() + 2);
  }
  verdict.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return verdict;
}

Exit verify_logs(const VerifyOptions& options, bool json) {
  using Clock = std::chrono::steady_clock;
  const std::vector<std::string> logs = logs_of(options.paths);
  for (const std::string& log : logs) refuse_report_on(log, "LOG", options.report);
  const std::vector<std::string> files = part_of(logs, options.shard);
  const std::size_t jobs_each =
      static_cast<std::size_t>(options.jobs) / std::max<std::size_t>(files.size(), 1);
  Verifying how{options, {}, std::max(static_cast<int>(jobs_each), 1)};
  if (options.timeout_s > 0.0) {
    how.deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                      std::chrono::duration<double>(options.timeout_s));
  }
  Report report{"cycloid verify", "log", std::vector<Verdict>(files.size())};
  side_by_side(files.size(), options.jobs,
               [&](std::size_t i) { report.verdicts[i] = verdict_on(files[i], how); });
  return publish(report, options.report, json);
}

}  // namespace

void add_verify(CLI::App& app, Action& action) {
  auto options = std::make_shared<VerifyOptions>();
  CLI::App* command =
      add_command(app, "verify",
                  "Replay logs and say of each whether it is good; exits with the worst", action);
  action.files.reads(
      command->add_option("LOG", options->paths, "Logs, or folders to search for *.cylog")
          ->required());
  command->add_flag("--allow-open", options->allow_open,
                    "A log without its end, such as of a killed server, is good");
  add_salvage_option(command, options->loading);
  command->add_option("--shard", options->shard,
                      "Only part I of N of the logs, by their bytes: 'I/N', or 'auto' from the "
                      "variables of a Kubernetes Job, a Slurm array or GNU parallel");
  command->add_option("--timeout", options->timeout_s, "Seconds for all; then exit 124")
      ->check(CLI::PositiveNumber);
  command->add_option("--workers", options->workers, "Threads; changes no bit")
      ->capture_default_str()
      ->check(CLI::Range(1, 64));
  add_lanes_option(command, options->lanes);
  command
      ->add_option("--jobs", options->jobs,
                   "Threads: logs side by side, and of fewer logs their parts between keyframes")
      ->capture_default_str()
      ->check(CLI::Range(1, 256));
  add_report_options(command, options->report, action.files);
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
