#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "cli/blame.hpp"
#include "cli/commands.hpp"
#include "cli/output.hpp"
#include "cli/trace_text.hpp"

namespace cycloid::cli {
namespace {

struct DiffOptions {
  std::string a;
  std::string b;
  std::uint64_t ticks = kScriptTicks;
  std::size_t fields = 8;
  LoadOptions loading;
};

/// One of the two, running.
struct Side {
  Match match;
  scenes::Simulation simulation;
};

Side open_side(const std::string& what, const LoadOptions& loading) {
  Match match = open_match(what, loading);
  scenes::Simulation simulation = match.start({});
  return {std::move(match), std::move(simulation)};
}

struct Found {
  std::uint64_t ticks = 0;  ///< Compared.
  std::optional<std::uint64_t> input_tick;
  std::string input_text;
  std::optional<std::uint64_t> state_tick;
  std::vector<solver::Difference> fields;
  std::optional<Blame> blame;  ///< Where in that tick; no tick has made the first state.
  std::string other;           ///< What else is not as it should be, in words.

  bool any() const { return input_tick || state_tick || !other.empty(); }
  void note(const std::string& sentence) { other += (other.empty() ? "" : "; ") + sentence; }
};

/// Whether the states are the same; else notes where they are not.
bool same_state(const Side& a, const Side& b, std::size_t fields, Found& found) {
  if (a.simulation.digest() == b.simulation.digest()) return true;
  found.state_tick = a.simulation.tick();
  found.fields = a.simulation.differences(b.simulation, fields);
  if (*found.state_tick == a.match.begin()) return false;
  const auto suspect_a = suspect_here(a.match.name, a.match);
  const auto suspect_b = suspect_here(b.match.name, b.match);
  found.blame = blame_tick(*suspect_a, *suspect_b, *found.state_tick, 1);
  return false;
}

void compare_inputs_of(const Side& a, const Side& b, std::uint64_t tick, Found& found) {
  if (found.input_tick) return;
  found.input_text = input_difference(a.match.inputs(tick, a.simulation.seats()),
                                      b.match.inputs(tick, b.simulation.seats()));
  if (!found.input_text.empty()) found.input_tick = tick;
}

enum class WhoSteps : std::uint8_t { kBoth, kOne, kNeither };

/// Steps both, and notes who cannot.
WhoSteps step_both(Side& a, Side& b, std::uint64_t tick, Found& found) {
  const solver::Error error_a = a.simulation.step(a.match.inputs(tick, a.simulation.seats()));
  const solver::Error error_b = b.simulation.step(b.match.inputs(tick, b.simulation.seats()));
  if (error_a.ok() && error_b.ok()) return WhoSteps::kBoth;
  if (!error_a.ok() && !error_b.ok()) {
    const std::string text_a = error_text(error_a);
    const std::string text_b = error_text(error_b);
    found.note("neither steps to tick " + std::to_string(tick) + ": " + text_a +
               (text_a == text_b ? "" : " against " + text_b));
    return WhoSteps::kNeither;
  }
  found.note("at tick " + std::to_string(tick) + " only " + (error_a.ok() ? b : a).match.name +
             " does not step: " + error_text(error_a.ok() ? error_b : error_a));
  return WhoSteps::kOne;
}

/// Where two logs recorded unlike digests for what steps alike here, one was made by another world.
/// @param replayed  What the replay has to say of it.
bool same_record(const Side& a, const Side& b, std::uint64_t tick, const std::string& replayed,
                 Found& found) {
  if (!a.match.log || !b.match.log) return true;
  const std::uint64_t digest_a = a.match.recorded_digest(tick);
  const std::uint64_t digest_b = b.match.recorded_digest(tick);
  if (digest_a == digest_b) return true;
  found.note("recorded digests differ at tick " + std::to_string(tick) + ": " + hex16(digest_a) +
             " against " + hex16(digest_b) + replayed);
  return false;
}

/// From a tick on that neither world can make: the first inputs and records that differ.
void compare_unstepped(const Side& a, const Side& b, std::uint64_t first, std::uint64_t last,
                       Found& found) {
  bool same = true;
  for (std::uint64_t tick = first; tick <= last; ++tick) {
    compare_inputs_of(a, b, tick, found);
    same = same && same_record(a, b, tick, "", found);
  }
}

/// Steps both to tick `last`; false where the rest is not the same match any more.
bool compare_ticks(Side& a, Side& b, std::uint64_t last, const DiffOptions& options, Found& found) {
  const std::uint64_t begin = a.match.begin();
  for (std::uint64_t tick = begin + 1; tick <= last; ++tick) {
    compare_inputs_of(a, b, tick, found);
    const WhoSteps stepped = step_both(a, b, tick, found);
    if (stepped == WhoSteps::kOne) return false;
    if (stepped == WhoSteps::kNeither) {
      compare_unstepped(a, b, tick, last, found);
      return true;
    }
    found.ticks = tick - begin;
    if (!same_state(a, b, options.fields, found)) return false;
    const std::string replayed = "; replayed here both are " + hex16(a.simulation.digest());
    if (!same_record(a, b, tick, replayed, found)) return false;
  }
  return true;
}

Found compare(Side& a, Side& b, const DiffOptions& options) {
  Found found;
  if (a.simulation.dimension() != b.simulation.dimension()) {
    found.other = a.match.name + " has " + std::to_string(a.simulation.dimension()) +
                  " dimensions, " + b.match.name + " has " +
                  std::to_string(b.simulation.dimension());
    return found;
  }
  const std::uint64_t begin = a.match.begin();
  if (begin != b.match.begin()) {
    found.other = a.match.name + " begins after tick " + std::to_string(begin) + ", " +
                  b.match.name + " after tick " + std::to_string(b.match.begin());
    return found;
  }
  if (!same_state(a, b, options.fields, found)) return found;
  const std::uint64_t ticks_a = a.match.ticks(b.match.ticks(begin + options.ticks));
  const std::uint64_t ticks_b = b.match.ticks(ticks_a);
  if (!compare_ticks(a, b, std::min(ticks_a, ticks_b), options, found)) return found;
  if (ticks_a != ticks_b) {
    found.note(a.match.name + " has " + std::to_string(ticks_a) + " ticks, " + b.match.name +
               " has " + std::to_string(ticks_b));
  }
  return found;
}

void print_text(const Found& found) {
  if (found.input_tick) {
    std::cout << "inputs first differ at tick " << *found.input_tick << ": " << found.input_text
              << '\n';
  }
  if (found.state_tick) std::cout << "states first differ at tick " << *found.state_tick << '\n';
  for (const solver::Difference& field : found.fields) {
    std::cout << "  " << field.object << ": " << field.field << ": " << field.value_a << " against "
              << field.value_b << '\n';
  }
  if (found.blame && found.blame->at) {
    std::cout << "phases first differ in " << point_text(*found.blame->at);
    for (const solver::Difference& field : found.blame->fields)
      std::cout << ": " << field.object << ": " << field.field;
    std::cout << '\n';
  }
  if (!found.other.empty()) std::cout << found.other << '\n';
  if (!found.any()) std::cout << "equal for " << found.ticks << " ticks\n";
}

Json to_json(const Found& found) {
  Json fields = Json::array();
  for (const solver::Difference& field : found.fields) {
    fields.push_back({{"object", field.object},
                      {"field", field.field},
                      {"a", field.value_a},
                      {"b", field.value_b}});
  }
  Json object = {{"equal", !found.any()},     {"ticks", found.ticks},  {"input_tick", nullptr},
                 {"input", found.input_text}, {"state_tick", nullptr}, {"fields", fields},
                 {"blame", nullptr},          {"other", found.other}};
  if (found.blame) object["blame"] = to_json(*found.blame);
  if (found.input_tick) object["input_tick"] = *found.input_tick;
  if (found.state_tick) object["state_tick"] = *found.state_tick;
  return object;
}

Exit diff(const DiffOptions& options, bool json) {
  Side a = open_side(options.a, options.loading);
  Side b = open_side(options.b, options.loading);
  const Found found = compare(a, b, options);
  const Exit exit = found.any() ? kExitDiverged : std::max(a.match.exit(), b.match.exit());
  if (json) print_json(to_json(found), exit);
  if (!json) print_text(found);
  return exit;
}

}  // namespace

void add_diff(CLI::App& app, Action& action) {
  auto options = std::make_shared<DiffOptions>();
  CLI::App* command = add_command(
      app, "diff", "Step two matches side by side; names the first tick and field that differ",
      action);
  command->add_option("A", options->a, "A log, a scene file or a catalogue name")->required();
  command->add_option("B", options->b, "The same")->required();
  command->add_option("--ticks", options->ticks, "How far to run two scenes")
      ->capture_default_str();
  add_salvage_option(command, options->loading);
  command->add_option("--fields", options->fields, "How many differing fields to name at most")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  command->callback(
      [options, &action] { action.run = [=, &action] { return diff(*options, action.json); }; });
}

}  // namespace cycloid::cli
