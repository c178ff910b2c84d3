#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "cli/sim/chronicle.hpp"
#include "cli/sim/settings.hpp"

namespace cycloid::sim {

/// What a run came to.
struct SimReport {
  std::uint64_t seed = 0;
  std::optional<Violation> violation;
  std::uint64_t digest = 0;     ///< Of all that happened: equal on every platform.
  std::uint64_t confirmed = 0;  ///< Digest of what was confirmed, and of nothing else.
  std::uint64_t ticks = 0;      ///< Confirmed, in all rooms and eras.
  std::int64_t virtual_ns = 0;  ///< How long it was for those in it.
  /// From the end of the faults until all were in sync; nothing where that did not come.
  std::optional<std::int64_t> convergence_ns;
  Chronicle chronicle;  ///< For its counts.

  bool passed() const { return !violation; }
};

/// Told every line of what happens, with the virtual time; may be empty.
using Narrator = std::function<void(std::int64_t now_ns, const std::string& line)>;

/// Plays one seed: rooms, clients, network and disk in one thread and in virtual time; first with
/// faults, then without until all are in sync, then to the end of the match. Ends at the first
/// violation.
/// @pre scene_of(settings.scene) is a scene.
SimReport simulate(const Settings& settings, const Narrator& narrate = {});

}  // namespace cycloid::sim
