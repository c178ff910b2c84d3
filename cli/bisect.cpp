#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>
#include <utility>

#include "cli/blame.hpp"
#include "cli/commands.hpp"

namespace cycloid::cli {
namespace {

struct BisectOptions {
  std::string a;
  std::string b;
  std::string against;
  std::string runner;
  std::optional<std::uint64_t> ticks;
  std::size_t fields = 8;
  LoadOptions loading;
};

struct Finding {
  std::string name_a;
  std::string name_b;
  std::uint64_t ticks = 0;  ///< Compared.
  std::optional<std::uint64_t> input_tick;
  std::string input_text;
  std::optional<Blame> blame;
  std::vector<std::string> notes;  ///< What else is not the same, in sentences.
  Exit exit = kExitGood;           ///< Of the logs, where all is the same.

  bool any() const { return input_tick || blame || !notes.empty(); }
};

/// Steps both as far as both go, and looks into the first tick that differs.
void bisect_worlds(const Suspect& a, const Suspect& b, std::uint64_t ticks, std::size_t fields,
                   Finding& finding) {
  finding.name_a = a.name();
  finding.name_b = b.name();
  const Course course_a = a.course(ticks);
  const Course course_b = b.course(ticks);
  finding.ticks = std::min(course_a.digests.size(), course_b.digests.size()) - 1;
  if (const auto tick = first_difference(course_a, course_b)) {
    finding.ticks = *tick == course_a.begin ? 0 : *tick - 1 - course_a.begin;
    finding.blame = blame_tick(a, b, *tick, fields);
  } else if (!course_a.fault.empty() && course_a.last_tick() == course_b.last_tick()) {
    --finding.ticks;  // The last digest is still that of the tick before.
    finding.notes.push_back("neither steps to tick " + std::to_string(course_a.last_tick()) + ": " +
                            course_a.fault);
  } else if (course_a.digests.size() != course_b.digests.size()) {
    const bool a_ends = course_a.digests.size() < course_b.digests.size();
    finding.notes.push_back((a_ends ? finding.name_a : finding.name_b) +
                            " alone does not step beyond tick " +
                            std::to_string(course_a.begin + finding.ticks));
  }
}

void compare_inputs(const Match& a, const Match& b, std::uint64_t ticks, Finding& finding) {
  for (std::uint64_t tick = a.begin() + 1; tick <= ticks && !finding.input_tick; ++tick) {
    finding.input_text = input_difference(a.inputs(tick, 0), b.inputs(tick, 0));
    if (!finding.input_text.empty()) finding.input_tick = tick;
  }
}

/// A log whose digests are not those of this program was written by another, which alone can say
/// more.
void check_record(const Match& match, std::uint64_t ticks, Finding& finding) {
  const Course course = run_course(match, ticks, {});
  for (std::uint64_t tick = match.begin() + 1; tick <= course.last_tick(); ++tick) {
    const std::uint64_t recorded = match.recorded_digest(tick);
    const bool made = course.fault.empty() || tick < course.last_tick();
    if (made && recorded == course.at(tick)) continue;
    finding.notes.push_back(
        match.name + " was recorded by another build, or is damaged: at tick " +
        std::to_string(tick) + " it says " + hex16(recorded) + ", this program " +
        (made ? "makes " + hex16(course.at(tick)) : "cannot make it: " + course.fault) +
        "; to go on: cycloid bisect " + match.name +
        " --against PROGRAM, with the cycloid that wrote it");
    return;
  }
}

Finding bisect_logs(const BisectOptions& options) {
  const Match a = open_match(options.a, options.loading);
  const Match b = open_match(options.b, options.loading);
  if (!a.log || !b.log) {
    throw Failure(kExitUsage, (a.log ? b : a).name +
                                  ": not a log; scenes are compared by diff, or by --against");
  }
  if (a.begin() != b.begin()) {
    throw Failure(kExitUsage, a.name + " begins after tick " + std::to_string(a.begin()) + ", " +
                                  b.name + " after tick " + std::to_string(b.begin()) +
                                  ": cut both from one tick");
  }
  Finding finding;
  finding.exit = std::max(a.exit(), b.exit());
  const std::uint64_t ticks_a = a.ticks(0);
  const std::uint64_t ticks_b = b.ticks(0);
  const std::uint64_t ticks = std::min(ticks_a, ticks_b);
  compare_inputs(a, b, ticks, finding);
  bisect_worlds(*suspect_here(a.name, a), *suspect_here(b.name, b), ticks, options.fields, finding);
  check_record(a, ticks, finding);
  check_record(b, ticks, finding);
  if (!finding.any() && ticks_a != ticks_b) {
    finding.notes.push_back(a.name + " has " + std::to_string(ticks_a) + " ticks, " + b.name +
                            " has " + std::to_string(ticks_b));
  }
  return finding;
}

Finding bisect_builds(const BisectOptions& options) {
  const Match match = open_match(options.a, options.loading);
  Finding finding;
  finding.exit = match.exit();
  const auto here = suspect_here("this program", match);
  const auto there = suspect_there({options.against, options.runner}, match);
  bisect_worlds(*here, *there, match.stepped_to(options.ticks), options.fields, finding);
  if (!finding.blame || !match.log || finding.blame->tick == match.begin()) return finding;
  const std::string recorded = hex16(match.recorded_digest(finding.blame->tick));
  const std::string by = recorded == finding.blame->digest_a   ? finding.name_a
                         : recorded == finding.blame->digest_b ? finding.name_b
                                                               : "neither";
  finding.notes.push_back("recorded: " + recorded + ", as by " + by);
  return finding;
}

Json json_of(const Finding& finding) {
  Json json = {{"equal", !finding.any()}, {"ticks", finding.ticks}, {"a", finding.name_a},
               {"b", finding.name_b},     {"input_tick", nullptr},  {"input", finding.input_text},
               {"notes", finding.notes},  {"blame", nullptr}};
  if (finding.input_tick) json["input_tick"] = *finding.input_tick;
  if (finding.blame) json["blame"] = to_json(*finding.blame);
  return json;
}

void print_text(const Finding& finding) {
  if (finding.input_tick) {
    std::cout << "inputs first differ at tick " << *finding.input_tick << ": " << finding.input_text
              << '\n';
  }
  if (finding.blame) print_blame(*finding.blame, finding.name_a, finding.name_b);
  for (const std::string& note : finding.notes) std::cout << note << '\n';
  if (!finding.any()) std::cout << "equal for " << finding.ticks << " ticks\n";
}

Exit bisect(const BisectOptions& options, bool json) {
  if (options.b.empty() == options.against.empty())
    throw Failure(kExitUsage, "bisect: takes two logs, or one match and --against PROGRAM");
  const Finding finding = options.b.empty() ? bisect_builds(options) : bisect_logs(options);
  const Exit exit = finding.any() ? kExitDiverged : finding.exit;
  if (json) print_json(json_of(finding), exit);
  if (!json) print_text(finding);
  return exit;
}

}  // namespace

void add_bisect(CLI::App& app, Action& action) {
  auto options = std::make_shared<BisectOptions>();
  CLI::App* command = add_command(
      app, "bisect", "Name the tick, phase, object and field at which two logs or two builds part",
      action);
  command->add_option("A", options->a, "A log; with --against also a scene")->required();
  command->add_option("B", options->b, "Another log");
  add_salvage_option(command, options->loading);
  CLI::Option* against = command->add_option(
      "--against", options->against, "The cycloid of another build, to step the same match");
  command->add_option("--runner", options->runner, "What starts it: 'qemu-aarch64'")
      ->needs(against);
  command->add_option("--ticks", options->ticks,
                      "With --against: how many [all of a log, 600 of a scene]");
  command->add_option("--fields", options->fields, "How many differing fields to name at most")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  command->callback(
      [options, &action] { action.run = [=, &action] { return bisect(*options, action.json); }; });
}

}  // namespace cycloid::cli
