#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "client/replica/follower.hpp"

namespace cycloid::client {

/// The snapshot client: never steps; holds the latest state that the server sent, for poses and
/// digest, and sends inputs.
///
/// States come whole or as deltas against one that it has acknowledged; it acknowledges each that
/// it takes in, and keeps those that the server may still build on. A delta of a baseline that is
/// not held is dropped and not acknowledged, so that the server goes on from an older one. It sees
/// a new tick only with each state, so it sends the inputs of one interval at a time, and reads
/// their fate only in frames, which a server need not send it.
class Thin final : public Follower {
 public:
  /// Most inputs sent at one state beyond the lead, however far apart states lie.
  static constexpr std::uint64_t kIntervalTicksMax = 60;
  /// States kept as baselines.
  static constexpr std::size_t kBaselinesMax = 64;

  Thin(scenes::Simulation simulation, FollowerOptions options);

  std::vector<scenes::Pose> poses() const override;
  /// As the server said it, where the state is quantised.
  std::uint64_t digest() const override;
  std::size_t baselines() const { return baselines_.size(); }

 private:
  void on_exact(const protocol::Snapshot& state, Outbox& out) override;
  void on_frame(const protocol::InputFrame& frame, Outbox& out) override;
  void on_digest(const protocol::Digest& digest, Outbox& out) override;
  void on_delta(const protocol::StateDelta& delta, Outbox& out) override;
  void on_rewound(std::uint64_t tick) override;

  bool is_newer(std::uint64_t tick);
  const DecodedState* find_baseline(std::uint64_t tick) const;
  void keep(DecodedState state, Outbox& out);

  std::deque<DecodedState> baselines_;  ///< Acknowledged, ticks ascending.
  bool quantised_ = false;              ///< Whether the newest one is.
  std::uint64_t quantised_digest_ = 0;
};

}  // namespace cycloid::client
