#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/replaying.hpp"
#include "solver/trace.hpp"

namespace cycloid::cli {

/// How far a scene by its script is stepped where nobody says.
inline constexpr std::uint64_t kScriptTicks = 600;

/// How a match is stepped; changes no bit.
struct StepSetting {
  int workers = 1;
  int lanes = kLanesDefault;
};

/// A match that can be stepped any number of times: a scene by the frames of a log, or by its
/// script.
struct Match {
  std::string name;
  std::optional<LoadedLog> log;
  scenes::Scene scene;

  /// Ticks made before it begins: those before the first of a log that was cut or branched.
  std::uint64_t begin() const { return log ? log->first_tick() - 1 : 0; }
  /// Its last tick; a scene by its script has no end.
  std::uint64_t ticks(std::uint64_t otherwise) const { return log ? log->last_tick() : otherwise; }
  /// The tick `count` ticks after the beginning, or the last of a log that has none; where no
  /// number is given, the last of a log, and of a scene by its script kScriptTicks.
  std::uint64_t stepped_to(std::optional<std::uint64_t> count) const;
  /// Those of the log's frame, or what the script says for so many seats. Not for two threads.
  /// @pre begin() < tick <= ticks(tick)
  std::vector<scenes::SeatInput> inputs(std::uint64_t tick, int seats) const;
  /// The digest in the log. @pre there is a log, and begin() < tick <= ticks(tick)
  std::uint64_t recorded_digest(std::uint64_t tick) const;
  /// Of a command that has found nothing else: that of the log.
  Exit exit() const { return log ? log->exit() : kExitGood; }
  /// The world as it was made, or as the log goes on from.
  scenes::Simulation start(const StepSetting& setting) const;

  std::shared_ptr<TickReader> reader;  ///< Of the log.
};

/// A log, a scene file or a catalogue name; a Failure says what is wrong with it. Of a log that has
/// lost its end that is said on stderr: see `exit`.
Match open_match(const std::string& what, const LoadOptions& options = {});

/// The first difference of two ticks' inputs as "seat 1: axes[0]: 100 (0x0064) against -3
/// (0xfffd)", or "".
std::string input_difference(const std::vector<scenes::SeatInput>& a,
                             const std::vector<scenes::SeatInput>& b);

/// A match from its beginning on: the digest after every tick.
struct Course {
  std::uint64_t begin = 0;             ///< As of the match.
  std::vector<std::uint64_t> digests;  ///< Of tick `begin`, as the world was made, and those after.
  std::string fault;  ///< Why the tick of the last digest could not be made, or "".

  /// @pre there is a digest
  std::uint64_t last_tick() const { return begin + digests.size() - 1; }
  /// @pre begin <= tick <= last_tick()
  std::uint64_t at(std::uint64_t tick) const {
    return digests[static_cast<std::size_t>(tick - begin)];
  }
};

/// One tick, phase by phase.
struct TickTrace {
  std::uint64_t digest = 0;  ///< Of the state after it.
  std::string fault;         ///< Why it could not be made, or "".
  std::vector<solver::TracedPhase> phases;
};

/// What a TickTrace is to hold besides the digest of every phase.
struct TraceDetail {
  bool objects = false;
  std::string object;  ///< Whose fields, such as "contact 7".
};

/// Steps as far as tick `ticks`, or to the tick that cannot be made.
Course run_course(const Match& match, std::uint64_t ticks, const StepSetting& setting);

/// Steps to `tick` and traces it; tick 0 is the world as it was made. A Failure where the match
/// does not come so far.
TickTrace trace_tick(const Match& match, std::uint64_t tick, const TraceDetail& detail,
                     const StepSetting& setting);

}  // namespace cycloid::cli
