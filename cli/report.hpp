#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/exit_codes.hpp"
#include "cli/file_options.hpp"
#include "cli/output.hpp"

namespace cycloid::cli {

/// What was found out about one log or scene.
struct Verdict {
  std::string name;
  std::string file;  ///< To look into where it is bad; "" where it is the name.
  int line = 0;      ///< Of that file; 0: none.
  Exit exit = kExitGood;
  std::uint64_t ticks = 0;  ///< Compared and found equal.
  double seconds = 0.0;
  std::string text = "good";
};

/// The verdicts of one command.
struct Report {
  std::string suite;  ///< "cycloid verify"
  std::string item;   ///< What a verdict is about: "log", "scene".
  std::vector<Verdict> verdicts;

  /// The worst exit code of all.
  Exit worst() const;
  std::uint64_t good() const;
  std::uint64_t ticks() const;
  double seconds() const;
  /// "3 of 4 logs good, 1800 ticks compared"
  std::string summary() const;
};

/// Where a report goes besides stdout.
struct ReportOptions {
  std::string junit;  ///< A file; "": none.
  bool github = false;
};

/// `--junit` and `--github`.
void add_report_options(CLI::App* command, ReportOptions& options, FileOptions& files);

/// WouldBeLost where the JUnit file would be what the report is on, a file that `option` has led
/// to.
void refuse_report_on(const std::string& file, const std::string& option,
                      const ReportOptions& options);

/// Prints what is asked for: a line per verdict and a summary, or one JSON object; the JUnit file;
/// GitHub's commands, on stderr where stdout holds the object. A Failure where the file cannot be
/// written.
/// @returns the worst exit code.
Exit publish(const Report& report, const ReportOptions& options, bool json);

/// Runs `work`, which publishes a report by itself unless it throws a Failure. That is then the one
/// verdict of the JUnit file and of GitHub's commands, placed at the file and line that `subject`
/// names by then, and thrown on: a job that could not begin must not look like one without results.
Exit publish_failure(Verdict& subject, const std::string& suite, const ReportOptions& options,
                     bool json, const std::function<Exit()>& work);

std::string report_text(const Report& report);
Json report_json(const Report& report);
/// One test case for each verdict; what XML cannot hold is written as \xNN.
std::string report_junit(const Report& report);
/// An `::error` for each bad verdict and a `::notice` with the summary.
std::string report_github(const Report& report);

}  // namespace cycloid::cli
