#include "cli/replaying.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "cli/output.hpp"

namespace cycloid::cli {
namespace {

using protocol::LogCursor;
using LogStep = LogCursor::Step;

/// Between two looks at the clock.
constexpr std::uint64_t kTicksPerLook = 16;

/// A cursor behind the keyframe from which `simulation` goes on; at the start where there is none.
LogCursor begin_at(const LoadedLog& loaded, std::uint64_t from, scenes::Simulation& simulation) {
  const std::uint64_t tick = std::max(from, loaded.log.header.branch_tick);
  const protocol::KeyframePlace* place = loaded.log.keyframe_before(tick);
  if (place == nullptr && loaded.log.header.branch_tick != 0) {
    throw Failure(kExitCorrupt, loaded.file + ": corrupt: no keyframe of tick " +
                                    std::to_string(loaded.log.header.branch_tick));
  }
  if (place == nullptr || tick == 0) return {*loaded.bytes, loaded.log.start};
  LogCursor cursor(*loaded.bytes, loaded.log.start, *place);
  if (cursor.next() != LogStep::kKeyframe)
    throw Failure(kExitCorrupt, loaded.file + ": corrupt: " + cursor.reason());
  take_keyframe(loaded.file, cursor.keyframe(), simulation);
  return cursor;
}

/// @returns how a keyframe is not what the replay has made, or nothing.
std::optional<Divergence> compare_keyframe(const protocol::LogKeyframe& keyframe,
                                           const scenes::Simulation& simulation) {
  const std::uint64_t digest = simulation.digest();
  if (keyframe.digest != digest) return Divergence{keyframe.tick, keyframe.digest, digest};
  std::vector<std::byte> state;
  simulation.encode(state);
  if (state == keyframe.state) return {};
  return Divergence{keyframe.tick, keyframe.digest, digest, "", true};
}

/// Steps once, and writes down the digest. @returns what differs, or nothing.
std::optional<Divergence> step_by(const protocol::LogTick& tick, scenes::Simulation& simulation,
                                  std::vector<scenes::SeatInput>& inputs, std::uint64_t& digest) {
  inputs.clear();
  for (const protocol::SeatFrame& seat : tick.frame.seats) inputs.push_back(seat.input);
  const solver::Error error = simulation.step(inputs);
  digest = simulation.digest();
  if (error.ok() && digest == tick.digest) return {};
  return Divergence{tick.frame.tick, tick.digest, digest, error.ok() ? "" : error_text(error),
                    false};
}

}  // namespace

Replayed replay(const LoadedLog& loaded, const ReplayOptions& options) {
  scenes::Simulation simulation = make_simulation(loaded.scene, options.workers, options.lanes);
  return replay(loaded, options, simulation);
}

Replayed replay(const LoadedLog& loaded, const ReplayOptions& options,
                scenes::Simulation& simulation) {
  LogCursor cursor = begin_at(loaded, options.from, simulation);
  Replayed result;
  result.from = simulation.tick();
  result.digest = simulation.digest();
  const std::uint64_t to = options.to.value_or(loaded.last_tick());
  std::vector<scenes::SeatInput> inputs;
  for (LogStep step = cursor.next(); step != LogStep::kEnd; step = cursor.next()) {
    if (step == LogStep::kKeyframe) {
      result.divergence = compare_keyframe(cursor.keyframe(), simulation);
      if (result.divergence) return result;
      ++result.keyframes;
    }
    // Of a log without ticks, nothing else says what its state was.
    if (step == LogStep::kFooter && cursor.footer().digest != result.digest)
      result.divergence = {cursor.last_tick(), cursor.footer().digest, result.digest};
    if (step != LogStep::kTick) continue;
    if (cursor.tick().frame.tick > to) break;
    result.divergence = step_by(cursor.tick(), simulation, inputs, result.digest);
    if (result.divergence) return result;
    ++result.ticks;
    if (options.on_tick) options.on_tick(result.tick(), result.digest);
    const bool look = options.deadline && result.ticks % kTicksPerLook == 0;
    result.timed_out = look && std::chrono::steady_clock::now() >= *options.deadline;
    if (result.timed_out) return result;
  }
  return result;
}

std::string divergence_text(const Divergence& divergence) {
  const std::string text = "diverged at tick " + std::to_string(divergence.tick) + ": ";
  if (divergence.keyframe)
    return text + "the keyframe in the log is not the state that the replay has made";
  return text + "recorded " + hex16(divergence.recorded) + ", replayed " +
         (divergence.fault.empty() ? hex16(divergence.replayed)
                                   : "nothing, the world does not step: " + divergence.fault);
}

scenes::Simulation make_simulation(const scenes::Scene& scene, int workers, int lanes) {
  auto simulation = scenes::Simulation::create(scene);
  if (!simulation.ok()) {
    throw Failure(kExitCorrupt, "the scene cannot run: " + error_text(simulation.error()));
  }
  if (const solver::Error error = simulation.value().set_workers(workers); !error.ok()) {
    throw Failure(kExitUsage, "--workers: " + error_text(error));
  }
  if (const solver::Error error = simulation.value().set_lanes(lanes); !error.ok()) {
    throw Failure(kExitUsage, "--lanes: " + error_text(error));
  }
  return std::move(simulation.value());
}

void take_keyframe(const std::string& file, const protocol::LogKeyframe& keyframe,
                   scenes::Simulation& simulation) {
  const std::string what =
      file + ": corrupt: the keyframe of tick " + std::to_string(keyframe.tick);
  if (const solver::Error error = simulation.decode(keyframe.state); !error.ok())
    throw Failure(kExitCorrupt, what + " holds no state of the scene: " + error_text(error));
  if (simulation.tick() != keyframe.tick || simulation.digest() != keyframe.digest) {
    throw Failure(kExitCorrupt, what + " holds another state: tick " +
                                    std::to_string(simulation.tick()) + " with digest " +
                                    hex16(simulation.digest()) + ", recorded " +
                                    hex16(keyframe.digest));
  }
}

scenes::Simulation first_state(const LoadedLog& loaded, int workers, int lanes) {
  scenes::Simulation simulation = make_simulation(loaded.scene, workers, lanes);
  (void)begin_at(loaded, 0, simulation);
  return simulation;
}

scenes::Simulation keyframe_state(const LoadedLog& loaded, std::uint64_t tick) {
  scenes::Simulation simulation = make_simulation(loaded.scene, 1);
  (void)begin_at(loaded, tick, simulation);
  return simulation;
}

std::string error_text(const solver::Error& error) {
  return std::string(solver::code_name(error.code)) + " " + error.field;
}

}  // namespace cycloid::cli
