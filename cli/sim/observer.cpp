#include "cli/sim/observer.hpp"

#include <variant>

namespace cycloid::sim {

void Observer::heard(const protocol::ServerMessage& message) {
  if (excused_) return;
  if (const auto* frame = std::get_if<protocol::InputFrame>(&message)) return on_frame(*frame);
  if (const auto* snapshot = std::get_if<protocol::Snapshot>(&message)) {
    return on_exact_state(snapshot->tick);
  }
  if (const auto* part = std::get_if<protocol::SnapshotPart>(&message)) {
    if (part->offset == 0) on_exact_state(part->tick);
  }
  if (const auto* digest = std::get_if<protocol::Digest>(&message)) {
    const protocol::LogTick* confirmed = ledger_->at(digest->tick);
    const bool first = digest->tick == 0;
    if (!first && (confirmed == nullptr || confirmed->digest != digest->digest)) {
      wrong(Invariant::kDigests,
            "heard a digest of tick " + std::to_string(digest->tick) + " that is not the server's");
    }
  }
  if (const auto* welcome = std::get_if<protocol::Welcome>(&message)) {
    welcomed_ = true;
    last_frame_ = welcome->tick;
    exact_tick_ = welcome->tick;
  }
}

void Observer::on_exact_state(std::uint64_t tick) {
  if (tick > ledger_->ticks()) {
    wrong(Invariant::kFrames,
          "heard a state of tick " + std::to_string(tick) + ", which is not confirmed");
  }
  exact_tick_ = tick;
}

void Observer::on_frame(const protocol::InputFrame& frame) {
  const std::string name = "the frame of tick " + std::to_string(frame.tick);
  const protocol::LogTick* confirmed = ledger_->at(frame.tick);
  if (confirmed == nullptr) return wrong(Invariant::kFrames, name + " is not confirmed");
  if (!(confirmed->frame == frame)) {
    return wrong(Invariant::kFrames, name + " is not the one that was confirmed");
  }
  const bool next = frame.tick == last_frame_ + 1;
  const bool behind_state = frame.tick == exact_tick_ + 1 && frame.tick > last_frame_;
  if (!welcomed_ || (!next && !behind_state)) {
    return wrong(Invariant::kFrames,
                 name + " came behind that of tick " + std::to_string(last_frame_));
  }
  last_frame_ = frame.tick;
}

void Observer::check_state(const client::Follower& follower) {
  const client::Progress& progress = follower.progress();
  if (excused_ || progress.phase != client::Phase::kRunning) return;
  const std::uint64_t tick = progress.last_tick;
  if (tick == verified_tick_ || tick == 0 || follower.simulation().tick() != tick) return;
  const protocol::LogTick* confirmed = ledger_->at(tick);
  if (confirmed == nullptr) {
    return wrong(Invariant::kDigests,
                 "is at tick " + std::to_string(tick) + ", which is not confirmed");
  }
  if (follower.simulation().digest() != confirmed->digest) {
    if (disturbed_) return;
    return wrong(Invariant::kDigests,
                 "its state of tick " + std::to_string(tick) + " is not the server's");
  }
  disturbed_ = false;  // What one bit did may also die out.
  verified_tick_ = tick;
}

}  // namespace cycloid::sim
