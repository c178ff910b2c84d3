#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>

#include "scenes/catalogue.hpp"
#include "server/log/log_writer.hpp"
#include "server/room/options.hpp"

namespace cycloid::server {

struct ServeOptions {
  scenes::Scene scene;
  std::string scene_name;  ///< As it is written into the log.
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;  ///< 0: any; `on_listening` is told which.
  /// Ticks in 1000 s; 0: those of the scene. Changes how fast the match goes, and no bit of it.
  std::uint32_t tick_rate_millihertz = 0;
  std::uint64_t ticks = 0;  ///< Close the match after so many; 0: never.
  int workers = 1;
  std::string log;  ///< Path of the input log, which must not exist yet; "": none.
  LogSync log_sync = LogSync::kInterval;
  bool stop_on_log_error = false;  ///< Else the match goes on and says that it is not durable.
  bool catch_signals = true;       ///< SIGINT and SIGTERM drain; a second one ends at once.
  Limits limits;
};

enum class End : std::uint8_t {
  kDrained,   ///< By a signal or the stop token.
  kTicks,     ///< All wanted ticks were made.
  kFaulted,   ///< The world entered its fault state.
  kLogError,  ///< The log could not be written and `stop_on_log_error` was set.
};

const char* end_name(End end);

struct ServeReport {
  End end = End::kDrained;
  std::string reason;
  std::uint64_t ticks = 0;
  std::uint64_t final_digest = 0;
  std::uint64_t worst_tick_ns = 0;    ///< Longest time of one tick: step, digest and encoding.
  std::uint64_t lateness_p99_ns = 0;  ///< From a tick's deadline to its start; an upper bound.
  std::uint64_t bytes_in = 0;
  std::uint64_t bytes_out = 0;
  std::uint64_t desyncs = 0;
  std::uint64_t clients = 0;   ///< Hellos that were welcomed.
  std::uint64_t refusals = 0;  ///< Connections that were told Refused.
  std::uint64_t inputs_late = 0;
  std::uint64_t slowed_ns = 0;  ///< Time by which overload put the match behind the clock.
  bool durable = true;          ///< Whether the log, where there is one, holds all ticks.

  bool good() const { return end == End::kDrained || end == End::kTicks; }
  /// 0 when `good`, else 1.
  int exit_code() const { return good() ? 0 : 1; }
};

/// Runs one room until it is drained, its ticks are over or it cannot go on. Blocks; single thread
/// for the network and the world, another for the log.
///
/// @param on_listening  Told the port, once, before the first tick. May be empty.
/// @throws std::system_error where the address cannot be bound or the log cannot be created, and
/// std::invalid_argument where the scene cannot run.
ServeReport serve(const ServeOptions& options,
                  const std::function<void(std::uint16_t port)>& on_listening,
                  std::stop_token stop = {});

}  // namespace cycloid::server
