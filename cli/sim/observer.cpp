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
    const bool is_it = narrow([&](std::size_t timeline) {
      const protocol::LogTick* confirmed = ledger_->at(digest->tick, timeline);
      return confirmed != nullptr && confirmed->digest == digest->digest;
    });
    if (digest->tick != 0 && !is_it) {
      wrong(Invariant::kDigests,
            "heard a digest of tick " + std::to_string(digest->tick) + " that is not the server's");
    }
  }
  const auto* notice = std::get_if<protocol::RoomNotice>(&message);
  if (notice != nullptr && notice->kind == protocol::NoticeKind::kRewound) {
    on_rewound(notice->value);
  }
}

void Observer::on_rewound(std::uint64_t tick) {
  widen();
  std::set<std::size_t> next;
  for (const std::size_t timeline : timelines_) {
    if (timeline < ledger_->timeline()) next.insert(timeline + 1);
  }
  if (next.empty()) return wrong(Invariant::kFrames, "heard of a rewind that was none");
  timelines_ = std::move(next);
  last_frame_ = exact_tick_ = seen_tick_ = tick;
  verified_tick_ = 0;
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

/// Who sees the match late and has seen nothing of what was taken back is not told that it was. It
/// may also still hear what was on the way before that, so it may be in either timeline.
void Observer::widen() {
  if (delay_ticks_ == 0) return;
  for (const std::size_t timeline : timelines_) {  // Those that are added, too: they come behind.
    const std::size_t next = timeline + 1;
    if (next > ledger_->timeline() || seen_tick_ > ledger_->branch_tick(next)) continue;
    timelines_.insert(next);
  }
}

void Observer::welcomed(std::uint64_t tick, std::size_t timeline, std::uint64_t delay_ticks) {
  welcomed_ = true;
  delay_ticks_ = delay_ticks;
  timelines_ = {timeline};
  last_frame_ = exact_tick_ = seen_tick_ = tick;
}

void Observer::on_exact_state(std::uint64_t tick) {
  if (!narrow([&](std::size_t timeline) { return tick <= ledger_->ticks(timeline); })) {
    wrong(Invariant::kFrames,
          "heard a state of tick " + std::to_string(tick) + ", which is not confirmed");
  }
  exact_tick_ = tick;
  seen_tick_ = std::max(seen_tick_, tick);
}

void Observer::on_frame(const protocol::InputFrame& frame) {
  const std::string name = "the frame of tick " + std::to_string(frame.tick);
  const bool is_it = narrow([&](std::size_t timeline) {
    const protocol::LogTick* confirmed = ledger_->at(frame.tick, timeline);
    return confirmed != nullptr && confirmed->frame == frame;
  });
  if (!is_it) return wrong(Invariant::kFrames, name + " is not one that was confirmed");
  const bool next = frame.tick == last_frame_ + 1;
  const bool behind_state = frame.tick == exact_tick_ + 1 && frame.tick > last_frame_;
  if (!welcomed_ || (!next && !behind_state)) {
    return wrong(Invariant::kFrames,
                 name + " came behind that of tick " + std::to_string(last_frame_));
  }
  last_frame_ = seen_tick_ = frame.tick;
}

std::uint64_t Observer::new_tick(const client::Follower& follower) {
  const client::Progress& progress = follower.progress();
  if (excused_ || progress.phase != client::Phase::kRunning) return 0;
  const std::uint64_t tick = progress.last_tick;
  if (tick == verified_tick_ || tick == 0) return 0;
  if (narrow([&](std::size_t timeline) { return ledger_->at(tick, timeline) != nullptr; })) {
    return tick;
  }
  wrong(Invariant::kDigests, "is at tick " + std::to_string(tick) + ", which is not confirmed");
  return 0;
}

void Observer::check_state(const client::Follower& follower) {
  const std::uint64_t tick = new_tick(follower);
  if (tick == 0 || follower.simulation().tick() != tick) return;
  const std::uint64_t digest = follower.simulation().digest();
  const bool is_it = narrow([&](std::size_t timeline) {
    const protocol::LogTick* confirmed = ledger_->at(tick, timeline);
    return confirmed != nullptr && digest == confirmed->digest;
  });
  if (!is_it) {
    if (disturbed_) return;
    return wrong(Invariant::kDigests,
                 "its state of tick " + std::to_string(tick) + " is not the server's");
  }
  disturbed_ = false;  // What one bit did may also die out.
  verify(tick);
}

void Observer::verify(std::uint64_t tick) {
  verified_tick_ = tick;
  seen_tick_ = std::max(seen_tick_, tick);
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
  if (!narrow(is_of)) return wrong(Invariant::kDigests, mistake);
  chronicle_->count(Event::kQuantisedShown);
  verify(tick);
}

}  // namespace cycloid::sim
