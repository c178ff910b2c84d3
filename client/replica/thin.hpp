#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "client/replica/follower.hpp"
#include "protocol/state/received_states.hpp"

namespace cycloid::client {

/// The snapshot client: never steps; holds the latest state that the server sent, for poses and
/// digest, and sends inputs.
///
/// States come whole or as deltas against one that it has acknowledged; it acknowledges each that
/// it takes in, and keeps those that the server may still build on, within
/// FollowerOptions::baselines_bytes_max. A delta of a baseline that is not held is dropped and not
/// acknowledged: the server goes on from a newer one once it hears of that. It sees a new tick only
/// with each state, so it sends the inputs of one interval at a time, and reads their fate only in
/// frames, which a server need not send it.
class Thin final : public Follower {
 public:
  /// Most inputs sent at one state beyond the lead, however far apart states lie.
  static constexpr std::uint64_t kIntervalTicksMax = 60;
  /// States kept as baselines: as many as a server may have sent without an answer, and the one
  /// that it builds on.
  static constexpr std::size_t kBaselinesMax = protocol::SentStates::kSentMax + 1;

  Thin(scenes::Simulation simulation, FollowerOptions options);

  std::vector<scenes::Pose> poses() const override;
  /// As the server said it, where the state is quantised.
  std::uint64_t digest() const override;
  std::size_t baselines() const { return states_.states(); }

 private:
  void on_exact(const protocol::Snapshot& state, Outbox& out) override;
  void on_frame(const protocol::InputFrame& frame, Outbox& out) override;
  void on_digest(const protocol::Digest& digest, Outbox& out) override;
  void on_delta(const protocol::StateDelta& delta, Outbox& out) override;
  void on_rewound(std::uint64_t tick) override;

  bool is_newer(std::uint64_t tick);
  void take_exact(const protocol::StateDelta& delta, Outbox& out);
  void took(std::uint64_t tick, std::uint64_t interval, Outbox& out);

  protocol::ReceivedStates states_;  ///< Acknowledged; of the profile that was asked for.
  bool quantised_ = false;           ///< Whether the newest one came quantised.
  std::uint64_t quantised_digest_ = 0;
  protocol::QuantisedState before_rewind_;  ///< Shown while no state has come since.
};

}  // namespace cycloid::client
