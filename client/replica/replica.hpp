#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "client/replica/follower.hpp"
#include "client/replica/predictor.hpp"

namespace cycloid::client {

/// The lockstep mirror: its confirmed state is made by confirmed frames, and by nothing else.
///
/// An exact state may come in parts while frames go on: they wait for it (`frames_waiting_max`),
/// and once it is whole they are stepped at once. Compares digests of confirmed ticks. A digest of
/// a tick still to come waits for it (`kDigestsWaitingMax` of them); one of a tick that is gone is
/// not compared. After a mismatch it goes on by frames until the server's exact state is whole; a
/// gap between frames ends the session, unless an exact state that is on its way fills it.
class Replica final : public Follower {
 public:
  static constexpr std::size_t kDigestsWaitingMax = 64;
  /// Frames kept behind the confirmed tick, for an exact state that was on its way for so long.
  static constexpr std::size_t kFramesKept = 1024;
  /// Inputs sent at one frame: one, or a few where the lead has grown.
  static constexpr std::uint64_t kBurst = 4;

  Replica(scenes::Simulation simulation, FollowerOptions options);

  /// Whether the last compared digest differed and no exact state has come since.
  bool diverged() const { return diverged_; }
  /// Null where nothing is predicted.
  const Predictor* predictor() const { return predictor_.get(); }
  void settle() override;
  bool advance(Outbox& out) override;
  std::uint64_t digest() const override;
  bool keep(scenes::Simulation::Saved& into) const override;

 private:
  void on_exact(const protocol::Snapshot& state, Outbox& out) override;
  void on_frame(const protocol::InputFrame& frame, Outbox& out) override;
  void on_digest(const protocol::Digest& digest, Outbox& out) override;
  void on_delta(const protocol::StateDelta& delta, Outbox& out) override;
  void on_rewound(std::uint64_t tick) override;
  void on_seated() override;
  void on_kept() override;
  void on_said(std::uint64_t tick, const scenes::SeatInput& input) override;

  bool can_follow(std::uint64_t tick);
  void skip_to_state_before(std::uint64_t tick);
  bool step(const protocol::InputFrame& frame, Outbox& out);
  void witness_confirmed();
  void witness_leaving(Outbox& out);
  void compare_waiting(Outbox& out);

  std::unique_ptr<Predictor> predictor_;
  std::deque<protocol::InputFrame> frames_;  ///< The last ones, without a gap.
  std::uint64_t newest_tick_ = 0;            ///< Of the last frame, or of the state without any.
  std::uint64_t counted_tick_ = 0;           ///< Frames up to here were told and counted.
  std::deque<protocol::Digest> waiting_;     ///< Of the server, ticks ascending.
  std::vector<scenes::SeatInput> inputs_;
  bool diverged_ = false;
  bool went_back_ = false;  ///< The match has, and the exact state has not come yet.
};

}  // namespace cycloid::client
