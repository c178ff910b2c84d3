#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "cli/log_file.hpp"

namespace cycloid::cli {

/// As many as a world takes by itself.
inline constexpr int kLanesDefault = 0;  ///< Each step takes the width that suits it.

/// A tick whose digest is not the recorded one.
struct Divergence {
  std::uint64_t tick = 0;
  std::uint64_t recorded = 0;
  std::uint64_t replayed = 0;
  std::string fault = "";  ///< Where the replay could not make the tick at all.
  bool keyframe = false;   ///< The digests are equal, and the state in the log is another.
};

struct Replayed {
  std::uint64_t from = 0;       ///< The tick whose state the replay began with.
  std::uint64_t ticks = 0;      ///< Made and found equal.
  std::uint64_t keyframes = 0;  ///< Found equal.
  std::uint64_t digest = 0;
  std::optional<Divergence> divergence;
  bool timed_out = false;

  std::uint64_t tick() const { return from + ticks; }  ///< The last one that is equal.
};

struct ReplayOptions {
  std::optional<std::uint64_t> to;  ///< Last tick; none: all.
  std::uint64_t from = 0;           ///< Begin at the last keyframe not after this one.
  int workers = 1;
  int lanes = kLanesDefault;
  std::optional<std::chrono::steady_clock::time_point> deadline;
  std::function<void(std::uint64_t tick, std::uint64_t digest)> on_tick;
};

/// Steps the scene by the frames and compares the digest of every tick, keyframe and footer, and
/// the state of every keyframe byte by byte; stops at the first that differs.
Replayed replay(const LoadedLog& loaded, const ReplayOptions& options);
/// The same in up to `jobs` threads, each with a part between two of the log's keyframes: from the
/// state of the first, to that of the second. So that the log is good if all parts are: the replay
/// of each ends, byte by byte, in the state with which the next one begins.
/// @pre options.on_tick is empty: parts would call it in any order.
/// @returns what `replay` returns, of the parts up to the first that does not hold. Where one ran
/// out of time, the first divergence of those behind it, too, or else nothing of them.
Replayed replay_in_parts(const LoadedLog& loaded, const ReplayOptions& options, int jobs);
/// The same, with a simulation that was just made of the log's scene, and is then where it stopped.
Replayed replay(const LoadedLog& loaded, const ReplayOptions& options,
                scenes::Simulation& simulation);

/// "diverged at tick 7: recorded ..., replayed ..."
std::string divergence_text(const Divergence& divergence);

/// A simulation of the scene, or a Failure that says why there is none.
scenes::Simulation make_simulation(const scenes::Scene& scene, int workers,
                                   int lanes = kLanesDefault);

/// Puts a simulation into the state of a keyframe, or a Failure: its digest is the recorded one.
void take_keyframe(const std::string& file, const protocol::LogKeyframe& keyframe,
                   scenes::Simulation& simulation);

/// The state in which a log begins: of its scene, or of its first keyframe.
scenes::Simulation first_state(const LoadedLog& loaded, int workers, int lanes = kLanesDefault);
/// That of the last keyframe not after `tick`, or else the one in which the log begins.
scenes::Simulation keyframe_state(const LoadedLog& loaded, std::uint64_t tick);

/// What a step that failed means: "kFaulted position".
std::string error_text(const solver::Error& error);

}  // namespace cycloid::cli
