#include "cli/match.hpp"

#include <algorithm>
#include <utility>

#include "cli/files.hpp"
#include "cli/output.hpp"

namespace cycloid::cli {

std::vector<scenes::SeatInput> Match::inputs(std::uint64_t tick, int seats) const {
  std::vector<scenes::SeatInput> inputs;
  if (log) {
    for (const protocol::SeatFrame& seat :
         log->log.ticks[static_cast<std::size_t>(tick - 1)].frame.seats)
      inputs.push_back(seat.input);
    return inputs;
  }
  for (int seat = 0; seat < seats; ++seat)
    inputs.push_back(scenes::scripted_input(scene, seat, tick));
  return inputs;
}

/// A file is a log when it says so by its name, or when it reads as one.
static bool is_log(const std::string& what) {
  if (what.ends_with(".cylog")) return true;
  if (!kind_of(what).is_file) return false;
  return protocol::read_log(read_file(what)).state != protocol::LogState::kCorrupt;
}

Match open_match(const std::string& what) {
  std::optional<LoadedLog> log;
  if (is_log(what)) log = load_log(what);
  scenes::Scene scene = log ? log->scene : load_scene(what);
  return {what, std::move(log), std::move(scene)};
}

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

static scenes::Simulation start(const Match& match, const StepSetting& setting) {
  scenes::Simulation simulation = make_simulation(match.scene, setting.workers);
  if (const solver::Error error = simulation.set_lanes(setting.lanes); !error.ok())
    throw Failure(kExitUsage, "--lanes: " + error_text(error));
  return simulation;
}

Course run_course(const Match& match, std::uint64_t ticks, const StepSetting& setting) {
  scenes::Simulation simulation = start(match, setting);
  Course course;
  course.digests.push_back(simulation.digest());
  for (std::uint64_t tick = 1; tick <= ticks && course.fault.empty(); ++tick) {
    const solver::Error error = simulation.step(match.inputs(tick, simulation.seats()));
    if (!error.ok()) course.fault = error_text(error);
    course.digests.push_back(simulation.digest());
  }
  return course;
}

TickTrace trace_tick(const Match& match, std::uint64_t tick, const TraceDetail& detail,
                     const StepSetting& setting) {
  if (tick > match.ticks(tick)) {
    throw Failure(kExitUsage, "--tick: " + match.name + " has only " +
                                  std::to_string(match.ticks(tick)) + " ticks");
  }
  scenes::Simulation simulation = start(match, setting);
  solver::StepTrace trace;
  trace.wants_objects = detail.objects;
  trace.wants_fields = detail.object;
  TickTrace traced;
  if (tick == 0) simulation.trace_state(trace);
  for (std::uint64_t now = 1; now <= tick; ++now) {
    const auto inputs = match.inputs(now, simulation.seats());
    const solver::Error error =
        now == tick ? simulation.step_traced(inputs, trace) : simulation.step(inputs);
    if (error.ok()) continue;
    traced.fault = error_text(error);
    if (now < tick) {
      throw Failure(kExitDiverged, match.name + ": the world does not step to tick " +
                                       std::to_string(now) + ": " + traced.fault);
    }
  }
  traced.digest = simulation.digest();
  traced.phases = std::move(trace.phases);
  return traced;
}

}  // namespace cycloid::cli
