#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "client/replica/evidence.hpp"
#include "client/replica/follower.hpp"

namespace cycloid::client {

/// The lockstep mirror: steps its own world by confirmed frames, and by nothing else.
///
/// Compares digests of ticks that it has made. A digest of a tick still to come waits for it
/// (`kDigestsWaitingMax` of them); one of a tick that is gone is not compared. After a mismatch it
/// goes on by frames until the server sends the exact state; a gap between frames ends the session.
class Replica final : public Follower {
 public:
  static constexpr std::size_t kDigestsWaitingMax = 64;

  Replica(scenes::Simulation simulation, FollowerOptions options);

  /// Whether the last compared digest differed and no snapshot has come since.
  bool diverged() const { return diverged_; }

 private:
  void on_snapshot(const protocol::Snapshot& snapshot, Outbox& out) override;
  void on_frame(const protocol::InputFrame& frame, Outbox& out) override;
  void on_digest(const protocol::Digest& digest, Outbox& out) override;
  void on_state_wanted(const protocol::StateWanted& wanted) override;
  void compare_waiting(Outbox& out);

  std::deque<protocol::Digest> waiting_;  ///< Of the server, ticks ascending.
  std::vector<scenes::SeatInput> inputs_;
  bool diverged_ = false;
  Evidence evidence_;
};

}  // namespace cycloid::client
