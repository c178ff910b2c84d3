#include "server/room/room.hpp"

#include <utility>

namespace cycloid::server {

namespace {

/// Names come from outside: nothing in them may look like another line.
std::string printable(const std::string& name) {
  std::string text = name;
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  return text;
}

}  // namespace

Room::Room(RoomOptions options, scenes::Simulation simulation, RoomHooks hooks)
    : options_(std::move(options)),
      simulation_(std::move(simulation)),
      hooks_(std::move(hooks)),
      schedule_(hooks_.now_ns(), options_.tick_rate_millihertz),
      seats_(static_cast<std::size_t>(simulation_.seats())),
      digest_(simulation_.digest()) {}

PeerId Room::connect() {
  std::size_t connections = 0;
  for (const auto& [id, peer] : peers_) connections += peer.stage == Stage::kClosing ? 0 : 1;

  const PeerId id = ++last_id_;
  Peer& peer = peers_.emplace(id, Peer(options_.limits.queue_bytes_max)).first->second;
  peer.connected_ns = peer.heard_ns = hooks_.now_ns();
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

void Room::disconnect(PeerId id) {
  const auto found = peers_.find(id);
  if (found == peers_.end()) return;
  if (found->second.stage == Stage::kPlaying) leave(id, found->second, "disconnected");
  peers_.erase(found);
}

bool Room::wants_bytes(PeerId id) const {
  const auto found = peers_.find(id);
  if (found == peers_.end()) return false;
  const Peer& peer = found->second;
  return peer.stage == Stage::kClosing || peer.messages < options_.limits.messages_per_tick_max;
}

bool Room::has_output(PeerId id) const {
  const auto found = peers_.find(id);
  return found != peers_.end() && !found->second.outbox.empty();
}

std::vector<Shared> Room::take_output(PeerId id) {
  const auto found = peers_.find(id);
  if (found == peers_.end()) return {};
  std::vector<Shared> output = found->second.outbox.take();
  for (const Shared& bytes : output) statistics_.bytes_out += bytes->size();
  return output;
}

bool Room::wants_close(PeerId id) const {
  const auto found = peers_.find(id);
  return found == peers_.end() || found->second.stage == Stage::kClosing;
}

void Room::drain(const std::string& reason) {
  if (state_ == RoomState::kRunning) end(RoomState::kDrained, reason);
}

void Room::close_overdue() {
  const std::int64_t now = hooks_.now_ns();
  const Limits& limits = options_.limits;
  for (auto& [id, peer] : peers_) {
    const bool greets = peer.stage == Stage::kGreeting;
    const std::int64_t waited = now - (greets ? peer.connected_ns : peer.heard_ns);
    const std::int64_t most = (greets ? limits.handshake : limits.idle).count();
    if (peer.stage == Stage::kClosing || waited < most) continue;
    const std::string what = greets ? "no hello for " : "no message for ";
    refuse(id, peer, protocol::Refusal::kTooSlow,
           what + std::to_string(waited / 1'000'000) + " ms, of at most " +
               std::to_string(most / 1'000'000) + " ms");
  }
}

void Room::refuse(PeerId id, Peer& peer, protocol::Refusal code, const std::string& reason) {
  if (peer.stage == Stage::kClosing) return;
  ++statistics_.refusals;
  notice(Notice::Kind::kRefusal, "client " + std::to_string(id) + " \"" + printable(peer.name) +
                                     "\" refused: " + refusal_name(code) + ": " + reason);
  vacate(peer);
  peer.stage = Stage::kClosing;
  // What it could not take before it need not take now: its last word is why.
  if (code == protocol::Refusal::kTooSlow) peer.outbox.clear();
  peer.outbox.push_last(std::make_shared<const protocol::Bytes>(
      protocol::encode(protocol::ServerMessage(protocol::Refused{code, reason}))));
}

void Room::end(RoomState state, const std::string& reason) {
  state_ = state;
  end_reason_ = reason;
  if (hooks_.log != nullptr) hooks_.log->close({simulation_.tick(), digest_});
  check_log();
  const protocol::ServerMessage digest = protocol::Digest{simulation_.tick(), digest_};
  const bool digest_sent = simulation_.tick() % options_.limits.digest_ticks == 0;
  const auto bye = std::make_shared<const protocol::Bytes>(
      protocol::encode(protocol::ServerMessage(protocol::Bye{reason})));
  for (auto& [id, peer] : peers_) {
    if (peer.stage == Stage::kClosing) continue;
    if (state == RoomState::kFaulted) {
      refuse(id, peer, protocol::Refusal::kFaulted, reason);
    } else if (peer.stage == Stage::kGreeting) {
      refuse(id, peer, protocol::Refusal::kDraining, reason);
    } else {
      // The last digest, so that a replica knows that it saw the match as it was.
      if (peer.mode == protocol::Mode::kLockstep && !digest_sent) answer(id, peer, digest);
      if (peer.stage == Stage::kClosing) continue;
      // And the last state, whichever tick the match ends at.
      if (peer.mode == protocol::Mode::kSnapshot) peer.outbox.replace_snapshot(exact_snapshot());
      peer.outbox.push_last(bye);
      peer.stage = Stage::kClosing;
    }
  }
  notice(Notice::Kind::kEnd,
         "closed at tick " + std::to_string(simulation_.tick()) + ": " + reason);
}

void Room::vacate(Peer& peer) {
  if (peer.seat < 0) return;
  const auto seat = static_cast<std::uint16_t>(peer.seat);
  seats_[seat].free();
  events_.push_back({protocol::EventKind::kLeave, seat});
  peer.seat = protocol::kSpectator;
}

void Room::leave(PeerId id, Peer& peer, const std::string& why) {
  vacate(peer);
  peer.stage = Stage::kClosing;
  notice(Notice::Kind::kLeave, "client " + std::to_string(id) + " \"" + printable(peer.name) +
                                   "\" left: " + printable(why));
}

void Room::answer(PeerId id, Peer& peer, const protocol::ServerMessage& message) {
  if (peer.outbox.push(std::make_shared<const protocol::Bytes>(protocol::encode(message)))) return;
  refuse(id, peer, protocol::Refusal::kTooSlow,
         "more than " + std::to_string(options_.limits.queue_bytes_max) + " bytes wait for it");
}

void Room::notice(Notice::Kind kind, const std::string& text) const {
  if (hooks_.notice) hooks_.notice({kind, text});
}

const char* refusal_name(protocol::Refusal code) {
  switch (code) {
    case protocol::Refusal::kProtocolVersion:
      return "kProtocolVersion";
    case protocol::Refusal::kSolverVersion:
      return "kSolverVersion";
    case protocol::Refusal::kSceneDigest:
      return "kSceneDigest";
    case protocol::Refusal::kSeatTaken:
      return "kSeatTaken";
    case protocol::Refusal::kNoSuchSeat:
      return "kNoSuchSeat";
    case protocol::Refusal::kRoomFull:
      return "kRoomFull";
    case protocol::Refusal::kBadMessage:
      return "kBadMessage";
    case protocol::Refusal::kTooLarge:
      return "kTooLarge";
    case protocol::Refusal::kTooSlow:
      return "kTooSlow";
    case protocol::Refusal::kDraining:
      return "kDraining";
    case protocol::Refusal::kFaulted:
      return "kFaulted";
    case protocol::Refusal::kTokenInvalid:
      return "kTokenInvalid";
    case protocol::Refusal::kTokenExpired:
      return "kTokenExpired";
    case protocol::Refusal::kTokenUsed:
      return "kTokenUsed";
    case protocol::Refusal::kTokenScope:
      return "kTokenScope";
    case protocol::Refusal::kNoSuchRoom:
      return "kNoSuchRoom";
    case protocol::Refusal::kRoomLocked:
      return "kRoomLocked";
    case protocol::Refusal::kRateLimited:
      return "kRateLimited";
    case protocol::Refusal::kKicked:
      return "kKicked";
    case protocol::Refusal::kReplaced:
      return "kReplaced";
    case protocol::Refusal::kResumeUnknown:
      return "kResumeUnknown";
    case protocol::Refusal::kResyncLimit:
      return "kResyncLimit";
  }
  return "unknown";
}

}  // namespace cycloid::server
