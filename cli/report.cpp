#include "cli/report.hpp"

#include <algorithm>
#include <cstdio>
#include <iostream>

#include "cli/files.hpp"
#include "cli/visible.hpp"
#include "cli/whole_file.hpp"

namespace cycloid::cli {
namespace {

const char* exit_name(Exit exit) {
  switch (exit) {
    case kExitGood:
      return "good";
    case kExitDiverged:
      return "diverged";
    case kExitUsage:
      return "usage";
    case kExitCorrupt:
      return "corrupt";
    case kExitIncompatible:
      return "incompatible";
    case kExitIo:
      return "input/output";
    case kExitTimeout:
      return "timeout";
  }
  return "unknown";
}

/// For text and for values in double quotes, where an unescaped line end would become a space.
std::string xml(std::string_view text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    const std::size_t size = character_bytes(text, at);
    if (size == 0) {
      out += escaped_byte(c);
    } else if (c == '&' || c == '<' || c == '>' || c == '"' || c == '\'' ||
               (size == 1 && c < ' ')) {
      out += "&#" + std::to_string(static_cast<int>(c)) + ";";
    } else {
      out += text.substr(at, size);
    }
    at += std::max<std::size_t>(size, 1);
  }
  return out;
}

/// "1.234"
std::string in_seconds(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f", seconds);
  return text;
}

/// What ends a workflow command or looks like a part of it; in a property also ':' and ','.
std::string workflow(std::string_view text, bool property) {
  std::string out;
  for (const char c : text) {
    if (c == '%') {
      out += "%25";
    } else if (c == '\r') {
      out += "%0D";
    } else if (c == '\n') {
      out += "%0A";
    } else if (property && c == ':') {
      out += "%3A";
    } else if (property && c == ',') {
      out += "%2C";
    } else {
      out += c;
    }
  }
  return out;
}

std::string workflow_error(const Report& report, const Verdict& verdict) {
  const std::string& file = verdict.file.empty() ? verdict.name : verdict.file;
  std::string command = "::error file=" + workflow(file, true);
  if (verdict.line != 0) command += ",line=" + std::to_string(verdict.line);
  command += ",title=" + workflow(report.suite + ": " + exit_name(verdict.exit), true);
  return command + "::" + workflow(verdict.name + ": " + verdict.text, false) + "\n";
}

std::string test_case(const Report& report, const Verdict& verdict) {
  std::string text = "    <testcase classname=\"" + xml(report.suite) + "\" name=\"" +
                     xml(verdict.name) + "\" time=\"" + in_seconds(verdict.seconds) + "\"";
  if (verdict.exit == kExitGood) return text + "/>\n";
  return text + ">\n      <failure type=\"" + exit_name(verdict.exit) + "\" message=\"" +
         xml(verdict.text) + "\">" + xml(verdict.name + ": " + verdict.text) +
         "</failure>\n    </testcase>\n";
}

void print_github(const Report& report, const ReportOptions& options, bool json) {
  if (options.github) (json ? std::cerr : std::cout) << report_github(report) << std::flush;
}

void write_junit(const Report& report, const ReportOptions& options) {
  if (!options.junit.empty()) write_file(options.junit, report_junit(report));
}

}  // namespace

Exit Report::worst() const {
  Exit worst = kExitGood;
  const auto rank = [](Exit exit) { return exit == kExitTimeout ? 0 : static_cast<int>(exit); };
  for (const Verdict& verdict : verdicts)
    if (rank(verdict.exit) > rank(worst) || worst == kExitGood) worst = verdict.exit;
  return worst;
}

std::uint64_t Report::good() const {
  return static_cast<std::uint64_t>(
      std::count_if(verdicts.begin(), verdicts.end(),
                    [](const Verdict& verdict) { return verdict.exit == kExitGood; }));
}

std::uint64_t Report::ticks() const {
  std::uint64_t ticks = 0;
  for (const Verdict& verdict : verdicts) ticks += verdict.ticks;
  return ticks;
}

double Report::seconds() const {
  double seconds = 0.0;
  for (const Verdict& verdict : verdicts) seconds += verdict.seconds;
  return seconds;
}

std::string Report::summary() const {
  return std::to_string(good()) + " of " + std::to_string(verdicts.size()) + " " + item +
         "s good, " + std::to_string(ticks()) + " ticks replayed";
}

std::string report_text(const Report& report) {
  std::string text;
  for (const Verdict& verdict : report.verdicts)
    text += visible(verdict.name) + ": " + visible_lines(verdict.text) + ", " +
            std::to_string(verdict.ticks) + " ticks\n";
  return text + report.summary() + "\n";
}

Json report_json(const Report& report) {
  Json verdicts = Json::array();
  for (const Verdict& verdict : report.verdicts) {
    verdicts.push_back({{report.item, verdict.name},
                        {"good", verdict.exit == kExitGood},
                        {"ticks", verdict.ticks},
                        {"verdict", verdict.text},
                        {"exit", static_cast<int>(verdict.exit)}});
  }
  return {{report.item + "s", verdicts},
          {"good", report.good()},
          {"bad", report.verdicts.size() - report.good()},
          {"ticks", report.ticks()}};
}

std::string report_junit(const Report& report) {
  const std::string totals = " name=\"" + xml(report.suite) + "\" tests=\"" +
                             std::to_string(report.verdicts.size()) + "\" failures=\"" +
                             std::to_string(report.verdicts.size() - report.good()) +
                             "\" errors=\"0\" time=\"" + in_seconds(report.seconds()) + "\"";
  std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites" + totals +
                     ">\n  <testsuite" + totals + " skipped=\"0\">\n";
  for (const Verdict& verdict : report.verdicts) text += test_case(report, verdict);
  return text + "  </testsuite>\n</testsuites>\n";
}

std::string report_github(const Report& report) {
  std::string text;
  for (const Verdict& verdict : report.verdicts)
    if (verdict.exit != kExitGood) text += workflow_error(report, verdict);
  return text + "::notice title=" + workflow(report.suite, true) +
         "::" + workflow(report.summary(), false) + "\n";
}

void add_report_options(CLI::App* command, ReportOptions& options, FileOptions& files) {
  files.writes(command->add_option("--junit", options.junit,
                                   "Write the verdicts to this file as JUnit XML"));
  command->add_flag("--github", options.github,
                    "Print the bad verdicts as annotations for GitHub Actions");
}

void refuse_report_on(const std::string& file, const std::string& option,
                      const ReportOptions& options) {
  if (options.junit.empty()) return;
  if (kind_of(file).exists) refuse_same_file("--junit", options.junit, option, file);
}

Exit publish(const Report& report, const ReportOptions& options, bool json) {
  write_junit(report, options);  // Before stdout has an object: a failure is one, too.
  if (json) {
    print_json(report_json(report), report.worst());
  } else {
    std::cout << report_text(report);
  }
  print_github(report, options, json);
  return report.worst();
}

Exit publish_failure(Verdict& subject, const std::string& suite, const ReportOptions& options,
                     bool json, const std::function<Exit()>& work) {
  try {
    return work();
  } catch (const WouldBeLost&) {
    throw;
  } catch (const Failure& failure) {
    subject.exit = failure.exit;
    subject.text = failure.what();
    if (subject.text.starts_with(subject.name + ":")) {  // Reports have the name elsewhere.
      const std::string place = subject.name + ":" + std::to_string(subject.line) + ":";
      const bool placed = subject.text.starts_with(place);
      subject.text.erase(0, (placed ? place : subject.name + ":").size() + 1);
    }
    const Report report{suite, "run", {subject}};
    print_github(report, options, json);
    try {
      write_junit(report, options);
    } catch (const Failure& second) {
      if (subject.text == second.what()) throw;  // That was the first failure.
      throw Failure(failure.exit, std::string(failure.what()) + "\n" + second.what());
    }
    throw;
  }
}

}  // namespace cycloid::cli
