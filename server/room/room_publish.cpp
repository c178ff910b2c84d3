#include <utility>

#include "server/room/room.hpp"

namespace cycloid::server {

std::uint64_t Room::visible_tick(const Peer& peer) const {
  const std::uint64_t made = simulation_.tick();
  return made > peer.delay_ticks ? made - peer.delay_ticks : 0;
}

std::shared_ptr<const ExactState> Room::late_state(const Peer& peer) const {
  auto state = keyframes_.at_or_before(visible_tick(peer));
  const bool lockstep = peer.mode == protocol::Mode::kLockstep;
  const std::uint64_t seen = lockstep ? peer.next_frame - 1 : peer.exact_tick;
  if (state && !peer.welcome_due && state->tick() < seen) return nullptr;
  return state;
}

void Room::publish() {
  const std::uint64_t tick = simulation_.tick();
  const std::int64_t now_ns = hooks_.now_ns();
  for (auto& [id, peer] : peers_) {
    if (!peer.playing()) continue;
    if (peer.mode == protocol::Mode::kLockstep) {
      send_frames(id, peer, now_ns);
    } else if (!peer.state_due && tick % options_.limits.snapshot_ticks == 0) {
      send_snapshot(peer);
    }
  }
  send_margins();
}

void Room::send_snapshot(Peer& peer) {
  if (peer.delay_ticks == 0) {
    const bool speaks = peer.seat >= 0;
    const Shared snapshot = feed_.message(peer.profile, peer.sent, speaks, simulation_, digest_);
    if (snapshot) peer.outbox.replace_snapshot(snapshot);
    return;
  }
  // What it may see is no state that the room is in, so it sees those that are kept, whole.
  const auto state = keyframes_.at_or_before(visible_tick(peer));
  if (!state || state->tick() <= peer.exact_tick) return;
  peer.exact_tick = state->tick();
  peer.outbox.replace_snapshot(whole_state_delta(*state));
}

/// Every frame that the client may see and that was not queued yet: one a tick, or all since the
/// tick that it came back with, or since the state that it was given.
void Room::send_frames(PeerId id, Peer& peer, std::int64_t now_ns) {
  const std::int64_t most = options_.limits.queue_age.count();
  if (peer.state_due) {
    const bool can_begin = peer.delay_ticks == 0 || late_state(peer) != nullptr;
    if (!can_begin) peer.state_due_ns = now_ns;  // It is not the client that is slow.
    if (now_ns - peer.state_due_ns >= most) overrun(id, peer);
    return;
  }
  for (; peer.next_frame <= visible_tick(peer); ++peer.next_frame) {
    const MadeTick* made = frames_.find(peer.next_frame);
    if (made == nullptr || !peer.outbox.push_frame(made->bytes(peer.packs), now_ns))
      return overrun(id, peer);
  }
  const auto oldest = peer.outbox.oldest_frame_ns();
  if (oldest && now_ns - *oldest >= most) overrun(id, peer);
}

void Room::send_margins() {
  for (std::size_t seat = 0; seat < seats_.size(); ++seat) {
    if (seats_[seat].state != SeatState::kHeld) continue;
    const auto found = peers_.find(seats_[seat].holder);
    if (found->second.welcome_due) continue;
    const auto margin = seats_[seat].margin.take(simulation_.tick());
    if (margin) answer(found->first, found->second, *margin);
  }
}

void Room::want_state(Peer& peer) {
  peer.outbox.drop_frames_and_state();
  peer.state_due = true;
  peer.state_due_ns = hooks_.now_ns();
}

/// It does not take what it is sent: what waits is dropped, and the exact state takes its place as
/// soon as it takes anything, a bounded number of times.
void Room::overrun(PeerId id, Peer& peer) {
  ++statistics_.overruns;
  const Limits& limits = options_.limits;
  const std::string waited =
      "more than " + std::to_string(limits.queue_bytes_max) + " bytes, or anything for more than " +
      std::to_string(limits.queue_age.count() / 1'000'000) + " ms, waited for it ";
  if (peer.outbox.state_waits()) {
    if (++peer.state_restarts > limits.state_restarts_max) {
      return refuse(id, peer, protocol::Refusal::kTooSlow,
                    waited + std::to_string(peer.state_restarts) + " times within one state",
                    protocol::EventKind::kLost);
    }
  } else if (!peer.overruns.take(hooks_.now_ns())) {
    return refuse(id, peer, protocol::Refusal::kTooSlow,
                  waited + std::to_string(limits.resyncs_max + 1) + " times in " +
                      std::to_string(limits.resync_window.count() / 1'000'000'000) + " s",
                  protocol::EventKind::kLost);
  }
  want_state(peer);
}

void Room::begin_state(PeerId id, Peer& peer) {
  const bool delayed = peer.delay_ticks > 0;
  const auto state = delayed ? late_state(peer) : states_.of(simulation_, digest_);
  if (!state) return;  // Time brings the next.
  peer.state_due = false;
  if (peer.welcome_due) say_welcome(id, peer, welcome_tick(peer, state->tick()));
  if (!peer.playing()) return;
  peer.exact_tick = state->tick();
  peer.next_frame = state->tick() + 1;
  peer.sent = {};
  peer.outbox.begin_state(state);
  statistics_.encodes = states_.encodes() + feed_.encodes();
  if (peer.mode == protocol::Mode::kLockstep) return send_frames(id, peer, hooks_.now_ns());
  if (!delayed) feed_.hold(peer.profile, peer.sent, simulation_, digest_);
}

/// Of a state that follows. Who comes back with a state of its own takes a welcome with that one's
/// tick for a yes; it may be of a branch that is gone, but for the ticks that all branches share.
std::uint64_t Room::welcome_tick(const Peer& peer, std::uint64_t state_tick) const {
  const bool may_hold = peer.resumed && peer.mode == protocol::Mode::kLockstep;
  return may_hold && was_taken_back(state_tick) ? rewound_to_ : state_tick;
}

void Room::say_welcome(PeerId id, Peer& peer, std::uint64_t tick) {
  peer.welcome_due = false;
  protocol::Welcome welcome;
  welcome.seat = peer.seat;
  welcome.seats = static_cast<std::uint32_t>(seats_.size());
  welcome.tick = tick;
  welcome.tick_rate_millihertz = options_.tick_rate_millihertz;
  welcome.input_delay_ticks = delay_.ticks();
  welcome.room = options_.name;
  welcome.resume = std::move(peer.secret);
  welcome.build = options_.build;
  welcome.digest_ticks = static_cast<std::uint32_t>(options_.limits.digest_ticks);
  answer(id, peer, welcome);
}

void Room::tell_all(protocol::NoticeKind kind, std::uint64_t value, const std::string& text) {
  for (auto& [id, peer] : peers_) {
    if (!peer.playing() || peer.welcome_due) continue;
    answer(id, peer, protocol::RoomNotice{kind, visible_tick(peer), value, text});
  }
}

}  // namespace cycloid::server
