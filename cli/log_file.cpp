#include "cli/log_file.hpp"

#include <utility>
#include <vector>

#include "cli/output.hpp"

namespace cycloid::cli {

using protocol::LogState;

std::string LoadedLog::blemish() const {
  if (log.state == LogState::kComplete) return "";
  const char* name = log.state == LogState::kOpen ? "not closed" : "torn";
  return std::string(name) + " after " + std::to_string(log.ticks.size()) + " good ticks" +
         (log.reason.empty() ? "" : ": " + log.reason);
}

LoadedLog load_log(const std::string& file) {
  return parse_log(file, read_file(file));
}

LoadedLog parse_log(const std::string& file, std::span<const std::byte> bytes) {
  protocol::Log log = protocol::read_log(bytes);
  if (log.state == LogState::kCorrupt)
    throw Failure(kExitCorrupt, file + ": corrupt: " + log.reason);
  if (log.state == LogState::kIncompatible) {
    throw Failure(kExitIncompatible, file + ": incompatible: " + log.reason);
  }
  std::uint64_t expected = 1;
  for (const protocol::LogTick& tick : log.ticks) {
    if (tick.frame.tick == expected++) continue;
    throw Failure(kExitCorrupt, file + ": corrupt: tick " + std::to_string(tick.frame.tick) +
                                    " instead of " + std::to_string(expected - 1));
  }
  scenes::Loaded loaded = scenes::from_binary(log.header.scene);
  if (!loaded.scene) throw Failure(kExitCorrupt, mistakes_text(file + ": scene", loaded.mistakes));
  const std::uint64_t digest = scenes::scene_digest(*loaded.scene);
  if (digest != log.header.scene_digest) {
    throw Failure(kExitIncompatible, file + ": the scene's digest is " + hex16(digest) +
                                         " here, the log says " + hex16(log.header.scene_digest));
  }
  return {file, std::move(log), std::move(*loaded.scene)};
}

LogWriter::LogWriter(std::string file, const scenes::Scene& scene)
    : file_(std::move(file)), stream_(file_, std::ios::binary | std::ios::trunc) {
  if (!stream_) throw Failure(kExitIo, file_ + ": cannot be written");
  protocol::LogHeader header;
  header.scene_digest = scenes::scene_digest(scene);
  header.salt = header.scene_digest;  // The same run writes the same bytes.
  header.scene_name = scene.name;
  header.scene = scenes::to_binary(scene);
  encoder_.emplace(header, bytes_);
}

void LogWriter::tick(const protocol::LogTick& tick) {
  encoder_->tick(tick, bytes_);
  write();
}

void LogWriter::finish(const protocol::LogFooter& footer) {
  encoder_->footer(footer, bytes_);
  write();
  stream_.close();
  if (!stream_) throw Failure(kExitIo, file_ + ": cannot be written");
}

void LogWriter::write() {
  stream_.write(reinterpret_cast<const char*>(bytes_.data()),
                static_cast<std::streamsize>(bytes_.size()));
  if (!stream_) throw Failure(kExitIo, file_ + ": cannot be written");
  bytes_.clear();
}

Replayed replay(const LoadedLog& loaded, const ReplayOptions& options) {
  scenes::Simulation simulation = make_simulation(loaded.scene, options.workers, options.lanes);
  Replayed result;
  result.digest = simulation.digest();
  std::vector<scenes::SeatInput> inputs;
  for (const protocol::LogTick& tick : loaded.log.ticks) {
    if (options.to != 0 && tick.frame.tick > options.to) break;
    inputs.clear();
    for (const protocol::SeatFrame& seat : tick.frame.seats) inputs.push_back(seat.input);
    const solver::Error error = simulation.step(inputs);
    result.digest = simulation.digest();
    if (!error.ok() || result.digest != tick.digest) {
      result.divergence = {tick.frame.tick, tick.digest, result.digest,
                           error.ok() ? "" : error_text(error)};
      return result;
    }
    result.ticks = tick.frame.tick;
    if (options.on_tick) options.on_tick(result.ticks, result.digest);
  }
  return result;
}

std::string divergence_text(const Divergence& divergence) {
  return "diverged at tick " + std::to_string(divergence.tick) + ": recorded " +
         hex16(divergence.recorded) + ", replayed " +
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

std::string error_text(const solver::Error& error) {
  return std::string(solver::code_name(error.code)) + " " + error.field;
}

}  // namespace cycloid::cli
