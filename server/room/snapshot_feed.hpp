#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>

#include "protocol/state/state_feed.hpp"
#include "server/room/exact_states.hpp"

namespace cycloid::server {

struct SnapshotFeedLimits {
  std::size_t delta_bytes_max = 1200;  ///< Of a quantised one; an exact one is as large as it is.
  std::size_t baseline_bytes_max = 4096;  ///< Of all states that may be differed from.
  std::uint64_t baseline_ticks_max = 180;
};

/// The snapshots of a room's snapshot clients: each the difference from what its client has
/// acknowledged, made once for all clients with that baseline and profile.
class SnapshotFeed {
 public:
  explicit SnapshotFeed(const SnapshotFeedLimits& limits);

  /// The StateDelta for a client after the simulation's tick, noted in `sent`. Null, and nothing is
  /// noted, where the client holds all that it would show, unless it `speaks`: it does so for the
  /// ticks that it hears of.
  Shared message(protocol::Profile profile, protocol::SentStates& sent, bool speaks,
                 const scenes::Simulation& simulation, std::uint64_t digest);
  /// The client is sent the exact state by other means, and may acknowledge it.
  void hold(protocol::Profile profile, protocol::SentStates& sent,
            const scenes::Simulation& simulation, std::uint64_t digest);
  /// After a rewind: ticks come again, with other states.
  void forget_all();

  std::uint64_t encodes() const;  ///< Deltas made, whoever got them.

 private:
  struct Made {
    std::shared_ptr<const protocol::FeedDelta> delta;
    Shared bytes;
  };
  /// The states of one profile.
  struct Channel {
    explicit Channel(const protocol::FeedOptions& options) : states(options) {}
    void advance(const scenes::Simulation& simulation, std::uint64_t digest);

    protocol::StateFeed states;
    bool has_tick = false;
    std::uint64_t tick = 0;  ///< Of `made`.
    std::map<const protocol::FeedDelta*, Made> made;
  };
  Channel& channel(protocol::Profile profile) {
    return profile == protocol::Profile::kExact ? exact_ : quantised_;
  }

  Channel exact_;
  Channel quantised_;
};

/// A StateDelta from nothing that holds an exact state whole.
Shared whole_state_delta(const ExactState& state);

}  // namespace cycloid::server
