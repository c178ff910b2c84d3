#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/load/lateness.hpp"
#include "bench/load/load_client.hpp"

namespace cycloid::load {

/// So many clients of one kind.
struct ClientGroup {
  std::string name;  ///< "players"
  int per_room = 0;
  protocol::Mode mode = protocol::Mode::kLockstep;
  protocol::Profile profile = protocol::Profile::kExact;
  Behaviour behaviour = Behaviour::kPlays;
  double after_s = 0.0;  ///< Connects so long after the others.
};

/// A load on one server process.
struct Scenario {
  std::string name;
  std::string what;   ///< A sentence.
  std::string scene;  ///< A catalogue name or "seats:N": a room with so many seats.
  int rooms = 1;
  int threads = 2;
  std::uint32_t snapshot_ticks = 1;
  std::vector<ClientGroup> groups;
};

/// All of them, in the order of the table.
std::vector<Scenario> scenarios();

struct GroupResult {
  std::string name;
  Behaviour behaviour = Behaviour::kPlays;
  protocol::Mode mode = protocol::Mode::kLockstep;
  int clients = 0;
  ClientTally tally;
};

struct ScenarioResult {
  std::string name;
  double seconds = 0.0;          ///< Measured, the warm-up not counted.
  double cpu_percent = 0.0;      ///< Of one core, of the server.
  double resident_mb = 0.0;      ///< Of the server, at the end.
  double ticks = 0.0;            ///< Of all rooms.
  double catch_up_ticks = 0.0;   ///< Ticks that began after another's time: overruns.
  double slowed_ms = 0.0;        ///< By overload, of all rooms.
  double inputs_replaced = 0.0;  ///< As the server counts them: of seats that had spoken.
  double inputs_late = 0.0;      ///< That the server threw away, for their tick had been made.
  double cpu_us_per_tick = 0.0;  ///< Of all that the server does, for each tick of a room.
  double tick_mean_us = 0.0;     ///< To make a tick, without its I/O; by the clock.
  double tick_p99_ms = 0.0;
  double late_p50_ms = 0.0;
  double late_p99_ms = 0.0;
  double late_p999_ms = 0.0;
  double control_p50_ms = 0.0;  ///< A bare timer of the same rate in the same seconds.
  double control_p99_ms = 0.0;
  double control_p999_ms = 0.0;
  double control_max_ms = 0.0;
  int control_behind = 0;  ///< Of its ticks: began in the time of the next, as an overrun does.
  std::vector<Stretch> overruns;
  std::vector<GroupResult> groups;

  /// Overruns of seconds in which the bare timer was in time: those are the server's for sure. Of
  /// the others it is not known, for a server that fills all cores makes a timer late as well.
  double own_overruns() const;
  /// Whether the group's times from input to state are of inputs that were taken. A snapshot client
  /// is not told which were thrown away: of its kind they are only where none was.
  bool inputs_show(const GroupResult& group) const {
    return group.mode == protocol::Mode::kLockstep || inputs_late == 0.0;
  }
};

/// What the server has not held up, in sentences: clients that were refused, lost or never let in,
/// and ticks that began in the time of others, whoever was late.
std::vector<std::string> failures_of(const ScenarioResult& result);

/// Starts the server, connects the clients, waits for the warm-up, measures, ends the server.
/// @param program   `cycloid`.
/// @param realtime  Whether the server asks for real-time threads, `serve --rt`.
ScenarioResult run_scenario(const Scenario& scenario, const std::string& program, double seconds,
                            bool realtime);

}  // namespace cycloid::load
