#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "cli/sim/disk.hpp"
#include "cli/sim/pipe.hpp"
#include "cli/sim/plant.hpp"
#include "cli/sim/random.hpp"
#include "scenes/scene.hpp"
#include "server/admission/gate.hpp"
#include "server/log/log_writer.hpp"
#include "server/room/options.hpp"

namespace cycloid::sim {

/// What connections of a run may suffer. Each draws its own faults within these.
struct NetworkSettings {
  std::int64_t latency_max_ns = 20 * kMillisecond;
  std::int64_t jitter_max_ns = 0;
  std::uint64_t bytes_per_s_min = 0;  ///< 0: no connection is narrow.
  std::uint32_t segment_bytes_max = 1460;
  bool ragged = false;  ///< Segments of any length up to that.
  bool coalesces = false;
  std::uint32_t stall_per_million = 0;
  std::int64_t stall_max_ns = 0;
  std::uint32_t flip_per_million = 0;       ///< Of a segment, of a connection that flips.
  std::uint32_t flipping_per_million = 0;   ///< Of a connection: it flips bits.
  std::uint32_t blackhole_per_million = 0;  ///< Of a connection and direction.
  std::uint32_t reset_per_million = 0;      ///< Of a connection.
  std::size_t capacity_bytes = 262144;
};

/// What honest clients do beside playing. Chances are of a connection.
struct ClientSettings {
  std::int32_t drift_max_ppm = 0;  ///< Of their clocks.
  std::int64_t ping_ns = 500 * kMillisecond;
  std::int64_t silence_ns = 3 * kSecond;
  std::uint32_t zero_window_per_million = 0;  ///< It reads nothing for a while.
  std::int64_t zero_window_max_ns = 0;
  std::uint32_t half_close_per_million = 0;
  std::uint32_t leave_per_million = 0;
  std::uint32_t duplicate_per_million = 0;  ///< Connects again and leaves the first one open.
  std::uint32_t desync_per_million = 0;     ///< A bit of its world is the other one.
  std::uint32_t storms = 0;  ///< Times in a run that all connections end at once and all come back.
};

struct ServerSettings {
  std::uint32_t pauses = 0;  ///< Times in a run that the process is not run.
  std::int64_t pause_max_ns = 0;
  std::uint32_t deaths = 0;         ///< Times in a run that it is killed at any moment.
  std::uint32_t power_cuts_of = 0;  ///< Of a million deaths, how many are of the whole machine.
  server::LogSync log = server::LogSync::kInterval;
  std::int64_t sync_interval_ns = 100 * kMillisecond;
  std::size_t log_queue_bytes_max = std::size_t{1} << 20;
  bool stop_on_log_error = false;
  std::uint64_t keyframe_ticks = 100;  ///< Between two states in the log.
  std::uint32_t rewinds = 0;           ///< Times in a run that every match goes back.
  std::uint32_t rotations = 0;         ///< Times in a run that every log goes on in another file.
  server::TokenPolicy tokens = server::TokenPolicy::kIgnored;
  bool gives_resume_secrets = false;  ///< Good for `limits.resume`.
};

/// All that a run depends on.
struct Settings {
  std::uint64_t seed = 0;
  std::uint64_t ticks = 600;  ///< Of the phase with faults.
  std::string scene;          ///< "tiny", or of the catalogue.
  std::uint32_t rooms = 1;
  std::uint32_t players = 2;  ///< Of a room, at most its seats.
  std::uint32_t spectators = 0;
  std::uint64_t spectator_delay_ticks = 0;  ///< By which they see the match late.
  std::uint32_t hostiles = 0;       ///< Of a room: peers that are refused, whatever they try.
  std::uint32_t troublemakers = 0;  ///< Of a room: peers that are let in, and then break the rules.
  std::uint32_t snapshots_of_million = 0;  ///< Of clients, how many are fed snapshots.
  std::uint32_t quantised_of_million = 0;  ///< Of those, how many with the quantised profile.
  bool any_seat = false;                   ///< Players take any seat, not one of their own.
  std::uint32_t tick_rate_millihertz = 60000;
  server::Limits limits;
  NetworkSettings network;
  ClientSettings client;
  ServerSettings server;
  DiskFaults disk;
  Plant plant = Plant::kNone;
};

/// Draws the settings of a seed: many faults off in each, some extreme. docs/server.md has the
/// ranges.
Settings draw_settings(std::uint64_t seed);

/// A floor, three bodies and three seats that push them: cheap, and everything touches.
scenes::Scene tiny_scene();
/// "tiny", or what scenes::load finds. @returns nothing where there is no such scene.
std::optional<scenes::Scene> scene_of(const std::string& name);

}  // namespace cycloid::sim
