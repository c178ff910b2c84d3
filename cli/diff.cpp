#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "cli/commands.hpp"
#include "cli/files.hpp"
#include "cli/log_file.hpp"
#include "cli/output.hpp"

namespace cycloid::cli {
namespace {

struct DiffOptions {
  std::string a;
  std::string b;
  std::uint64_t ticks = 600;
  std::size_t fields = 8;
};

/// One of the two: a log, or a scene that runs by its script.
struct Side {
  std::string name;
  std::optional<LoadedLog> log;
  scenes::Scene scene;
  scenes::Simulation simulation;

  /// @pre There is a log, and 1 <= tick <= ticks().
  const protocol::LogTick& recorded(std::uint64_t tick) const {
    return log->log.ticks[static_cast<std::size_t>(tick - 1)];
  }
  std::uint64_t ticks(std::uint64_t otherwise) const {
    return log ? log->log.ticks.size() : otherwise;
  }
  std::vector<scenes::SeatInput> inputs(std::uint64_t tick) const {
    std::vector<scenes::SeatInput> inputs;
    for (int seat = 0; seat < simulation.seats(); ++seat) {
      inputs.push_back(log ? recorded(tick).frame.seats[std::size_t(seat)].input
                           : scenes::scripted_input(scene, seat, tick));
    }
    return inputs;
  }
};

/// A file is a log when it says so by its name, or when it reads as one.
bool is_log(const std::string& what) {
  if (what.ends_with(".cylog")) return true;
  if (!kind_of(what).is_file) return false;
  return protocol::read_log(read_file(what)).state != protocol::LogState::kCorrupt;
}

Side open_side(const std::string& what) {
  std::optional<LoadedLog> log;
  if (is_log(what)) log = load_log(what);
  scenes::Scene scene = log ? log->scene : load_scene(what);
  scenes::Simulation simulation = make_simulation(scene, 1);
  return {what, std::move(log), std::move(scene), std::move(simulation)};
}

struct Found {
  std::uint64_t ticks = 0;  ///< Compared.
  std::optional<std::uint64_t> input_tick;
  std::string input_text;
  std::optional<std::uint64_t> state_tick;
  std::vector<solver::Difference> fields;
  std::string other;  ///< What else is not the same, in a sentence.

  bool any() const { return input_tick || state_tick || !other.empty(); }
};

/// "seat 1: axes[0]: 100 (0x0064) against -3 (0xfffd)", or "".
std::string input_difference(const std::vector<scenes::SeatInput>& a,
                             const std::vector<scenes::SeatInput>& b) {
  const auto text = [](std::size_t seat, const std::string& field, int x, int y) {
    const auto value = [](int number) {
      return std::to_string(number) + " (0x" + hex16(std::uint64_t(number)).substr(12) + ")";
    };
    return "seat " + std::to_string(seat) + ": " + field + ": " + value(x) + " against " + value(y);
  };
  for (std::size_t seat = 0; seat < std::min(a.size(), b.size()); ++seat) {
    for (std::size_t axis = 0; axis < a[seat].axes.size(); ++axis) {
      if (a[seat].axes[axis] == b[seat].axes[axis]) continue;
      const std::string field = "axes[" + std::to_string(axis) + "]";
      return text(seat, field, a[seat].axes[axis], b[seat].axes[axis]);
    }
    if (a[seat].buttons == b[seat].buttons) continue;
    return text(seat, "buttons", a[seat].buttons, b[seat].buttons);
  }
  return "";
}

/// Whether the states are the same; else notes where they are not.
bool same_state(const Side& a, const Side& b, std::size_t fields, Found& found) {
  if (a.simulation.digest() == b.simulation.digest()) return true;
  found.state_tick = a.simulation.tick();
  found.fields = a.simulation.differences(b.simulation, fields);
  return false;
}

/// Steps both; false where that is the end of the comparison.
bool step_both(Side& a, Side& b, std::uint64_t tick, Found& found) {
  const auto inputs_a = a.inputs(tick);
  const auto inputs_b = b.inputs(tick);
  if (!found.input_tick) {
    found.input_text = input_difference(inputs_a, inputs_b);
    if (!found.input_text.empty()) found.input_tick = tick;
  }
  const solver::Error error_a = a.simulation.step(inputs_a);
  const solver::Error error_b = b.simulation.step(inputs_b);
  if (error_a.ok() && error_b.ok()) return true;
  if (error_a.ok() != error_b.ok()) {
    found.other = "at tick " + std::to_string(tick) + " only " + (error_a.ok() ? b : a).name +
                  " does not step: " + error_text(error_a.ok() ? error_b : error_a);
  }
  return false;
}

/// Where two logs recorded unlike digests for what steps alike here, one was made by another world.
bool same_record(const Side& a, const Side& b, std::uint64_t tick, Found& found) {
  if (!a.log || !b.log) return true;
  const std::uint64_t digest_a = a.recorded(tick).digest;
  const std::uint64_t digest_b = b.recorded(tick).digest;
  if (digest_a == digest_b) return true;
  found.other = "recorded digests differ at tick " + std::to_string(tick) + ": " + hex16(digest_a) +
                " against " + hex16(digest_b) + "; replayed here both are " +
                hex16(a.simulation.digest());
  return false;
}

Found compare(Side& a, Side& b, const DiffOptions& options) {
  Found found;
  if (a.simulation.dimension() != b.simulation.dimension()) {
    found.other = a.name + " has " + std::to_string(a.simulation.dimension()) + " dimensions, " +
                  b.name + " has " + std::to_string(b.simulation.dimension());
    return found;
  }
  if (!same_state(a, b, options.fields, found)) return found;
  const std::uint64_t ticks_a = a.ticks(b.ticks(options.ticks));
  const std::uint64_t ticks_b = b.ticks(ticks_a);
  for (std::uint64_t tick = 1; tick <= std::min(ticks_a, ticks_b); ++tick) {
    if (!step_both(a, b, tick, found)) return found;
    found.ticks = tick;
    if (!same_state(a, b, options.fields, found)) return found;
    if (!same_record(a, b, tick, found)) return found;
  }
  if (ticks_a != ticks_b) {
    found.other = a.name + " has " + std::to_string(ticks_a) + " ticks, " + b.name + " has " +
                  std::to_string(ticks_b);
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
                 {"other", found.other}};
  if (found.input_tick) object["input_tick"] = *found.input_tick;
  if (found.state_tick) object["state_tick"] = *found.state_tick;
  return object;
}

Exit diff(const DiffOptions& options, bool json) {
  Side a = open_side(options.a);
  Side b = open_side(options.b);
  const Found found = compare(a, b, options);
  const Exit exit = found.any() ? kExitDiverged : kExitGood;
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
  command->add_option("--fields", options->fields, "How many differing fields to name at most")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  command->callback(
      [options, &action] { action.run = [=, &action] { return diff(*options, action.json); }; });
}

}  // namespace cycloid::cli
