#include <algorithm>
#include <utility>

#include "server/room/room.hpp"

namespace cycloid::server {

void Room::advance() {
  if (state_ != RoomState::kRunning) return;
  close_overdue();
  if (!pacer_.paused()) make_due_ticks();
  // In a pause, and where ticks are rare, clients are heard and served all the same.
  if (state_ == RoomState::kRunning && pacer_.serves(hooks_.now_ns())) serve_peers();
}

void Room::make_due_ticks() {
  const std::int64_t begin = hooks_.now_ns();
  for (std::uint32_t made = 0; state_ == RoomState::kRunning; ++made) {
    const std::int64_t now = hooks_.now_ns();
    const bool out_of_time = made > 0 && now - begin >= pacer_.tick_ns();
    if (now < pacer_.due_ns(simulation_.tick() + 1)) return;
    if (made == options_.limits.catch_up_ticks_max || out_of_time) break;
    if (waits_for_input(now)) return;
    statistics_.catch_up_ticks += made > 0 ? 1 : 0;
    make_tick();
  }
  if (state_ == RoomState::kRunning) slow_down();
}

bool Room::waits_for_input(std::int64_t now_ns) {
  const std::uint64_t next = simulation_.tick() + 1;
  const bool gives_up = options_.slow == SlowPeer::kReplace;
  bool lacks = false;
  for (std::size_t seat = 0; seat < seats_.size() && options_.policy.waits(); ++seat) {
    const SeatHold& hold = seats_[seat];
    if (hold.state != SeatState::kHeld || !hold.window.spoke() || hold.window.has(next)) continue;
    lacks = lacks || !gives_up || hold.missed < options_.limits.slow_ticks_max;
  }
  const bool waited = pacer_.waiting();
  if (lacks && pacer_.waits(next, now_ns, options_.policy.wait_ticks_max)) {
    inputs_.missed = true;
    return true;
  }
  if (waited) {
    statistics_.waited_ns += static_cast<std::uint64_t>(pacer_.end_wait(next, now_ns));
  }
  return false;
}

void Room::make_tick() {
  const std::int64_t begin = hooks_.now_ns();
  const std::int64_t late = begin - pacer_.due_ns(simulation_.tick() + 1);
  statistics_.last_lateness_ns = static_cast<std::uint64_t>(std::max<std::int64_t>(late, 0));
  statistics_.lateness_ns.add(statistics_.last_lateness_ns);
  if (hooks_.lateness) hooks_.lateness(statistics_.last_lateness_ns);
  protocol::InputFrame frame = close_frame();
  std::vector<scenes::SeatInput> inputs;
  inputs.reserve(frame.seats.size());
  for (const protocol::SeatFrame& seat : frame.seats) inputs.push_back(seat.input);
  const solver::Error error = simulation_.step(inputs);
  if (!error.ok()) return fault(frame, error);
  digest_ = simulation_.digest();
  highest_tick_ = std::max(highest_tick_, simulation_.tick());
  keep(std::move(frame));
  publish();
  statistics_.last_tick_ns = static_cast<std::uint64_t>(hooks_.now_ns() - begin);
  statistics_.worst_tick_ns = std::max(statistics_.worst_tick_ns, statistics_.last_tick_ns);

  enforce_slow_policy();
  expire_seats();
  serve_peers();
  check_log();
  if (state_ == RoomState::kRunning && simulation_.tick() == options_.ticks) {
    end(RoomState::kTicksDone, "all " + std::to_string(options_.ticks) + " ticks are made");
  }
}

protocol::InputFrame Room::close_frame() {
  protocol::InputFrame frame;
  frame.tick = simulation_.tick() + 1;
  frame.seats.reserve(seats_.size());
  for (std::size_t seat = 0; seat < seats_.size(); ++seat) {
    frame.seats.push_back(close_seat(seats_[seat], frame.tick));
  }
  frame.events = std::exchange(events_, {});
  frame.changes = std::exchange(changes_, {});
  if (const auto ticks = delay_.on_tick(inputs_)) {
    changes_.push_back({protocol::ChangeKind::kInputDelay, *ticks});
  }
  inputs_ = {};
  return frame;
}

protocol::SeatFrame Room::close_seat(SeatHold& hold, std::uint64_t tick) {
  if (hold.state == SeatState::kLost) return hold.window.close_lost(tick);
  if (hold.state != SeatState::kHeld) return {};
  const auto early_ticks = hold.window.early_ticks(tick);
  const protocol::SeatFrame seat = hold.window.close(tick, options_.policy);
  if (seat.origin == protocol::Origin::kGiven) {
    hold.missed = 0;
    inputs_.tight = inputs_.tight || early_ticks == 0u;
  } else if (hold.window.spoke()) {
    ++hold.missed;
    hold.margin.on_missed();
    ++statistics_.inputs_replaced;
    inputs_.missed = inputs_.tight = true;
  }
  return seat;
}

/// The log's record holds the digest, so it can only be made after the step; but no client has
/// heard of the tick yet.
void Room::keep(protocol::InputFrame frame) {
  const std::uint64_t tick = frame.tick;
  if (hooks_.log != nullptr) {
    hooks_.log->tick({frame, digest_});
    if (hooks_.log->wants_keyframe(tick)) {
      hooks_.log->keyframe(tick, digest_, states_.of(simulation_, digest_)->bytes());
    }
  }
  frames_.push({std::move(frame), digest_, tick % options_.limits.digest_ticks == 0});
  keyframes_.drop_before(frames_.oldest() - 1);  // Nothing leads on from those.
  if (tick % options_.limits.keyframe_ticks != 0) return;
  const std::uint64_t delay = options_.spectator_delay_ticks;
  keyframes_.push(states_.of(simulation_, digest_), tick > delay ? tick - delay : 0);
}

/// What there was no room for before: each peer has anew what it may say and be given until the
/// next time.
void Room::serve_peers() {
  pacer_.note_served(hooks_.now_ns());
  statistics_.queue_bytes = 0;
  for (auto& [id, peer] : peers_) {
    peer.messages = 0;
    if (peer.stage != PeerStage::kClosing)
      peer.parts_left = options_.limits.state_parts_per_tick_max;
    process(id, peer);
    statistics_.queue_bytes += peer.outbox.bytes();
  }
  pass_inquiry_messages();
  statistics_.encodes = states_.encodes() + feed_.encodes();
}

void Room::enforce_slow_policy() {
  if (options_.slow == SlowPeer::kWait || options_.slow == SlowPeer::kReplace) return;
  for (std::size_t seat = 0; seat < seats_.size(); ++seat) {
    const SeatHold& hold = seats_[seat];
    if (hold.state != SeatState::kHeld || hold.missed < options_.limits.slow_ticks_max) continue;
    const std::string why = "no input in time for " + std::to_string(hold.missed) +
                            " ticks, of at most " +
                            std::to_string(options_.limits.slow_ticks_max - 1);
    const auto found = peers_.find(hold.holder);
    Peer& peer = found->second;
    if (options_.slow == SlowPeer::kDrop) {
      refuse(found->first, peer, protocol::Refusal::kTooSlow, why, protocol::EventKind::kKick);
      continue;
    }
    give_up_seat(peer, protocol::EventKind::kKick);
    if (peer.role != Role::kAdmin) look_on_late(peer);
    notice(Notice::Kind::kLeave,
           "client " + std::to_string(found->first) + " looks on from now on: " + why);
  }
}

/// A player who looks on from now on sees the match late, but nothing older than it has seen.
void Room::look_on_late(Peer& peer) {
  peer.delay_ticks = options_.spectator_delay_ticks;
  const bool thin = peer.mode == protocol::Mode::kSnapshot;
  if (thin && peer.delay_ticks > 0) peer.exact_tick = std::max(peer.exact_tick, simulation_.tick());
}

void Room::expire_seats() {
  for (const std::size_t seat : seats_.expire(simulation_.tick())) {
    tokens_.forget(seat);
    events_.push_back({protocol::EventKind::kLeave, static_cast<std::uint16_t>(seat)});
    notice(Notice::Kind::kLeave,
           "seat " + std::to_string(seat) + " is free: its player did not come back");
  }
}

void Room::fault(const protocol::InputFrame& frame, const solver::Error& error) {
  std::string where = std::string(solver::code_name(error.code)) + " " + error.field;
  if (const auto fault = simulation_.fault()) {
    where = solver::fault_field_name(fault->field);
    if (fault->body.index != solver::kNone) {
      where += " of body " + std::to_string(fault->body.index);
    }
  }
  const std::string reason =
      "the world faulted at tick " + std::to_string(frame.tick) + ": " + where;
  notice(Notice::Kind::kFault, reason);
  end(RoomState::kFaulted, reason);
}

void Room::check_log() {
  if (hooks_.log == nullptr || hooks_.log->durable() || log_noticed_) return;
  log_noticed_ = true;
  const std::string reason = "the log has ended: " + hooks_.log->error();
  notice(Notice::Kind::kLog, reason + "; the match is not durable from here on");
  if (state_ != RoomState::kRunning) return;
  if (options_.stop_on_log_error) return end(RoomState::kLogFailed, reason);
  tell_all(protocol::NoticeKind::kNotDurable, 0, "the match is no longer recorded");
}

void Room::slow_down() {
  const std::int64_t now = hooks_.now_ns();
  const std::int64_t tick_ns = pacer_.tick_ns();
  const std::int64_t behind = now - pacer_.due_ns(simulation_.tick() + 1);
  if (behind <= tick_ns * static_cast<std::int64_t>(options_.limits.catch_up_ticks_max)) return;
  // Whole ticks, so that rooms which were held up together do not share a phase from then on.
  const std::int64_t by_ns = behind / tick_ns * tick_ns;
  pacer_.delay(by_ns);
  statistics_.slowed_ns += static_cast<std::uint64_t>(by_ns);
  // Once a second is enough, and says all of it: the value is a sum.
  constexpr std::int64_t kTellNs = 1'000'000'000;
  if (slowed_told_ns_ == 0 || now - slowed_told_ns_ >= kTellNs) {
    slowed_told_ns_ = now;
    tell_all(protocol::NoticeKind::kSlowed, statistics_.slowed_ns / 1'000'000,
             "the server is overloaded, and the match slower than its clock");
  }
  const bool slow_steps = std::cmp_greater(statistics_.worst_tick_ns, tick_ns);
  bool& noticed = slow_steps ? slow_steps_noticed_ : stall_noticed_;
  if (std::exchange(noticed, true)) return;
  notice(Notice::Kind::kOverload,
         std::string(slow_steps ? "a tick takes longer than it lasts" : "the process was not run") +
             ": the match is slowed by " + std::to_string(behind / 1'000'000) + " ms at tick " +
             std::to_string(simulation_.tick()) + "; said once, and counted");
}

}  // namespace cycloid::server
