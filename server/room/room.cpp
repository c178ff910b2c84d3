#include "server/room/room.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "protocol/text.hpp"

namespace cycloid::server {
namespace {

std::size_t frames_kept(const RoomOptions& options) {
  const std::uint64_t needed =
      frames_for_delay(options.spectator_delay_ticks, options.limits.keyframe_ticks);
  return std::max<std::size_t>(options.limits.frames_kept_max, needed);
}

/// For how long a client may acknowledge a snapshot.
std::uint64_t ticks_of_3_s(std::uint32_t rate_millihertz) {
  return 3ull * rate_millihertz / 1000 + 1;
}

}  // namespace

Room::Room(RoomOptions options, scenes::Simulation simulation, RoomHooks hooks)
    : options_(std::move(options)),
      simulation_(std::move(simulation)),
      hooks_(std::move(hooks)),
      digest_(simulation_.digest()),
      highest_tick_(simulation_.tick()),
      pacer_(hooks_.now_ns(), options_.tick_rate_millihertz),
      seats_(static_cast<std::size_t>(simulation_.seats())),
      tokens_(seats_.size()),
      delay_(options_.delay, options_.limits.input_delay_ticks, options_.tick_rate_millihertz),
      frames_(frames_kept(options_)),
      keyframes_(options_.limits.keyframe_bytes_max),
      feed_({options_.limits.snapshot_bytes_max, options_.limits.baseline_bytes_max,
             ticks_of_3_s(options_.tick_rate_millihertz)}) {
  options_.limits = at_tick_rate(options_.tick_rate_millihertz, options_.limits);
  keyframes_.push(states_.of(simulation_, digest_), 0);
}

std::size_t Room::connections() const {
  const auto counts = [](const auto& peer) { return peer.second.stage != PeerStage::kClosing; };
  return static_cast<std::size_t>(std::ranges::count_if(peers_, counts));
}

bool Room::takes_connections() const {
  const std::size_t most = options_.limits.connections_max;
  return peers_.size() < most || connections() < most;
}

PeerId Room::connect() {
  const std::size_t connections = this->connections();

  const PeerId id = ++last_id_;
  Peer& peer = peers_.emplace(id, Peer(options_.limits, hooks_.now_ns())).first->second;
  if (state_ == RoomState::kFaulted) {
    refuse(id, peer, protocol::Refusal::kFaulted, end_reason_);
  } else if (state_ != RoomState::kRunning) {
    refuse(id, peer, protocol::Refusal::kDraining, end_reason_);
  } else if (connections >= options_.limits.connections_max) {
    refuse(id, peer, protocol::Refusal::kRoomFull,
           std::to_string(connections) + " connections, of at most " +
               std::to_string(options_.limits.connections_max));
  }
  return id;
}

PeerId Room::admit(const Admission& admission) {
  const PeerId id = connect();
  Peer& peer = peers_.find(id)->second;
  if (peer.stage == PeerStage::kGreeting) greet(id, peer, admission);
  return id;
}

void Room::disconnect(PeerId id) {
  const auto found = peers_.find(id);
  if (found == peers_.end()) return;
  if (found->second.playing()) {
    leave(id, found->second, "disconnected", protocol::EventKind::kLost);
  }
  peers_.erase(found);
}

bool Room::wants_bytes(PeerId id) const {
  const auto found = peers_.find(id);
  if (found == peers_.end()) return false;
  const Peer& peer = found->second;
  return peer.stage == PeerStage::kClosing || peer.messages < options_.limits.messages_per_tick_max;
}

bool Room::has_output(PeerId id) const {
  const auto found = peers_.find(id);
  if (found == peers_.end()) return false;
  const Peer& peer = found->second;
  if (peer.outbox.has_output(peer.parts_left)) return true;
  if (!peer.state_due || !peer.playing()) return false;
  return peer.delay_ticks == 0 || late_state(peer) != nullptr;
}

std::vector<Shared> Room::take_output(PeerId id) {
  const auto found = peers_.find(id);
  if (found == peers_.end()) return {};
  Peer& peer = found->second;
  if (peer.state_due && peer.playing()) begin_state(id, peer);
  std::vector<Shared> output = peer.outbox.take(peer.parts_left);
  if (!peer.outbox.state_waits()) peer.state_restarts = 0;
  for (const Shared& bytes : output) statistics_.bytes_out += bytes->size();
  return output;
}

bool Room::owes_state(PeerId id) const {
  const auto found = peers_.find(id);
  if (found == peers_.end() || !found->second.playing()) return false;
  return found->second.state_due || found->second.outbox.state_waits();
}

bool Room::wants_close(PeerId id) const {
  const auto found = peers_.find(id);
  return found == peers_.end() || found->second.stage == PeerStage::kClosing;
}

void Room::drain(const std::string& reason) {
  if (state_ == RoomState::kRunning) end(RoomState::kDrained, reason);
}

void Room::close_overdue() {
  const std::int64_t now = hooks_.now_ns();
  const Limits& limits = options_.limits;
  for (auto& [id, peer] : peers_) {
    const bool greets = peer.stage == PeerStage::kGreeting;
    const std::int64_t waited = now - (greets ? peer.connected_ns : peer.heard_ns);
    const std::int64_t most = (greets ? limits.handshake : limits.idle).count();
    if (peer.stage == PeerStage::kClosing || waited < most) continue;
    if (!greets && pacer_.paused()) continue;  // While nothing happens it has nothing to say.
    const std::string what = greets ? "no hello for " : "no message for ";
    refuse(id, peer, protocol::Refusal::kTooSlow,
           what + std::to_string(waited / 1'000'000) + " ms, of at most " +
               std::to_string(most / 1'000'000) + " ms",
           protocol::EventKind::kLost);
  }
}

void Room::refuse(PeerId id, Peer& peer, protocol::Refusal code, const std::string& reason,
                  protocol::EventKind seat_event) {
  if (peer.stage == PeerStage::kClosing) return;
  ++statistics_.refusals;
  ++statistics_.refusals_by_code[static_cast<std::size_t>(code)];
  notice(Notice::Kind::kRefusal, "client " + std::to_string(id) + " \"" +
                                     protocol::printable(peer.name) + "\"" + identity_text(peer) +
                                     " refused: " + protocol::refusal_name(code) + ": " +
                                     protocol::printable(reason));
  give_up_seat(peer, seat_event);
  if (peer.playing() && hooks_.inquiry != nullptr) hooks_.inquiry->on_gone(id);
  peer.stage = PeerStage::kClosing;
  // What it could not take before it need not take now: its last word is why.
  if (code == protocol::Refusal::kTooSlow || peer.outbox.state_waits()) peer.outbox.clear();
  peer.outbox.push_last(std::make_shared<const protocol::Bytes>(
      protocol::encode(protocol::ServerMessage(protocol::Refused{code, reason}))));
}

void Room::end(RoomState state, const std::string& reason) {
  state_ = state;
  end_reason_ = reason;
  if (hooks_.log != nullptr) hooks_.log->close({simulation_.tick(), digest_, {}});
  check_log();
  break_inquiries("the match ended before it had sent its state");
  const protocol::ServerMessage digest = protocol::Digest{simulation_.tick(), digest_};
  const bool digest_sent = simulation_.tick() % options_.limits.digest_ticks == 0;
  const auto bye = std::make_shared<const protocol::Bytes>(
      protocol::encode(protocol::ServerMessage(protocol::Bye{reason})));
  for (auto& [id, peer] : peers_) {
    if (peer.stage == PeerStage::kClosing) continue;
    if (state == RoomState::kFaulted) {
      refuse(id, peer, protocol::Refusal::kFaulted, reason);
    } else if (peer.stage == PeerStage::kGreeting) {
      refuse(id, peer, protocol::Refusal::kDraining, reason);
    } else {
      if (peer.state_due) begin_state(id, peer);
      // The last digest, so that a replica knows that it saw the match as it was.
      const bool sees_the_end = peer.delay_ticks == 0 && peer.playing();
      const bool lockstep = peer.mode == protocol::Mode::kLockstep;
      if (sees_the_end && lockstep && !digest_sent) answer(id, peer, digest);
      if (peer.stage == PeerStage::kClosing) continue;
      // And the last state, whichever tick the match ends at.
      if (sees_the_end && !lockstep) send_snapshot(peer);
      peer.outbox.push_last(bye);
      peer.parts_left = std::numeric_limits<std::uint32_t>::max();
      peer.stage = PeerStage::kClosing;
    }
  }
  notice(Notice::Kind::kEnd, "closed at tick " + std::to_string(simulation_.tick()) + ": " +
                                 protocol::printable(reason));
}

void Room::give_up_seat(Peer& peer, protocol::EventKind event) {
  if (peer.seat < 0) return;
  const auto seat = static_cast<std::size_t>(peer.seat);
  const std::int64_t resume_ns = options_.limits.resume.count();
  const bool can_resume = hooks_.random && resume_ns > 0 && state_ == RoomState::kRunning;
  if (event == protocol::EventKind::kLost && !can_resume) event = protocol::EventKind::kLeave;
  if (event == protocol::EventKind::kLost) {
    const std::int64_t ticks = (resume_ns + pacer_.tick_ns() / 2) / pacer_.tick_ns();
    seats_.lose(seat,
                simulation_.tick() + static_cast<std::uint64_t>(std::max<std::int64_t>(ticks, 1)));
  } else {
    seats_.free(seat);
    tokens_.forget(seat);
  }
  events_.push_back({event, static_cast<std::uint16_t>(seat)});
  peer.seat = protocol::kSpectator;
  peer.unseated = true;
  delay_.look_anew();
}

void Room::leave(PeerId id, Peer& peer, const std::string& why, protocol::EventKind seat_event) {
  give_up_seat(peer, seat_event);
  if (hooks_.inquiry != nullptr) hooks_.inquiry->on_gone(id);
  peer.stage = PeerStage::kClosing;
  notice(Notice::Kind::kLeave, "client " + std::to_string(id) + " \"" +
                                   protocol::printable(peer.name) + "\"" + identity_text(peer) +
                                   " left: " + protocol::printable(why));
}

void Room::answer(PeerId id, Peer& peer, const protocol::ServerMessage& message) {
  auto bytes = std::make_shared<const protocol::Bytes>(protocol::encode(message));
  if (peer.outbox.push_control(std::move(bytes), hooks_.now_ns())) return;
  refuse(id, peer, protocol::Refusal::kTooSlow,
         "more than " + std::to_string(options_.limits.queue_bytes_max) + " bytes wait for it",
         protocol::EventKind::kLost);
}

std::string Room::identity_text(const Peer& peer) {
  if (peer.identity.empty()) return "";
  return ", identity \"" + protocol::printable(peer.identity) + "\"";
}

void Room::notice(Notice::Kind kind, const std::string& text) const {
  if (hooks_.notice) hooks_.notice({kind, text});
}

}  // namespace cycloid::server
