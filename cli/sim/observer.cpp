#include "cli/sim/observer.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <variant>
#include <vector>

#include "protocol/state/quantised.hpp"

namespace cycloid::sim {
namespace {

/// Of the floats in two quaternions.
constexpr float kRounding_rad = 0.0005f;

bool is_shown_as(const scenes::Pose& shown, const scenes::Pose& was) {
  if (shown.generation != was.generation) return false;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float rounding = 4.0e-7f * std::fabs(was.position[axis]);
    const float error = std::fabs(shown.position[axis] - was.position[axis]);
    if (!(error <= 0.5001f * protocol::kPositionStep_m + rounding)) return false;
  }
  float cosine = 0.0f;  // Of half the angle between them.
  for (std::size_t i = 0; i < 4; ++i) cosine += shown.rotation[i] * was.rotation[i];
  const float half_rad = 0.5f * (protocol::kRotationErrorMax_rad + kRounding_rad);
  return 1.0f - cosine * cosine <= half_rad * half_rad;
}

bool is_among(const scenes::Pose& shown, const std::vector<scenes::Pose>& were) {
  return std::ranges::any_of(were, [&](const scenes::Pose& was) {
    return shown.index == was.index && is_shown_as(shown, was);
  });
}

}  // namespace

void Observer::heard(const protocol::ServerMessage& message) {
  if (excused_) return;
  check_delay(message);
  if (const auto* frame = std::get_if<protocol::InputFrame>(&message)) return on_frame(*frame);
  if (const auto* snapshot = std::get_if<protocol::Snapshot>(&message)) {
    return on_exact_state(snapshot->tick);
  }
  if (const auto* part = std::get_if<protocol::SnapshotPart>(&message)) {
    if (part->offset == 0) on_exact_state(part->tick);
  }
  if (const auto* digest = std::get_if<protocol::Digest>(&message)) {
    const protocol::LogTick* confirmed = ledger_->at(digest->tick, timeline_);
    const bool first = digest->tick == 0;
    if (!first && (confirmed == nullptr || confirmed->digest != digest->digest)) {
      wrong(Invariant::kDigests,
            "heard a digest of tick " + std::to_string(digest->tick) + " that is not the server's");
    }
  }
  const auto* notice = std::get_if<protocol::RoomNotice>(&message);
  if (notice == nullptr || notice->kind != protocol::NoticeKind::kRewound) return;
  if (timeline_ == ledger_->timeline()) {
    return wrong(Invariant::kFrames, "heard of a rewind that was none");
  }
  ++timeline_;
  last_frame_ = exact_tick_ = notice->value;
  verified_tick_ = certain_tick_ = 0;
}

/// What it hears was sent a while ago, so this is never too strict.
void Observer::check_delay(const protocol::ServerMessage& message) {
  if (delay_ticks_ == 0) return;
  std::uint64_t tick = 0;
  const auto tell = [&](const auto& said) {
    if constexpr (requires { said.tick; }) tick = said.tick;
  };
  std::visit(tell, message);
  const std::uint64_t highest = ledger_->highest_tick();
  if (tick + delay_ticks_ <= std::max(highest, delay_ticks_)) return;
  wrong(Invariant::kDelay, "hears of tick " + std::to_string(tick) + " of " +
                               std::to_string(highest) + ", and is to see it " +
                               std::to_string(delay_ticks_) + " ticks late");
}

/// Who sees the match late and has seen nothing of what was taken back is not told that it was.
bool Observer::follows_branch(std::uint64_t seen_tick) {
  if (delay_ticks_ == 0 || timeline_ == ledger_->timeline()) return false;
  if (!ledger_->next_is_same(timeline_, seen_tick)) return false;
  ++timeline_;
  return true;
}

void Observer::welcomed(std::uint64_t tick, std::size_t timeline, std::uint64_t delay_ticks) {
  welcomed_ = true;
  delay_ticks_ = delay_ticks;
  timeline_ = timeline;
  last_frame_ = exact_tick_ = tick;
}

void Observer::on_exact_state(std::uint64_t tick) {
  const auto is_there = [&] { return tick <= ledger_->ticks(timeline_); };
  if (!follow_until(std::max(certain_tick_, last_frame_), is_there)) {
    wrong(Invariant::kFrames,
          "heard a state of tick " + std::to_string(tick) + ", which is not confirmed");
  }
  exact_tick_ = tick;
}

void Observer::on_frame(const protocol::InputFrame& frame) {
  const std::string name = "the frame of tick " + std::to_string(frame.tick);
  const protocol::LogTick* confirmed = ledger_->at(frame.tick, timeline_);
  const bool is_it = follow_until(last_frame_, [&] {
    confirmed = ledger_->at(frame.tick, timeline_);
    return confirmed != nullptr && confirmed->frame == frame;
  });
  if (confirmed == nullptr) return wrong(Invariant::kFrames, name + " is not confirmed");
  if (!is_it) {
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

std::uint64_t Observer::new_tick(const client::Follower& follower) {
  const client::Progress& progress = follower.progress();
  if (excused_ || progress.phase != client::Phase::kRunning) return 0;
  const std::uint64_t tick = progress.last_tick;
  if (tick == verified_tick_ || tick == 0) return 0;
  const auto is_there = [&] { return ledger_->at(tick, timeline_) != nullptr; };
  if (follow_until(certain_tick_, is_there)) return tick;
  wrong(Invariant::kDigests, "is at tick " + std::to_string(tick) + ", which is not confirmed");
  return 0;
}

void Observer::check_state(const client::Follower& follower) {
  const std::uint64_t tick = new_tick(follower);
  if (tick == 0 || follower.simulation().tick() != tick) return;
  const std::uint64_t digest = follower.simulation().digest();
  const auto is_of = [&](std::size_t timeline) {
    const protocol::LogTick* confirmed = ledger_->at(tick, timeline);
    return confirmed != nullptr && digest == confirmed->digest;
  };
  const bool is_it = follow_until(certain_tick_, [&] { return is_of(timeline_); });
  if (!is_it) {
    if (disturbed_) return;
    return wrong(Invariant::kDigests,
                 "its state of tick " + std::to_string(tick) + " is not the server's");
  }
  disturbed_ = false;  // What one bit did may also die out.
  verify(tick, has_next() && is_of(timeline_ + 1));
}

void Observer::verify(std::uint64_t tick, bool may_be_of_next) {
  verified_tick_ = tick;
  if (!may_be_of_next) certain_tick_ = tick;
  if (delay_ticks_ > 0) chronicle_->count(Event::kSeenLate);
}

bool Observer::is_shown_right(const scenes::Pose& pose, std::uint64_t tick, bool may_lag,
                              std::size_t timeline) const {
  std::uint64_t then = tick;
  while (then > 0 && may_lag && !is_among(pose, ledger_->poses(then, timeline))) --then;
  return is_among(pose, ledger_->poses(then, timeline));
}

/// How what is shown differs from a tick of a timeline; "": it does not.
std::string Observer::mistake_of(const std::vector<scenes::Pose>& shown, std::uint64_t tick,
                                 bool may_lag, std::size_t timeline) const {
  if (tick > ledger_->ticks(timeline)) return "shows tick " + std::to_string(tick) + ", not made";
  const std::size_t bodies = ledger_->poses(tick, timeline).size();
  if (shown.size() > bodies || (shown.size() < bodies && !may_lag)) {
    return "shows " + std::to_string(shown.size()) + " bodies of " + std::to_string(bodies);
  }
  for (const scenes::Pose& pose : shown) {
    if (is_shown_right(pose, tick, may_lag, timeline)) continue;
    return "shows body " + std::to_string(pose.index) + " at tick " + std::to_string(tick) +
           " where it was not";
  }
  return "";
}

void Observer::check_shown(const client::Follower& follower, bool may_lag) {
  const std::uint64_t tick = new_tick(follower);
  if (tick == 0) return;
  const std::vector<scenes::Pose> shown = follower.poses();
  std::string mistake;
  const auto is_of = [&](std::size_t timeline) {
    mistake = mistake_of(shown, tick, may_lag, timeline);
    return mistake.empty();
  };
  const bool is_it = follow_until(certain_tick_, [&] { return is_of(timeline_); });
  if (!is_it) return wrong(Invariant::kDigests, mistake);
  chronicle_->count(Event::kQuantisedShown);
  verify(tick, has_next() && is_of(timeline_ + 1));
}

}  // namespace cycloid::sim
