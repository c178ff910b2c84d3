#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "protocol/messages.hpp"
#include "server/room/exact_states.hpp"

namespace cycloid::server {

/// The state after a tick as the clients of one profile hold it.
struct ProfiledState {
  std::uint64_t tick = 0;
  std::uint64_t digest = 0;  ///< What StateDelta says for the profile.
  protocol::Bytes bytes;
};

/// How states become the bytes of a StateDelta. Pure functions; called on the room's thread.
class StateCoder {
 public:
  virtual ~StateCoder() = default;
  /// @pre `state` is that of `simulation` as it is.
  virtual ProfiledState capture(protocol::Profile profile, const scenes::Simulation& simulation,
                                const ExactState& state) const = 0;
  /// Nothing where this baseline is of no use; with none (null) it always succeeds.
  virtual std::optional<protocol::Bytes> delta(protocol::Profile profile,
                                               const ProfiledState* baseline,
                                               const ProfiledState& now) const = 0;
};

/// Codes every state whole, as World::encode, for both profiles.
class FullStateCoder final : public StateCoder {
 public:
  ProfiledState capture(protocol::Profile profile, const scenes::Simulation& simulation,
                        const ExactState& state) const override;
  std::optional<protocol::Bytes> delta(protocol::Profile profile, const ProfiledState* baseline,
                                       const ProfiledState& now) const override;
};

/// The snapshots of a room's snapshot clients: each the difference from what its client has
/// acknowledged, made once for all clients with that baseline and profile.
///
/// States that may still be acknowledged are kept for 3 s and within a budget of bytes; who
/// acknowledges none of them is sent the whole state. Source: the rules of DDNet.
class SnapshotFeed {
 public:
  /// @pre `kept_ticks` > 0; the coder outlives the feed.
  SnapshotFeed(const StateCoder& coder, std::size_t bytes_max, std::uint64_t kept_ticks)
      : coder_(coder), bytes_max_(bytes_max), kept_ticks_(kept_ticks) {}

  /// The StateDelta for a client that has acknowledged `baseline_tick` (0: nothing), after the tick
  /// of `state`. The state is kept as a baseline.
  Shared message(protocol::Profile profile, std::uint64_t baseline_tick,
                 const scenes::Simulation& simulation, const ExactState& state);
  /// The client is sent this state by other means, and may acknowledge it.
  void keep(protocol::Profile profile, const scenes::Simulation& simulation,
            const ExactState& state);
  void forget_all();

  std::uint64_t encodes() const { return encodes_; }  ///< Deltas made, whoever got them.
  std::size_t bytes() const { return bytes_; }
  std::size_t baselines() const { return kept_.size(); }

 private:
  struct Kept {
    protocol::Profile profile;
    ProfiledState state;
  };
  const Kept* find(protocol::Profile profile, std::uint64_t tick) const;
  void evict(std::uint64_t now_tick);

  const StateCoder& coder_;
  std::size_t bytes_max_;
  std::uint64_t kept_ticks_;
  std::deque<Kept> kept_;  ///< Ticks ascending.
  std::size_t bytes_ = 0;
  std::uint64_t made_tick_ = 0;  ///< Of `made_`.
  std::map<std::pair<protocol::Profile, std::uint64_t>, Shared> made_;
  std::uint64_t encodes_ = 0;
};

}  // namespace cycloid::server
