#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "scenes/scene.hpp"
#include "server/log/log_writer.hpp"
#include "server/room/options.hpp"

namespace cycloid::server {

/// All that a room is made of.
struct RoomSettings {
  scenes::Scene scene;
  std::string scene_name;  ///< As it is written into the log.
  /// Ticks in 1000 s; 0: those of the scene. Changes how fast the match goes, and no bit of it.
  std::uint32_t tick_rate_millihertz = 0;
  std::uint64_t ticks = 0;  ///< Close the match after so many; 0: never.
  int workers = 1;
  std::string log;            ///< Path of the input log, which must not exist yet; "": none.
  std::string log_directory;  ///< Where `log` is "": a new file in here for each room; "": none.
  LogSync log_sync = LogSync::kInterval;
  bool stop_on_log_error = false;  ///< Else the match goes on, and says that it is not durable.
  std::chrono::milliseconds empty_ttl{0};  ///< Without clients for so long it ends; 0: never.
  Limits limits;
  InputPolicy policy;
  SlowPeer slow = SlowPeer::kReplace;
  DelayPolicy delay;
  std::uint64_t spectator_delay_ticks = 0;
};

/// What rooms may be made of on demand.
struct RoomTemplate {
  RoomSettings settings;
  bool on_first_join = false;  ///< A hello that names "TEMPLATE:NAME" makes the room.
};

/// "", or why this is no name of a room: 1 to 64 letters, digits and "-_.:" of ASCII.
std::string room_name_mistake(const std::string& name);

}  // namespace cycloid::server
