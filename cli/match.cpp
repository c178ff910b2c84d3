#include "cli/match.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "cli/output.hpp"

namespace cycloid::cli {

std::uint64_t Match::stepped_to(std::optional<std::uint64_t> count) const {
  if (log && !count) return log->last_tick();
  const std::uint64_t count_max = std::numeric_limits<std::uint64_t>::max() - begin();
  const std::uint64_t wanted = begin() + std::min(count.value_or(kScriptTicks), count_max);
  return std::min(ticks(wanted), wanted);
}

std::vector<scenes::SeatInput> Match::inputs(std::uint64_t tick, int seats) const {
  std::vector<scenes::SeatInput> inputs;
  if (log) {
    for (const protocol::SeatFrame& seat : reader->at(tick).frame.seats)
      inputs.push_back(seat.input);
    return inputs;
  }
  for (int seat = 0; seat < seats; ++seat)
    inputs.push_back(scenes::scripted_input(scene, seat, tick));
  return inputs;
}

std::uint64_t Match::recorded_digest(std::uint64_t tick) const {
  return reader->at(tick).digest;
}

scenes::Simulation Match::start(const StepSetting& setting) const {
  return log ? first_state(*log, setting.workers, setting.lanes)
             : make_simulation(scene, setting.workers, setting.lanes);
}

Match open_match(const std::string& what, const LoadOptions& options) {
  const bool is_log = what.ends_with(".cylog") || is_log_file(what);
  if (!is_log) return {what, {}, load_scene(what), nullptr};
  LoadedLog log = load_log(what, options);
  print_blemish(log);
  auto reader = std::make_shared<TickReader>(log);
  scenes::Scene scene = log.scene;
  return {what, std::move(log), std::move(scene), std::move(reader)};
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

Course run_course(const Match& match, std::uint64_t ticks, const StepSetting& setting) {
  scenes::Simulation simulation = match.start(setting);
  Course course;
  course.begin = match.begin();
  course.digests.push_back(simulation.digest());
  for (std::uint64_t tick = course.begin + 1; tick <= ticks && course.fault.empty(); ++tick) {
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
  if (tick < match.begin()) {
    throw Failure(kExitUsage,
                  "--tick: " + match.name + " begins after tick " + std::to_string(match.begin()));
  }
  scenes::Simulation simulation = match.start(setting);
  solver::StepTrace trace;
  trace.wants_objects = detail.objects;
  trace.wants_fields = detail.object;
  TickTrace traced;
  if (tick == match.begin()) simulation.trace_state(trace);
  for (std::uint64_t now = match.begin() + 1; now <= tick; ++now) {
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
