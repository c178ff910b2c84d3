#pragma once

#include <cstdint>

#include "client/replica/follower.hpp"

namespace cycloid::client {

/// The snapshot client: never steps; holds the latest exact state that the server sent, for poses
/// and digest, and sends inputs.
///
/// It sees a new tick only with each snapshot, so it sends the inputs of one snapshot interval at a
/// time, and reads its fate only in frames, which a server need not send it.
class Thin final : public Follower {
 public:
  /// Most inputs sent at one snapshot beyond the delay, however far apart snapshots lie.
  static constexpr std::uint64_t kIntervalTicksMax = 60;

  Thin(scenes::Simulation simulation, FollowerOptions options);

 private:
  void on_snapshot(const protocol::Snapshot& snapshot, Outbox& out) override;
  void on_frame(const protocol::InputFrame& frame, Outbox& out) override;
  void on_digest(const protocol::Digest& digest, Outbox& out) override;
};

}  // namespace cycloid::client
