#include "cli/sim/chronicle.hpp"

namespace cycloid::sim {

const char* invariant_name(Invariant invariant) {
  static constexpr std::array<const char*, static_cast<std::size_t>(Invariant::kCount)> kNames = {
      "frames",  "digests",  "inputs",   "seats", "queues",  "log",
      "honesty", "refusals", "deadline", "delay", "liveness"};
  return kNames[static_cast<std::size_t>(invariant)];
}

const char* event_name(Event event) {
  static constexpr std::array<const char*, static_cast<std::size_t>(Event::kCount)> kNames = {
      "connections",    "welcomes",      "refusals",        "one-byte segments",
      "coalesced",      "stalls",        "blackholes",      "resets",
      "half-closes",    "zero windows",  "duplicates",      "storms",
      "garbage",        "bit flips",     "leaves",          "desyncs",
      "resyncs",        "server pauses", "kills",           "power cuts",
      "restarts",       "short writes",  "interrupted",     "write errors",
      "disk full",      "sync errors",   "disk stalls",     "flips on read",
      "log verified",   "rotations",     "slow dropped",    "tokens shown",
      "seats resumed",  "states kept",   "quantised shown", "rewinds",
      "ticks seen late"};
  return kNames[static_cast<std::size_t>(event)];
}

}  // namespace cycloid::sim
