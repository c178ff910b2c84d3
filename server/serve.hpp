#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>

#include "scenes/catalogue.hpp"
#include "server/host/room_report.hpp"
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
  int threads = 1;        ///< For sockets and ticks; the world's own are `workers`.
  bool realtime = false;  ///< Ask for SCHED_FIFO and locked memory; goes on without.
  /// From a signal to the end of the match, which ends before where nobody is left; 0: at once.
  std::chrono::milliseconds drain{0};
};

/// Runs one room, which a hello may name "main" or not at all, until it is drained, its ticks are
/// over or it cannot go on: a Host with that room alone. Blocks.
///
/// @param on_listening  Told the port, once, before the first tick. May be empty.
/// @throws std::system_error where the address cannot be bound or the log cannot be created, and
/// std::invalid_argument where the scene cannot run.
ServeReport serve(const ServeOptions& options,
                  const std::function<void(std::uint16_t port)>& on_listening,
                  std::stop_token stop = {});

}  // namespace cycloid::server
