#include <algorithm>
#include <vector>

#include "server/room/room.hpp"

namespace cycloid::server {

bool Room::rewind(std::uint64_t tick) {
  const std::uint64_t from = simulation_.tick();
  if (state_ != RoomState::kRunning || tick >= from) return false;
  // Its own frame is needed too, for the log; tick 0 had none.
  if (frames_.find(std::max<std::uint64_t>(tick, 1)) == nullptr) return false;
  if (!replay_to(tick)) return false;
  break_inquiries("the match was taken back meanwhile");
  ++statistics_.rewinds;
  rewound_to_ = std::min(rewound_to_, tick);
  rewound_from_ = std::max(rewound_from_, from);
  reconcile_seats(tick);
  seats_.rewind(from, tick);
  frames_.drop_after(tick);
  keyframes_.drop_after(tick);
  states_.forget();
  feed_.forget_all();
  pacer_.rewind(from + 1, tick + 1);
  inputs_ = {};
  delay_.look_anew();
  // What it was at that tick is not known any more; what it is now goes on.
  changes_ = {{protocol::ChangeKind::kInputDelay, delay_.ticks()}};
  if (hooks_.log != nullptr) {
    const MadeTick* made = frames_.find(tick);  // Tick 0 had no frame.
    const protocol::LogTick branch{made == nullptr ? protocol::InputFrame{} : made->frame, digest_};
    hooks_.log->branch(branch, states_.of(simulation_, digest_)->bytes());
  }
  notice(Notice::Kind::kAct, "the match goes on from tick " + std::to_string(tick) +
                                 ", and not from " + std::to_string(from));
  rewind_peers(tick);
  return true;
}

/// From the keyframe before it, by the frames that were made. Where that fails nothing has changed.
bool Room::replay_to(std::uint64_t tick) {
  const auto keyframe = keyframes_.at_or_before(tick);
  if (!keyframe) return false;
  for (std::uint64_t made = keyframe->tick() + 1; made <= tick; ++made) {
    if (frames_.find(made) == nullptr) return false;
  }
  const auto now = states_.of(simulation_, digest_);
  bool good = simulation_.decode(keyframe->bytes()).ok();
  std::uint64_t digest = keyframe->digest();
  for (std::uint64_t next = keyframe->tick() + 1; good && next <= tick; ++next) {
    const MadeTick& made = *frames_.find(next);
    std::vector<scenes::SeatInput> inputs;
    for (const protocol::SeatFrame& seat : made.frame.seats) inputs.push_back(seat.input);
    digest = made.digest;
    good = simulation_.step(inputs).ok() && simulation_.digest() == digest;
  }
  if (!good) {
    // What this room made and encoded itself decodes, unless memory is damaged.
    (void)simulation_.decode(now->bytes());
    return false;
  }
  digest_ = digest;
  return true;
}

/// The events of the next frame lead from who sat where at that tick to who sits there now.
void Room::reconcile_seats(std::uint64_t tick) {
  enum class Was : std::uint8_t { kFree, kHeld, kLost };
  const auto before = [](protocol::EventKind event) {
    if (event == protocol::EventKind::kJoin) return Was::kFree;
    return event == protocol::EventKind::kResume ? Was::kLost : Was::kHeld;
  };
  std::vector<Was> now;
  for (std::size_t seat = 0; seat < seats_.size(); ++seat) {
    const SeatState state = seats_[seat].state;
    now.push_back(state == SeatState::kHeld   ? Was::kHeld
                  : state == SeatState::kLost ? Was::kLost
                                              : Was::kFree);
  }
  std::vector<Was> then = now;
  std::vector<bool> changed(now.size(), false);
  const auto undo = [&](const std::vector<protocol::FrameEvent>& events) {
    for (auto event = events.rbegin(); event != events.rend(); ++event) {
      then[event->seat] = before(event->kind);
      changed[event->seat] = true;
    }
  };
  undo(events_);
  std::uint64_t newest = tick;
  while (frames_.find(newest + 1) != nullptr) ++newest;
  for (; newest > tick; --newest) undo(frames_.find(newest)->frame.events);

  events_.clear();
  for (std::size_t seat = 0; seat < now.size(); ++seat) {
    if (!changed[seat]) continue;
    const auto say = [&](protocol::EventKind kind) {
      events_.push_back({kind, static_cast<std::uint16_t>(seat)});
    };
    if (then[seat] != Was::kFree) say(protocol::EventKind::kLeave);
    if (now[seat] != Was::kFree) say(protocol::EventKind::kJoin);
    if (now[seat] == Was::kLost) say(protocol::EventKind::kLost);
  }
}

void Room::rewind_peers(std::uint64_t tick) {
  for (auto& [id, peer] : peers_) {
    if (!peer.playing() || peer.welcome_due) continue;
    // A spectator that lags behind has seen nothing of what was taken back: it goes on. One whose
    // state is due has seen the frames before a desync, or been told to go on from another tick.
    const std::uint64_t seen = std::max(peer.next_frame - 1, peer.exact_tick);
    if (peer.delay_ticks > 0 && seen <= tick) continue;
    want_state(peer);
    peer.exact_tick = 0;
    ++peer.rewinds_unheard;
    // Who sees the match late is given a kept state, which may be older than what it may see.
    const std::uint64_t shown = visible_tick(peer);
    const auto kept = peer.delay_ticks > 0 ? keyframes_.at_or_before(shown) : nullptr;
    const std::uint64_t from = kept != nullptr ? kept->tick() : shown;
    peer.next_frame = from + 1;
    answer(id, peer,
           protocol::RoomNotice{protocol::NoticeKind::kRewound, shown, from,
                                "the match goes on from tick " + std::to_string(from)});
  }
}

}  // namespace cycloid::server
